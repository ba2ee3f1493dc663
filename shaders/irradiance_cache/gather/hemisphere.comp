// What surrounds a record: RAYS cosine-distributed rays of each lane through the scene's hierarchy. Each brings, over
// the number of rays,
//   pi L of the sky where it meets nothing; with a picture, as many rays to its texels share in that;
//   pi L of an emissive surface, weighted as in gather.comp (SHARED_WITH_RAYS), which finds the rest;
//   albedo E of any surface, E being the irradiance kept at the bounces' point near the hit.
// The rays' shares add up to 1 at most, so light that bounces on and on never grows.
// OWN: sky and emissive surfaces count. BOUNCED: surfaces do. LINKS: the records are the bounces' points themselves;
// a surface's point and albedo are noted for bounce.comp, and what was stored is replaced. RAYS is then 1.
// `probes`, LINKS: only tells which points lie in a gap, as between a ceiling and the lamp on it, or within a solid, as
// the floor below a column, and stand for no other part of their cell. No surface finds them any more.
layout(local_size_x = 64) in;  // CACHE_LANES
#include "lib/clamped_int.glsl"
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/environment.glsl"
#include "irradiance_cache/common.glsl"
#include "irradiance_cache/record_surface.glsl"
// unordered CacheRecords: each dispatch changes the records of its own part of the list
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
layout(std430, binding = CACHE_LIST_BUFFER) readonly restrict buffer CacheLit { uint lit[]; };
uniform uint last;              // 1: after this dispatch records have all their light
uniform uint firstGroup;       // of `lit`
uniform float areaOverDensity;  // of emissive surfaces: area that a point stands for, times the triangle's pickDensity
shared vec3 found[CACHE_LANES];
#if LINKS
shared uint met[CACHE_LANES];  // 1: the lane's ray met a surface; 2: right in front of it, or a back face near by
uniform bool probes;
const float kGap = 0.1, kNear = 1.0;  // cells
const uint kMostShut = 48u;           // rays that may end there
#endif

#if LINKS && EMISSION
#include "irradiance_cache/small_lamps.glsl"
#endif

#if BOUNCED
uniform vec3 bounceMinimum;  // of cell 0, in the ray caster's coordinates
uniform float bounceCell;    // scene units
uniform ivec3 bounceCells;
// per face and cell: number of its first point + 1, 0: none
layout(binding = UNIT_CACHE_BOUNCE_SLOTS) uniform usamplerBuffer bounceSlots;
// of points; w: bits of the next layer's number + 1
layout(binding = UNIT_CACHE_BOUNCE_PLACES) uniform samplerBuffer bouncePlaces;
const float kApart = 0.25;  // cells along the normal, at most, from a surface to its point
#if LINKS
// unordered BounceLinks: each dispatch writes those of its own points
layout(std430, binding = CACHE_LINKS_BUFFER) writeonly restrict buffer BounceLinks { uint links[]; };
// unordered BouncePlaces: likewise
// aliased BouncePlaces: with `probes` an invocation changes its own place and reads no other; without, none writes
layout(std430, binding = CACHE_BOUNCED_BUFFER) restrict buffer BouncePlaces { vec4 places[]; };
#else
layout(binding = UNIT_CACHE_BOUNCED) uniform samplerBuffer bouncedLight;
#endif

// The point of a cell's slot in whose plane a surface lies. 0: none.
uint pointOf(int face, ivec3 cell, vec3 position, vec3 normal) {
  if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, bounceCells))) return 0u;
  uint point = texelFetch(bounceSlots,
                          ((face * bounceCells.z + cell.z) * bounceCells.y + cell.y) * bounceCells.x + cell.x).x;
  uint nearest = 0u;
  float least = kApart * bounceCell;
  for (int layer = 0; layer < 4 && point != 0u; ++layer) {
    vec4 place = texelFetch(bouncePlaces, int(point) - 1);
    float apart = abs(dot(normal, place.xyz - position));
    if (apart < least) {
      least = apart;
      nearest = point;
    }
    point = floatBitsToUint(place.w);
  }
  return nearest;
}

