// Draws a triangle of the scene in one view of a hemicube [RAD2008 section 3.6]; its radiosity is passed along with its
// corners.
layout(location = 0) in vec4 cornerAndNumber;
uniform mat4 clipFromWorld;
flat out float number;

void main() {
  number = cornerAndNumber.w;
  gl_Position = clipFromWorld * vec4(cornerAndNumber.xyz, 1.0);
}
