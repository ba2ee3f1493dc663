// One triangle a slice of the cascade; the slice is the instance.
out int gSlice;

void main() {
  gSlice = gl_InstanceID;
  gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0);
}
