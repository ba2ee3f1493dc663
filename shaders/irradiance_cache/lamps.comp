// The light of each record for paths that end at it, in a scene that moves: what it showed in the previous frame, and
// the direct irradiance of sun and lamps now. The second is the mean over the record and three points around it on the
// same surface, each with a shadow ray to every lamp: the record stands for its cell, not for a point.
layout(local_size_x = 64) in;
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/shadow_start.glsl"
#include "rays/environment.glsl"
#if NEXT_EVENT
#include "rays/lights.glsl"
#endif
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/work.glsl"
layout(std430, binding = CACHE_WORK_BUFFER) readonly restrict buffer CacheWorkBlock { CacheWork work; };
layout(std430, binding = CACHE_RECORDS_BUFFER) readonly restrict buffer CacheRecords { CacheRecord records[]; };
#include "irradiance_cache/record_surface.glsl"
layout(std430, binding = CACHE_LIST_BUFFER) writeonly restrict buffer CacheLights { vec4 lightOf[]; };

#if NEXT_EVENT && (SUN || SPOTS || POINTS)
const int kPoints = 4;

// A point beside the record, from above the record; false: another surface is there, or none.
bool beside(int i, vec3 from, vec3 to, vec3 normal, inout Surface surface, inout uint triangle) {
  if (i == 0) return true;
  Hit hit = closestHit(Ray(from, 0.0, to - from, 1.5), kNoHit);
  if (hit.triangle == kNoHit) return false;
  surface = surfaceAt(hit.triangle, hit.barycentrics, to - from);
  triangle = hit.triangle;
  return dot(surface.normal, normal) > 0.5;
}

vec3 lampsOf(CacheRecord record) {
  Surface own = surfaceOf(record);
  float cell = grids.cascades[record.cell.w / CACHE_FACES].cellSize;
  vec3 t, b, sum = vec3(0.0);
  tangentFrame(own.normal, t, b);
  vec3 above = offsetRay(own.position, own.geometricNormal, own.magnitude) + 0.25 * cell * own.normal;
  float points = 0.0;
  uint pixel = pcg4d(uvec4(record.cell)).x;
  for (int i = 0; i < kPoints; ++i) {
    Surface surface = own;
    uint triangle = record.triangle;
    float turn = 2.0 * kPi * (float(i) / 3.0 + unitFloat(pixel));
    if (!beside(i, above, own.position + 0.35 * cell * (cos(turn) * t + sin(turn) * b), own.normal, surface, triangle))
      continue;
    points += 1.0;
    ShadowStart start = shadowStart(surface, triangle);
    for (int k = 0; k < CACHE_MOST_LAMPS && k < lights.length(); ++k) {
      PathLight lamp = lights[k];
      if (lamp.kind == PATH_LIGHT_TRIANGLE || lamp.kind == PATH_LIGHT_ENVIRONMENT) break;  // they come last
      PathNumbers numbers = PathNumbers(pixel, uint(i), tracer.seed);
      LightSample light;
      vec2 xi = unitFloat(randomWords(numbers, uint(k), kPurposeLight).xy);
      if (!sampleOf(lamp, surface.position, xi, uvec4(0u), light)) continue;
      float cosine = dot(light.direction, surface.normal);
      if (!(cosine > 0.0 && dot(light.direction, start.normal) > 0.0)) continue;
      vec3 way = light.infinite ? light.direction : light.end - start.origin;
      if (anyHitToLamp(Ray(start.origin, 0.0, way, light.infinite ? 3e38 : 1.0), start.skip)) continue;
      // What stands for a whole cell is not lit as a point close to a lamp is.
      float near = light.infinite ? 1.0 : min(dot(way, way) / (0.25 * cell * cell), 1.0);
      sum += light.value * (lamp.probability * cosine * near);
    }
  }
  return sum / max(points, 1.0);
}
#else
vec3 lampsOf(CacheRecord record) { return vec3(0.0); }
#endif

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= recordCount(work.wanted)) return;
  CacheRecord record = records[index];
  // New ones show nothing yet.
  bool hasLight = record.triangle != CACHE_UNPLACED && record.triangle != CACHE_NOWHERE && record.born != cache.frame;
  vec4 light = vec4(0.0);
  if (hasLight) light = vec4(record.shown + lampsOf(record), 1.0);
  lightOf[index] = light;
}
