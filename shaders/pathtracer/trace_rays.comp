// Rays from a buffer, hits into another: for tests and benchmarks.
#if ALPHA_MASKS
bool isCutOut(uint triangle, vec2 barycentrics) { return barycentrics.x < 0.5; }  // tests alone: half of every masked triangle
#endif
#include "pathtracer/bvh.glsl"

layout(local_size_x = 64) in;

layout(std430, binding = 2) readonly restrict buffer Rays { Ray rays[]; };
layout(std430, binding = 3) writeonly restrict buffer Hits { Hit hits[]; };
layout(std430, binding = 4) readonly restrict buffer Skipped { uint skipTriangles[]; };

uniform int firstRay, rayCount;

void main() {
  int i = firstRay + int(gl_GlobalInvocationID.x);
  if (i >= rayCount) return;
#if ANY_HIT
  hits[i] = Hit(0.0, anyHit(rays[i], skipTriangles[i]) ? 0u : kNoHit, vec2(0.0));
#else
  hits[i] = closestHit(rays[i], skipTriangles[i]);
#endif
}
