// Hemicubes by ray casting: one ray through each pixel's centre, through the path tracer's hierarchy. x, z: pixels, y:
// hemicubes of the batch.
// Writes the pixel's patch + 1, or 0 if there is none, and sums each patch's share of the hemisphere
// (hemicube_keep.glsl).
layout(local_size_x = 64) in;
#include "radiosity/hemicube.glsl"
#include "radiosity/hemicube_keep.glsl"
#include "radiosity/patch_rays.glsl"

layout(binding = 58) uniform samplerBuffer deltaFactors;  // the full face, then one half face
layout(std430, binding = 2) writeonly buffer Items { uint items[]; };
uniform vec3 raysOrigin;  // in the hierarchy's space

void main() {
  int pixel = int(gl_GlobalInvocationID.x + gl_GlobalInvocationID.z * gl_NumWorkGroups.x * 64u),
      hemicube = int(gl_WorkGroupID.y);
  if (pixel >= pixelsPerHemicube()) return;
  ivec3 place = placeOf(pixel);
  Frame f = frames[hemicube];
  vec3 d = pixelDirection(place.x, place.yz);
  // Surfaces in the patch's own plane are ignored.
  Ray ray =
      Ray(f.origin.xyz - raysOrigin, 1.0 / (f.origin.w * d.z), d.x * f.u.xyz + d.y * f.v.xyz + d.z * f.n.xyz, 3e38);
  uint patchIndex = patchMet(ray, uint(firstPatch + hemicube)).patchIndex;
  bool met = patchIndex != kNoHit;
  items[hemicube * pixelsPerHemicube() + pixel] = met ? patchIndex + 1u : 0u;
  float delta = texelFetch(deltaFactors, pixel - facePixels(place.x) + (place.x == 0 ? 0 : 2 * halfFacePixels)).x;
  if (met) keep(hemicube, int(patchIndex), delta);
}
