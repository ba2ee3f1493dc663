// Traces rays from one buffer and writes hits to another, for tests and benchmarks. COUNT_WORK: writes the numbers of
// visited nodes and tested triangles in place of t and barycentrics.
#if ALPHA_MASKS
// for tests: cuts out half of every masked triangle
bool isCutOut(uint triangle, vec2 barycentrics) { return barycentrics.x < 0.5; }
#endif
layout(local_size_x = 64) in;
#include "rays/bvh.glsl"

layout(std430, binding = 2) readonly restrict buffer Rays { Ray rays[]; };
// unordered Hits: each dispatch writes those of its own rays
layout(std430, binding = 3) writeonly restrict buffer Hits { Hit hits[]; };
layout(std430, binding = 4) readonly restrict buffer Skipped { uint skipTriangles[]; };

uniform int firstRay, rayCount;

void main() {
  int i = firstRay + int(gl_GlobalInvocationID.x);
  if (i >= rayCount) return;
  Ray start = rays[i];
#if OFFSET_ORIGINS  // along the direction, taken as the surface's normal
  start.origin = offsetRay(start.origin, normalize(start.direction));
#endif
#if COUNT_WORK
  BvhTraversal ray = beginRay(start, skipTriangles[i]);
  for (int left = bvhStepCount(); left > 0 && !isDone(ray); --left) advanceRay(ray, ANY_HIT != 0);
  hits[i] = Hit(float(ray.visited), ray.hit.triangle, vec2(ray.tested, 0.0));
#elif ANY_HIT
  hits[i] = Hit(0.0, anyHit(start, skipTriangles[i]) ? 0u : kNoHit, vec2(0.0));
#else
  hits[i] = closestHit(start, skipTriangles[i]);
#endif
}
