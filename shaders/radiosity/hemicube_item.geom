// Item buffer: sends a triangle to the faces that may see it, one layer per face [CohenGreenberg1985]. Everything in
// front of the centre lies between the near and the far plane: depth is the distance along the face's axis, written by
// the fragment shader. The near plane is half a millionth of the scene's extent away. In the centre itself, NVIDIA's
// driver lost triangles with an edge in the patch's plane, where w is 0.
#include "radiosity/hemicube.glsl"
layout(triangles, invocations = 5) in;
layout(triangle_strip, max_vertices = 3) out;
in vec3 gPosition[];
flat in ivec2 gPatch[];
flat out uint fItem;
flat out float fBias;
out float fDistance;
uniform float inverseFar;

void main() {
  Triangle t = Triangle(gPosition[0], gPosition[1], gPosition[2]);
  int hemicube = gPatch[0].y, face = gl_InvocationID;
  if (!isAbove(frames[hemicube], t, gPatch[0].x, firstPatch + hemicube) || (facesOf(t) & (1u << uint(face))) == 0u)
    return;
  // A front face wins over a back face in the same place, for sheets with two fronts.
  float bias = dot(t.a, cross(t.b, t.c)) < 0.0 ? 1.0 : 1.000002;
  for (int k = 0; k < 3; ++k) {
    vec3 p = toFace(face, gPosition[k]);
    fItem = uint(gPatch[0].x) + 1u;
    fBias = bias;
    fDistance = p.z;
    gl_Layer = 5 * hemicube + face;
    gl_Position = vec4(p.xy, p.z - 5e-7 / inverseFar, p.z);  // -w <= z from p.z = 2.5e-7 / inverseFar on
    EmitVertex();
  }
}
