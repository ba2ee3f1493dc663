// Casts rays from the parts of patches: the parts that they see (engine/radiosity/hidden_parts.hpp). x: rays, raysEach
// per part.
layout(local_size_x = 64) in;
#include "radiosity/patch_rays.glsl"
#include "radiosity/triangle_parts.glsl"
struct TestedPatch {
  vec4 a, b, c;  // corners, in the hierarchy's space; a's w: the patch
  vec4 normal;   // to the side that rays leave on; w: the largest coordinate
};
layout(std430, binding = 1) readonly buffer TestedPatches { TestedPatch tested[]; };
// part + 1 for a front face, 0 if nothing is hit, the patch with the highest bit set for a back face
layout(std430, binding = 2) writeonly buffer Seen { uint seen[]; };
uniform int testedCount, raysEach;

void main() {
  int index = int(gl_GlobalInvocationID.x), part = index / raysEach % kPatchParts,
      patchPlace = index / (raysEach * kPatchParts);
  if (patchPlace >= testedCount) return;
  TestedPatch r = tested[patchPlace];
  vec2 weights = partCentroid(part);
  vec3 at = r.a.xyz + weights.x * (r.b.xyz - r.a.xyz) + weights.y * (r.c.xyz - r.a.xyz), n = r.normal.xyz;
  // Sunflower points in the unit disk [Vogel1979], rotated from part to part by the golden section of 360
  // degrees and lifted to the hemisphere for a cosine distribution.
  float k = float(index % raysEach), radius = sqrt((k + 0.5) / float(raysEach)),
        angle = 2.39996323 * k + 3.88322208 * float(part) + 1.0;
  vec3 u = normalize(r.b.xyz - r.a.xyz), v = cross(n, u);
  vec3 direction = radius * (cos(angle) * u + sin(angle) * v) + sqrt(1.0 - radius * radius) * n;
  Ray ray = Ray(offsetRay(at, n, r.normal.w), 0.0, direction, 3e38);
  PatchMet met = patchMet(ray, uint(r.a.w));  // bounded: a patch's number
  uint result = 0u;
  if (met.patchIndex != kNoHit) {
    // Barycentrics of the hit point.
    vec3 a = bvhCorner(met.texel, 0), toB = bvhCorner(met.texel, 1) - a, toC = bvhCorner(met.texel, 2) - a,
         normal = cross(toB, toC);
    vec3 place = ray.origin - a + direction * (dot(normal, a - ray.origin) / dot(normal, direction));
    vec2 barycentrics = vec2(dot(cross(place, toC), normal), dot(cross(toB, place), normal)) / dot(normal, normal);
    result = met.front ? 1u + met.patchIndex * uint(kPatchParts) + uint(partAt(barycentrics))
                       : met.patchIndex | 0x80000000u;
  }
  seen[index] = result;
}