// Whether nothing stands between a surface and a point in its plane, such as the wall between two rooms with one floor:
// straight along the surface or, where that is curved, above it.
bool isBeside(Surface at, uint point) {
  const float kClear = 0.001, kAbove = 0.1;  // cells
  vec3 from = offsetRay(at.position, at.geometricNormal, at.magnitude),
       to = texelFetch(bouncePlaces, int(point) - 1).xyz + kClear * bounceCell * at.normal,
       lift = kAbove * bounceCell * at.normal;
  if (!anyHit(Ray(from, 0.0, to - from, 1.0), kNoHit)) return true;
  return !anyHit(Ray(from, 0.0, lift, 1.0), kNoHit) && !anyHit(Ray(to, 0.0, lift, 1.0), kNoHit) &&
         !anyHit(Ray(from + lift, 0.0, to - from, 1.0), kNoHit);
}

// A point near a surface's, drawn as often as a trilinear lookup among those of the faces that the normal leans to
// would weigh it; of these, the first that nothing stands before. 0: none.
uint pointNear(Surface at, vec4 xi) {
  const int kPlaces = 9;
  vec3 normal = at.normal, lean = normal * normal, inCells = (at.position - bounceMinimum) / bounceCell;
  ivec3 own = clampedInt(floor(inCells), ivec3(-2), bounceCells + 1);  // more than a cell outside remains outside
  int drawn = xi.w < lean.x ? 0 : xi.w < lean.x + lean.y ? 1 : 2;
  // The surface was entered for the axis that it leans to most, maybe on the other side of a cell's border. Or its own
  // point lies in a gap: then a neighbour stands for it.
  int most = lean.x > max(lean.y, lean.z) ? 0 : lean.y > lean.z ? 1 : 2;
  uint first = 0u;
  for (int i = 0; i < kPlaces; ++i) {
    ivec3 cell = own;
    if (i == 0) cell = clampedInt(floor(inCells + xi.xyz - 0.5), ivec3(-2), bounceCells + 1);
    if (i > 2) cell[(most + (i - 3) / 2) % 3] += 1 - 2 * ((i - 3) & 1);
    int axis = i < 2 ? drawn : most;
    uint point = pointOf(faceOf(axis, normal[axis]), cell, at.position, normal);
    if (point == 0u || point == first) continue;
    if (isBeside(at, point)) return point;
    if (first == 0u) first = point;
  }
  return 0u;
}
#endif

#if EMISSION && OWN
// Radiance of an emissive surface, as far as rays count for it.
vec3 emissionNear(Surface at, Hit hit, float cosine, vec3 direction) {
  vec3 emission = emissionAt(at.material, hit.triangle, hit.barycentrics);
  float density = pickDensity(hit.triangle);
  if (!(density > 0.0)) return vec3(0.0);
  float ofRays = float(CACHE_LANES * RAYS) * (areaOverDensity / density) * cosine * -dot(at.geometricNormal, direction);
  return emission * (ofRays / (kPi * hit.t * hit.t + ofRays));
}
#endif

#if ENVIRONMENT_PICTURE && OWN
// Light of a texel of the sky, drawn by its power, as far as these rays count for it beside those that go everywhere:
// the balance heuristic [Veach1997].
vec3 skyOfTexel(Surface surface, uint triangle, PathNumbers numbers) {
  vec3 radiance;
  float pdf;
  vec3 direction = environmentSample(randomPair(numbers, 2u, kPurposeScatter),
                                     randomWords(numbers, 2u, kPurposePick).xy, radiance, pdf);
  float cosine = dot(direction, surface.normal);
  if (!(cosine > 0.0) || !(pdf > 0.0) || !(dot(direction, surface.geometricNormal) > 0.0)) return vec3(0.0);
  Ray ray = Ray(offsetRay(surface.position, surface.geometricNormal, surface.magnitude), 0.0, direction, 3e38);
  return anyHit(ray, triangle) ? vec3(0.0) : radiance * (cosine / (cosine / kPi + pdf));
}
#endif

