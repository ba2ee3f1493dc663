// The surfaces around the camera, in view or not. They have receivers in the coarsest cascades before the camera turns
// to them. One invocation per direction.
layout(local_size_x = 64) in;
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_RECEIVER_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/seen.glsl"
layout(std430, binding = 0) writeonly restrict buffer LpvAround { LpvAroundPoint around[]; };

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= receiving.around) return;
  Hit hit;
  Surface surface;
  bool isThere = seenAt(tracer.picture.x * tracer.picture.y + int(index), hit, surface);
  around[index] = isThere ? LpvAroundPoint(surface.position + receiving.rayOrigin, 1u, surface.normal, 0u)
                          : LpvAroundPoint(vec3(0.0), 0u, vec3(0.0), 0u);
}
