// Renders the views of a spot or the six of an omnidirectional light in one draw: see lib/layered_triangle.glsl.
#include "lib/layered_triangle.glsl"
layout(triangles, invocations = LAYERS) in;
layout(triangle_strip, max_vertices = 3) out;
in vec3 gNormal[];
in vec2 gTexCoord[];
out vec3 vPosition;
out vec3 vNormal;
out vec2 vTexCoord;

void main() {
  vec4 clip[3];
  for (int i = 0; i < 3; ++i) clip[i] = clipOf(gl_in[i].gl_Position, gl_InvocationID);
  if (beyondOneSide(clip[0], clip[1], clip[2])) return;
  if (holdsLamp(gl_in[0].gl_Position.xyz, gl_in[1].gl_Position.xyz, gl_in[2].gl_Position.xyz, gl_InvocationID)) return;
  for (int i = 0; i < 3; ++i) {
    gl_Position = clip[i];
    gl_Layer = gl_InvocationID;
    vPosition = gl_in[i].gl_Position.xyz;
    vNormal = gNormal[i];
    vTexCoord = gTexCoord[i];
    EmitVertex();
  }
  EndPrimitive();
}
