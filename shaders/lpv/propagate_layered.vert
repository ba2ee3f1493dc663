// One point per cell, as in the published program.
uniform int cells;
flat out ivec3 gCell;

void main() {
  gCell = ivec3(gl_VertexID % cells, gl_VertexID / cells % cells, gl_VertexID / (cells * cells));
  gl_Position = vec4((vec2(gCell.xy) + 0.5) / float(cells) * 2.0 - 1.0, 0.0, 1.0);
  gl_PointSize = 1.0;
}
