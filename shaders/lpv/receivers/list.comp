// Every receiver once a frame: a new one is placed where its pixel's ray meets the scene, in the ray caster's own numbers, so that no path starts inside of a surface;
// and those that are needed and do not have all their paths yet are listed.
layout(local_size_x = 64) in;
#include "shared/path_tracer.h"
layout(std140, binding = 5) uniform PathBlock { PathConstants tracer; };
#include "pathtracer/random.glsl"
#include "pathtracer/bsdf.glsl"
#include "pathtracer/materials.glsl"
#include "pathtracer/bvh.glsl"
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/work.glsl"
layout(std430, binding = 0) restrict buffer LpvReceivers { LpvReceiver receivers[]; };
layout(std430, binding = 1) writeonly restrict buffer LpvLit { uint lit[]; };
layout(binding = 6) uniform usamplerBuffer lpvSeen;
uniform uint mostLit;     // receivers
uniform uint pathTarget;  // paths that a receiver shall have

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= receiverCount()) return;
  uint triangle = receivers[index].triangle;
  if (triangle == LPV_UNPLACED) {
    int pixel = int(receivers[index].pixel), width = tracer.picture.x;
    vec2 place = vec2(pixel % width, pixel / width) + 0.5;
    Ray ray = Ray(tracer.cameraPosition, 0.0, normalize(tracer.firstPixel + place.x * tracer.pixelRight + place.y * tracer.pixelUp), 3e38);
    Hit hit = closestHit(ray, kNoHit);
    triangle = hit.triangle == kNoHit ? LPV_NOWHERE : hit.triangle;
    receivers[index].triangle = triangle;
    if (triangle != LPV_NOWHERE) {
      Surface surface = surfaceAt(hit.triangle, hit.barycentrics, ray.direction);
      receivers[index].front = surface.front ? 1u : 0u;
      receivers[index].position = surface.position + receiving.rayOrigin;
      receivers[index].normal = surface.normal;
      receivers[index].second = hit.barycentrics.x;
      receivers[index].third = hit.barycentrics.y;
    }
  }
  if (triangle == LPV_NOWHERE || receivers[index].paths >= pathTarget) return;
  if (receivers[index].born != receiving.frame && texelFetch(lpvSeen, int(index)).x != receiving.frame) return;
  uint place = atomicAdd(work.waiting, 1u);
  if (place >= mostLit) return;
  atomicMax(work.litGroupsX, place / uint(LPV_LANES / PATHS) + 1u);
  lit[place] = index;
}
