// The patches whose backs segments meet; see backsMet() in engine/radiosity/direct_light.hpp. x: segments.
layout(local_size_x = 64) in;
#include "radiosity/patch_rays.glsl"
struct Segment {
  vec4 origin;     // in the hierarchy's space
  vec4 direction;  // to the other end, its length the distance
};
layout(std430, binding = 1) readonly buffer Segments { Segment segments[]; };
layout(std430, binding = 2) writeonly buffer BacksMet { uint backsMet[]; };  // kNoHit: none, or a front
uniform int rayCount;

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= rayCount) return;
  PatchMet met = patchMet(Ray(segments[index].origin.xyz, 0.0, segments[index].direction.xyz, 1.0001), kNoHit);
  backsMet[index] = met.front ? kNoHit : met.patchIndex;
}
