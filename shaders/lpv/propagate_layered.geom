// Sends each point to its slice of the 3D texture.
layout(points) in;
layout(points, max_vertices = 1) out;
flat in ivec3 gCell[];
flat out int fSlice;
uniform int firstLayer;

void main() {
  gl_Layer = firstLayer + gCell[0].z;
  fSlice = gCell[0].z;
  gl_Position = gl_in[0].gl_Position;
  gl_PointSize = 1.0;
  EmitVertex();
  EndPrimitive();
}