vec3 lookAround(CacheRecord record, uint index, uint ray) {
  Surface surface = surfaceOf(record);
  PathNumbers numbers = PathNumbers(pcg4d(uvec4(record.cell)).x, ray, tracer.seed);
  vec3 direction = cosineSample(surface.normal, randomPair(numbers, 1u, kPurposeScatter)), sum = vec3(0.0);
#if ENVIRONMENT_PICTURE && OWN
  sum = skyOfTexel(surface, record.triangle, numbers);
#endif
#if LINKS
  uint link = 3u * (index * uint(CACHE_LANES) + ray);
  links[link] = 0u;
  met[ray] = 0u;
#endif
  if (!(dot(direction, surface.geometricNormal) > 0.0)) return sum;
  Hit hit = closestHit(
      Ray(offsetRay(surface.position, surface.geometricNormal, surface.magnitude), 0.0, direction, 3e38),
      record.triangle);
  if (hit.triangle == kNoHit) {
#if ENVIRONMENT && OWN
    vec3 sky = kPi * environmentRadiance(direction);
#if ENVIRONMENT_PICTURE
    float density = dot(direction, surface.normal) / kPi;
    sky *= density / (density + environmentPdf(direction));
#endif
    sum += sky;
#endif
    return sum;
  }
  Surface at = surfaceAt(hit.triangle, hit.barycentrics, direction);
#if EMISSION && OWN
#if LINKS
  if (!isNearSmallLamp(surface.position, bounceCell))
#endif
    sum += kPi * emissionNear(at, hit, dot(direction, surface.normal), direction);
#endif
#if BOUNCED
  uint point = pointNear(at, vec4(unitFloat(randomWords(numbers, 1u, kPurposePick).xy),
                                                unitFloat(randomWords(numbers, 1u, kPurposeChoice).xy)));
  vec3 albedo = min(wholeAlbedoAt(at), vec3(1.0));
#if LINKS
  // Rounded down: no surface reflects more than it does.
  uvec3 steps = uvec3(clampedInt(floor(albedo * 65535.0), ivec3(0), ivec3(65535)));
  links[link] = point;
  bool inside = dot(normalOf(hit.triangle), direction) > 0.0 && hit.t < kNear * bounceCell;
  met[ray] = inside || hit.t < kGap * bounceCell ? 2u : 1u;
  links[link + 1u] = steps.x | steps.y << 16u;
  links[link + 2u] = steps.z;
#else
  if (point != 0u) sum += albedo * texelFetch(bouncedLight, int(point) - 1).rgb;
#endif
#endif
  return sum;
}

void main() {
  uint lane = gl_LocalInvocationID.x, place = firstGroup + gl_WorkGroupID.x;
  if (place >= uint(lit.length())) return;
  uint index = lit[place];
  if (index >= uint(records.length())) return;
  CacheRecord record = records[index];
  vec3 own = vec3(0.0);
  for (int i = 0; i < RAYS; ++i) own += lookAround(record, index, lane + uint(i * CACHE_LANES));
  found[lane] = own;
  barrier();
  if (lane != 0u) return;
  // Groups lie in one row. A compiler that knew the number of lanes would load all of `found` into registers at once.
  int lanes = min(CACHE_LANES * int(gl_NumWorkGroups.y), CACHE_LANES);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < lanes; ++i) sum += found[i];  // ends: at most CACHE_LANES
  sum /= float(CACHE_LANES * RAYS);
#if LINKS
  uint surfaces = 0u, near = 0u;
  for (int i = 0; i < lanes; ++i) {  // ends: at most CACHE_LANES
    surfaces += min(met[i], 1u);
    near += met[i] / 2u;
  }
  if (probes && near > kMostShut)  // out of every surface's plane
    places[index].xyz += 1e6 * bounceCell * record.normal;
  if (surfaces == 0u || (probes && near > kMostShut)) records[index].state = record.state | CACHE_ALONE;
#else
  sum += record.irradiance;
#endif
  records[index].irradiance = sum;
  if (last != 0u) records[index].paths = CACHE_GATHERED;
}
