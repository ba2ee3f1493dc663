// Sends the triangle that covers the picture to the layer of its instance.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in int layerOf[];
flat out int layer;

void main() {
  for (int i = 0; i < 3; ++i) {
    gl_Position = gl_in[i].gl_Position;
    gl_Layer = layer = layerOf[0];
    EmitVertex();
  }
  EndPrimitive();
}
