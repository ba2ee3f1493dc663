// Depth maps of several views in one draw: see lib/layered_triangle.glsl.
#include "lib/layered_triangle.glsl"
layout(triangles, invocations = LAYERS) in;
layout(triangle_strip, max_vertices = 3) out;
#if ALPHA_MASK
in vec2 gTexCoord[];
centroid out vec2 vTexCoord;
#endif

void main() {
  vec4 clip[3];
  for (int i = 0; i < 3; ++i) clip[i] = clipOf(gl_in[i].gl_Position, gl_InvocationID);
  if (beyondOneSide(clip[0], clip[1], clip[2])) return;
#if LAMPS
  if (holdsLamp(gl_in[0].gl_Position.xyz, gl_in[1].gl_Position.xyz, gl_in[2].gl_Position.xyz, gl_InvocationID)) return;
#endif
  for (int i = 0; i < 3; ++i) {
    gl_Position = clip[i];
    gl_Layer = gl_InvocationID;
#if ALPHA_MASK
    vTexCoord = gTexCoord[i];
#endif
    EmitVertex();
  }
  EndPrimitive();
}
