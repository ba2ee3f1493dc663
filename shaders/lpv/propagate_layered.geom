// Sends each point or triangle to its slice of the 3D texture.
#if POINTS
layout(points) in;
layout(points, max_vertices = 1) out;
#else
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
#endif
flat in ivec3 gCell[];
flat out int fSlice;
uniform int firstLayer;

void main() {
  for (int i = 0; i < gl_in.length(); ++i) {
    gl_Layer = firstLayer + gCell[0].z;
    fSlice = gCell[0].z;
    gl_Position = gl_in[i].gl_Position;
    gl_PointSize = 1.0;
    EmitVertex();
  }
  EndPrimitive();
}
