// One triangle that covers the picture, made from gl_VertexID, at the far plane, the depth of the cleared background.
#if ENVIRONMENT_PICTURE
uniform vec3 viewForward, viewRight, viewUp;  // forward: through the picture's centre; right, up: to its edges
out vec3 vDirection;
#endif

void main() {
  vec2 corner = 2.0 * vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) - 1.0;
#if ENVIRONMENT_PICTURE
  vDirection = viewForward + corner.x * viewRight + corner.y * viewUp;
#endif
  gl_Position = vec4(corner, 1.0, 1.0);
}
