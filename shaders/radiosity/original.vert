// A triangle of the scene as one view of a hemicube draws it [RAD2008 section 3.6]: the number that it sends out goes
// along with its corners.
layout(location = 0) in vec4 cornerAndNumber;
uniform mat4 clipFromWorld;
flat out float number;

void main() {
  number = cornerAndNumber.w;
  gl_Position = clipFromWorld * vec4(cornerAndNumber.xyz, 1.0);
}
