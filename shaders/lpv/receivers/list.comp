// Visits every receiver once per frame. A new one is placed where its pixel's ray meets the scene, in the ray caster's
// coordinates, so that no path starts inside a surface. Needed receivers that do not have all their paths yet are
// listed. A new one first shows the irradiance looked up at its place in the previous frame.
layout(local_size_x = 64) in;
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_RECEIVER_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "lpv/receivers/lookup.glsl"
#include "lpv/receivers/work.glsl"
layout(std430, binding = 5) restrict buffer LpvWork { LpvReceiverWork work; };
#include "lpv/receivers/seen.glsl"
layout(std430, binding = 0) restrict buffer LpvReceivers { LpvReceiver receivers[]; };
layout(std430, binding = 1) writeonly restrict buffer LpvLit { uint lit[]; };
layout(binding = 6) uniform usamplerBuffer lpvSeen;
#include "lpv/receivers/neighbours.glsl"
uniform uint mostLit;     // receivers
uniform uint pathTarget;  // paths that each receiver should have
uniform bool countsFading;  // also list receivers whose shown value is still fading in

// Whether one of the neighbours that are shown is much darker. Those of this frame are not shown yet.
bool isBrightBeside(ivec4 cell, vec3 light) {
  const float kMuch = 4.0;
  float most = largestOf(light) / kMuch;
  bool isBright = false;
  for (int i = 0; i < kNeighbours; ++i) {
    uint other;
    if (!neighbourAt(cell, i, other) || !(receivers[other].presence > 0.0)) continue;
    float shown = largestOf(receivers[other].shown);
    isBright = isBright || (shown > 0.0 && shown <= most);
  }
  return isBright;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= receiverCount(work.wanted)) return;
  uint triangle = receivers[index].triangle;
  if (triangle == LPV_UNPLACED) {
    Hit hit;
    Surface surface;
    bool isThere = seenAt(int(receivers[index].pixel), hit, surface);
    triangle = isThere ? hit.triangle : LPV_NOWHERE;
    receivers[index].triangle = triangle;
    if (isThere) {
      receivers[index].position = surface.position + receiving.rayOrigin;
      receivers[index].normal = surface.normal;
      receivers[index].second = hit.barycentrics.x;
      receivers[index].third = hit.barycentrics.y;
      bool known;
      vec3 before = receivedIrradiance(surface.position + receiving.rayOrigin, surface.normal, known);
      receivers[index].shown = before;
      receivers[index].presence = 0.0;
      receivers[index].state = (surface.front ? LPV_FRONT : 0u) | (known ? 0u : LPV_FIRST) |
                               (isBrightBeside(receivers[index].cell, before) ? LPV_BRIGHT : 0u);
    }
  }
  if (triangle == LPV_NOWHERE) return;
  // also if it is not needed itself, but is looked up next to needed ones; not without any path, as it shows nothing
  uint paths = receivers[index].paths;
  bool fades = countsFading && paths > 0u && receivers[index].presence < fullPresence(paths);
  bool lacksPaths = paths < pathTarget &&
                    (receivers[index].born == receiving.frame || texelFetch(lpvSeen, int(index)).x == receiving.frame);
  if (!fades && !lacksPaths) return;
  uint place = atomicAdd(work.waiting, 1u);
  if (place >= mostLit) return;
  uint group = place / uint(LPV_LANES / PATHS);
  atomicMax(work.litGroups[3u * (group / uint(LPV_PART_GROUPS))], group % uint(LPV_PART_GROUPS) + 1u);
  lit[place] = index;
}
