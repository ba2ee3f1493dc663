// How often light of each kind reaches the surfaces in a cell of the scene's box: one invocation for a sample point on
// a surface. Next-event estimation chooses among lights by these shares [Guo2020], so that a sun behind a wall costs
// little. Counts are integers, so they do not depend on the order of the points.
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

const uint kLightsPerPoint = 8u;  // stratified by what next-event estimation draws them from

layout(std430, binding = 5) readonly restrict buffer PointBlock { uvec4 points[]; };  // triangle, bits of barycentrics
layout(std430, binding = 6) restrict buffer CountBlock { uint counts[]; };  // of a cell and kind: sampled, and reached
uniform int pointCount;

void main() {
  uint point = gl_GlobalInvocationID.x;
  if (point >= uint(pointCount)) return;
  uvec4 place = points[point];
  Surface surface = surfaceAt(place.x, uintBitsToFloat(place.yz), vec3(1.0, 0.0, 0.0));
  uint cell = lightCellAt(surface.position);
  uvec4 words = pcg4d(uvec4(point, 0u, 0u, 0u));
  for (uint k = 0u; k < kLightsPerPoint; ++k) {
    uvec4 choice = pcg4d(uvec4(point, k, 1u, 0u));
    choice.x = stratifiedWord(words.x, k, kLightsPerPoint);
    LightSample light;
    if (!sampleLight(surface.position, unitFloat(pcg4d(uvec4(point, k, 2u, 0u)).xy), choice, light)) continue;
    // On the side that the light comes from.
    float side = dot(light.direction, surface.geometricNormal) < 0.0 ? -1.0 : 1.0;
    vec3 start = offsetRay(surface.position, side * surface.geometricNormal, surface.magnitude);
    Ray ray = Ray(start, 0.0, light.infinite ? light.direction : light.end - start, light.infinite ? 3e38 : 1.0);
    uint counter = 2u * (cell * kLightKinds + kindOfLight(lights[pickedLight].kind));
    atomicAdd(counts[counter], 1u);
    if (!anyHitToLamp(ray, place.x)) atomicAdd(counts[counter + 1u], 1u);
  }
}
