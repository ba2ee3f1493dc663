// How often light of each kind reaches the surfaces in a cell of the scene's box: one invocation for the surface that a
// ray in the box meets, whatever triangles it is made of. Next-event estimation chooses among lights by these shares
// [Guo2020], so that a sun behind a wall costs little. Counts are integers, so they do not depend on the rays' order.
layout(local_size_x = 64) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/environment.glsl"
#include "rays/lights.glsl"
#include "pathtracer/light_cells.glsl"

const float kGrazing = 1e-3;
const uint kLightsPerPoint = 8u;  // stratified by what next-event estimation draws them from

layout(std430, binding = 6) restrict buffer CountBlock { uint counts[]; };  // of a cell and kind: sampled, and reached
uniform int rayCount;

void main() {
  uint point = gl_GlobalInvocationID.x;
  if (point >= uint(rayCount)) return;
  uvec4 from = pcg4d(uvec4(point, 0u, 3u, 0u)), words = pcg4d(uvec4(point, 0u, 0u, 0u));
  vec3 origin = lightCellsMin + vec3(unitFloat(from.xy), unitFloat(from.z)) * vec3(lightCells) * lightCellSize,
       direction = coneSample(vec3(0.0, 0.0, 1.0), 2.0, unitFloat(words.zw));
  Hit hit = closestHit(Ray(origin, 0.0, direction, 3e38), kNoHit);
  if (hit.triangle == kNoHit) return;
  Surface surface = surfaceAt(hit.triangle, hit.barycentrics, direction);
  uint cell = lightCellBefore(surface);
  for (uint k = 0u; k < kLightsPerPoint; ++k) {
    uvec4 choice = pcg4d(uvec4(point, k, 1u, 0u));
    choice.x = stratifiedWord(words.x, k, kLightsPerPoint);
    vec2 xi = unitFloat(pcg4d(uvec4(point, k, 2u, 0u)).xy);
    LightPick picked = pickAt(choice, surface.position, vec3(0.0));
    LightSample light;
    bool reaches = samplePicked(picked, surface.position, xi, choice, light);
    uint kind = kindOfLight(lights[picked.light].kind);
#if SUN_APART
    if ((k & 1u) == 0u) {  // half of the time
      PathLight sun = lights[0];
      reaches = sampleSun(sun, xi, light);
      kind = kindOfLight(PATH_LIGHT_SUN);
    }
#endif
    if (!reaches) continue;
    // On the side that the light comes from. In the surface's plane it brings nothing, and rounding decides its ray.
    float cosine = dot(light.direction, surface.geometricNormal);
    if (abs(cosine) < kGrazing) continue;
    vec3 start = offsetRay(surface.position, sign(cosine) * surface.geometricNormal, surface.magnitude);
    Ray ray = Ray(start, 0.0, light.infinite ? light.direction : light.end - start, light.infinite ? 3e38 : 1.0);
    uint counter = 2u * (cell * kLightKinds + kind);
    atomicAdd(counts[counter], 1u);
    if (!anyHitToLamp(ray, hit.triangle)) atomicAdd(counts[counter + 1u], 1u);
  }
}
