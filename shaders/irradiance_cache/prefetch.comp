// The surfaces around the camera, in view or not. They have records in the coarsest cascades before the camera turns
// to them. One invocation per direction.
layout(local_size_x = 64) in;
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/seen.glsl"
layout(std430, binding = CACHE_FOUND_BUFFER) writeonly restrict buffer CachePrefetch { PrefetchPoint prefetched[]; };

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= cache.prefetch) return;
  Hit hit;
  Surface surface;
  bool isThere = seenAt(tracer.picture.x * tracer.picture.y + int(index), hit, surface);
  prefetched[index] = isThere ? PrefetchPoint(surface.position + cache.rayOrigin, 1u, surface.normal, 0u)
                          : PrefetchPoint(vec3(0.0), 0u, vec3(0.0), 0u);
}
