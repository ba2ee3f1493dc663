// Passes mesh vertices on for rendering several depth maps; the geometry shader projects them.
layout(location = 0) in vec3 position;
#if ALPHA_MASK
layout(location = 1) in vec2 texCoord;
out vec2 gTexCoord;
#endif

void main() {
  gl_Position = vec4(position, 1.0);
#if ALPHA_MASK
  gTexCoord = texCoord;
#endif
}
