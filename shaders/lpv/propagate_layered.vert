// POINTS: one point per cell, as in the published program. Otherwise one triangle per slice of the cascade; the
// instance is the slice.
uniform int cells;
flat out ivec3 gCell;

void main() {
#if POINTS
  gCell = ivec3(gl_VertexID % cells, gl_VertexID / cells % cells, gl_VertexID / (cells * cells));
  gl_Position = vec4((vec2(gCell.xy) + 0.5) / float(cells) * 2.0 - 1.0, 0.0, 1.0);
  gl_PointSize = 1.0;
#else
  gCell = ivec3(0, 0, gl_InstanceID);
  gl_Position = vec4(vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0, 0.0, 1.0);
#endif
}
