// Triangles of a user interface. Positions in pixels from the top left.
layout(location = 0) in vec2 position;
layout(location = 1) in vec2 texCoord;
layout(location = 2) in vec4 vertexColor;
uniform vec2 pixels;  // of the target
out vec2 uv;
out vec4 color;

void main() {
  uv = texCoord;
  color = vertexColor;
  vec2 ndc = 2.0 * position / pixels - 1.0;
  gl_Position = vec4(ndc.x, -ndc.y, 0.0, 1.0);
}
