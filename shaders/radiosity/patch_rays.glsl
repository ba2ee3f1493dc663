// The patch that a ray hits, through the path tracer's hierarchy. Of coinciding sheets, the one that shows its front is
// hit.
#include "rays/bvh.glsl"

struct PatchMet {
  uint patchIndex;  // kNoHit: none
  bool front;
  int texel;        // of bvhTriangles
};

vec3 bvhCorner(int texel, int k) { return uintBitsToFloat(texelFetch(bvhTriangles, texel + k).xyz); }

vec3 bvhNormal(int texel) {
  vec3 a = bvhCorner(texel, 0);
  return cross(bvhCorner(texel, 1) - a, bvhCorner(texel, 2) - a);
}

PatchMet firstMet(Ray ray, uint skip) {
  BvhTraversal s = beginRay(ray, skip);
  for (int left = bvhStepCount(); left > 0 && !isDone(s); --left) advanceRay(s, false);
  if (s.hit.triangle == kNoHit) return PatchMet(kNoHit, false, 0);
  int texel = int(s.hit.triangle);
  return PatchMet(texelFetch(bvhTriangles, texel).w & BVH_TRIANGLE_ID_MASK, dot(bvhNormal(texel), ray.direction) < 0.0,
                  texel);
}

// self: the patch that the ray starts from, which it ignores.
PatchMet patchMet(Ray ray, uint self) {
  PatchMet met = firstMet(ray, self);
  if (met.patchIndex == kNoHit || met.front) return met;
  vec3 normal = bvhNormal(met.texel);
  float at = dot(normal, bvhCorner(met.texel, 0) - ray.origin) / dot(normal, ray.direction);
  ray.tMin = max(ray.tMin, at * 0.999999);
  ray.tMax = at * 1.000002;
  PatchMet other = firstMet(ray, met.patchIndex);
  if (other.patchIndex != self && other.front) met = other;
  return met;
}
