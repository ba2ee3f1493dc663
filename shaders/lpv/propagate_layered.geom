// Sends each triangle to its slice of the 3D texture.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in int gSlice[];
flat out int fSlice;
uniform int firstLayer;

void main() {
  for (int i = 0; i < 3; ++i) {
    gl_Layer = firstLayer + gSlice[0];
    fSlice = gSlice[0];
    gl_Position = gl_in[i].gl_Position;
    EmitVertex();
  }
  EndPrimitive();
}
