// A triangle file on the display [RAD2008 section 3.8]: flat colours chosen on the CPU.
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 colour;
uniform mat4 clipFromWorld;
flat out vec3 shown;

void main() {
  shown = colour;
  gl_PointSize = 2.0;
  gl_Position = clipFromWorld * vec4(corner, 1.0);
}
