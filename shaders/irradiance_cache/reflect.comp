// What coats, mirrors and glass reflect and let through at each pixel, but lamps' highlights, which forward shading
// adds: along rays drawn from the coat's lobe, or along the smooth surface's two directions, up to the first rough
// surface. That one shows its emission, the lamps that reach it and the irradiance of the records around it, as if
// matte. Where there are none, paths go on. Beyond all surfaces is the environment.
// Rough coats reflect the pixel's own irradiance, as if light came from all sides alike: their lobe is as wide.
// Media are a preview (body.glsl). Alpha: of a rough coat's lobe, for smooth.comp; -1 where a cloud hides the surface.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_CACHE_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "pathtracer/fresnel.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/shadow_start.glsl"
#include "rays/environment.glsl"
#include "lib/spot.glsl"
#include "irradiance_cache/lookup.glsl"
#include "irradiance_cache/seen.glsl"
#if BODIES || CLOUDS
#include "irradiance_cache/body.glsl"
#endif
// unordered reflected: each dispatch writes its own part of the picture
layout(rgba32f, binding = 0) restrict uniform image2D reflected;
uniform ivec2 firstPixel;
uniform int rays;         // per sample of a pixel
uniform float weight;     // of what they find
uniform int pixelSample;  // its number: each draws other random numbers
uniform bool keepsCoats;  // where the sample before showed a coat, what it reflects stays
#define SHINING (NEXT_EVENT && (EMISSION || ENVIRONMENT_PICTURE))  // lights that rays find too
#if CLOUDS || SHINING
#include "rays/lights.glsl"
#define lamps lights
#elif LAMPS
layout(std430, binding = 4) readonly restrict buffer LampBlock { PathLight lamps[]; };  // the first LAMPS
#endif

const float kRays = 0.25, kNoRays = 0.5;  // alpha up to which rays alone show a coat, and from which none do
const uint kMostSurfaces = 12u + 12u * uint(BODIES) + 24u * uint(CLOUDS);  // and collisions, along a ray
const uint kMostBounces = 4u;             // beyond records
const float kLampRays = 2.0;              // on average, from a surface that a ray has found
const uint kMostBoundaries = 4u;          // between a surface in glass or water and a lamp
const uint kPurposeBody = 5u, kPurposeCloud = 6u, kPurposeCloudWay = 7u, kPurposeCloudLight = 8u, kPurposeLamp = 9u;

bool counts(uint scatterings) { return scatterings >= tracer.minScatterings && scatterings <= tracer.maxScatterings; }

// Share of a lamp's light that arrives. Glass and water between, within which the ray has come to the surface, let it
// through without bending it: for a level floor under level water that is exact, elsewhere it leaves out caustics.
float shareOfLamp(Ray ray, uint triangle, bool isWithin) {
  if (!isWithin) return anyHitToLamp(ray, triangle) ? 0.0 : 1.0;
  float share = 1.0;
  vec3 direction = normalize(ray.direction);
  for (uint k = 0u; k < kMostBoundaries; ++k) {
    if (!anyHitToLamp(ray, triangle)) return share;
    Hit hit = closestHit(ray, triangle);
    if (hit.triangle == kNoHit) return share;
    Surface surface = surfaceAt(hit.triangle, hit.barycentrics, direction);
    PathMaterial material = materials[surface.material];
    if (material.kind != PATH_DIELECTRIC) return 0.0;
    float cosT;
    share *= 1.0 - fresnelDielectric(min(-dot(surface.normal, direction), 1.0), 1.0 / material.ior, cosT);
    triangle = hit.triangle;
    vec3 from = offsetRay(surface.position, -surface.geometricNormal, surface.magnitude);
    if (ray.tMax == 1.0) ray.direction = ray.origin + ray.direction - from;
    ray.origin = from;
  }
  return 0.0;
}

#if LAMPS
// Irradiance from a lamp if nothing is between; sets the ray to it from a point above the surface.
vec3 unshadowed(int i, Surface surface, ShadowStart start, out Ray ray) {
  PathLight lamp = lamps[i];
  bool infinite = lamp.kind == PATH_LIGHT_SUN;
  vec3 away = infinite ? -lamp.b : lamp.a - surface.position;
  float distance2 = infinite ? 1.0 : dot(away, away);
  vec3 direction = away * inversesqrt(max(distance2, 1e-30)), arriving = lamp.c / max(distance2, 1e-30);
  if (lamp.kind == PATH_LIGHT_SPOT)
    arriving *= spotFalloff(-dot(direction, lamp.b), uintBitsToFloat(lamp.p), uintBitsToFloat(lamp.q));
  ray = infinite ? Ray(start.origin, 0.0, direction, 3e38) : Ray(start.origin, 0.0, lamp.a - start.origin, 1.0);
  float cosine = dot(direction, surface.normal);
  return cosine > 0.0 && dot(direction, start.normal) > 0.0 ? cosine * arriving : vec3(0.0);
}
#endif

// Irradiance from sun, spots and omnidirectional lamps: along kLampRays rays on average, or fewer, chosen by what they
// would give, by systematic sampling [Kitagawa1996]. xi: 0 to 1.
vec3 lampIrradiance(Surface surface, uint triangle, bool isWithin, float xi) {
  vec3 sum = vec3(0.0);
#if LAMPS
  ShadowStart start = shadowStart(surface, triangle);
  Ray ray;
  float all = 0.0, passed = 0.0;
  for (int i = 0; i < lamps.length() && i < LAMPS; ++i) all += largestOf(unshadowed(i, surface, start, ray));
  for (int i = 0; i < lamps.length() && i < LAMPS && all > 0.0; ++i) {
    vec3 arriving = unshadowed(i, surface, start, ray);
    float expected = kLampRays * largestOf(arriving) / all;  // rays
    if (expected < 1.0) passed += expected;
    if (!(expected >= 1.0 || passed > xi)) continue;
    if (expected < 1.0) xi += 1.0;
    sum += arriving / min(expected, 1.0) * shareOfLamp(ray, start.skip, isWithin);
  }
#endif
  return sum;
}

#if SHINING
// Irradiance from an emissive surface or the environment's picture: the part of next-event estimation, where a
// cosine-weighted ray finds the other part.
vec3 shiningIrradiance(Surface surface, uint triangle, bool isWithin, PathNumbers numbers, uint event) {
  LightSample light;
  if (!sampleLight(surface.position, surface.normal, randomPair(numbers, event, kPurposeLight),
                   randomWords(numbers, event, kPurposePick), light) || light.pdf == 0.0)
    return vec3(0.0);
  float cosine = dot(light.direction, surface.normal);
  if (!(cosine > 0.0 && dot(light.direction, surface.geometricNormal) > 0.0)) return vec3(0.0);
  vec3 start = offsetRay(surface.position, surface.geometricNormal, surface.magnitude);
  Ray ray = light.infinite ? Ray(start, 0.0, light.direction, 3e38) : Ray(start, 0.0, light.end - start, 1.0);
  float share = shareOfLamp(ray, triangle, isWithin);
  return light.value * (share * cosine * (isWithin ? 1.0 : powerHeuristic(light.pdf, cosine / kPi)));
}
#endif

#if CLOUDS
// Radiance that a point in a cloud scatters of one light.
vec3 lightIn(vec3 place, PathNumbers numbers, uint event) {
  vec3 arriving = vec3(0.0);
#if NEXT_EVENT
  LightSample light;
  if (!sampleLight(place, vec3(0.0), unitFloat(randomWords(numbers, event, kPurposeLight).xy),
                   randomWords(numbers, event, kPurposePick), light))
    return arriving;
  arriving = light.value / (4.0 * kPi);
  int cloud = cloudAround;
  uint triangle = kNoHit;
  vec3 from = place;
  float reach = light.infinite ? 1e30 : (1.0 - 1e-4) * distance(light.end, place);
  for (uint k = 0u; k < kMostBounces && any(greaterThan(arriving, vec3(0.0))); ++k) {  // through matched boundaries
    Hit hit = closestHit(Ray(from, 0.0, light.direction, 3e38), triangle);
    float way = min(hit.t, reach);
    uvec4 words = randomWords(numbers, kMostBounces * event + k, kPurposeCloudLight);
    if (collides(from, light.direction, words, way, arriving)) arriving = vec3(0.0);
    if (hit.t >= reach || hit.triangle == kNoHit) break;
    Surface surface = surfaceAt(hit.triangle, hit.barycentrics, light.direction);
    if (bodies[surface.material].kind != BODY_CLOUD) arriving = vec3(0.0);
    cloudAround = surface.front ? int(surface.material) : -1;
    triangle = hit.triangle;
    from = offsetRay(surface.position, -surface.geometricNormal, surface.magnitude);
    reach -= hit.t;
  }
  cloudAround = cloud;
#endif
  return arriving;
}
#endif

// Whether a ray passes on at a surface, as at a mirror. Sets its new direction, and the side it leaves on.
bool passes(Surface surface, bool mirrors, inout vec3 throughput, inout vec3 direction, out float side) {
  PathMaterial material = materials[surface.material];
  side = 1.0;
  if (material.kind == PATH_NONE) {
    side = -1.0;
    return true;
  }
#if CLOUDS
  if (bodies[surface.material].kind == BODY_CLOUD) {
    cloudAround = surface.front ? int(surface.material) : -1;
    side = -1.0;
    return true;
  }
#endif
  vec3 normal = dot(surface.normal, direction) < 0.0 ? surface.normal : surface.geometricNormal;
  float cosI = min(-dot(direction, normal), 1.0), cosT;
  if (material.kind == PATH_MIRROR || (material.kind == PATH_CONDUCTOR && material.roughness == 0.0)) {
    throughput *= material.kind == PATH_MIRROR ? material.specular : schlick(material.specular, cosI);
  } else if (material.kind == PATH_DIELECTRIC) {
#if BODIES
    ivec4 before = aroundRay;
    int here = bodyAround();
    if (surface.front) enterBody(int(surface.material));
    else leaveBody(int(surface.material));
    int beyond = bodyAround();
    float eta = iorOf(here) / iorOf(beyond);
    if (here == beyond || eta == 1.0) {
      side = -1.0;
      return true;
    }
#else
    float eta = surface.front ? 1.0 / material.ior : material.ior;
#endif
    float reflectance = fresnelDielectric(cosI, eta, cosT);
    if (mirrors) throughput *= reflectance;
    else if (reflectance < 1.0) {
      if (surface.front) throughput *= 1.0 - reflectance;  // light that is thrown back inside comes out elsewhere
      direction = normalize(eta * direction + (eta * cosI - cosT) * normal);
      side = -1.0;
      return true;
    }
#if BODIES
    aroundRay = before;
#endif
  } else {
    return false;
  }
  direction = normalize(direction + 2.0 * cosI * normal);
  if (!(dot(direction, surface.geometricNormal) > 0.0)) direction = reflect(direction, surface.geometricNormal);
  return true;
}

#if BODIES
// Where light falls onto the body around the ray: what its medium scatters shows it.
struct Entry {
  vec3 light;  // irradiance over pi
  bool isKnown;
  Surface surface;
};
Entry entry;

// At a surface that a ray has refracted at, from outside.
void enterThrough(Surface surface, uint triangle, PathNumbers numbers, uint event) {
  entry.surface = surface;
  entry.light = (cachedIrradiance(surface.position + cache.rayOrigin, surface.normal, entry.isKnown) +
                 lampIrradiance(surface, triangle, false, randomPair(numbers, event, kPurposeLamp).x)) / kPi;
}
#endif

// Radiance along a ray that has left a surface of the pixel; scatterings: so far; isWithin: in glass or water without a
// medium.
vec3 radianceAlong(Ray ray, uint triangle, vec3 throughput, uint scatterings, PathNumbers numbers, bool isWithin,
                   bool isFromCloud) {
  vec3 sum = vec3(0.0);
  bool last = false;  // the ray only collects what shines at its end
  uint bounces = 0u;
  float pdf = 0.0;  // of the ray's direction, where shiningIrradiance has looked for what it may find
  bool isSampled = isFromCloud;  // what shines at its end is found by next-event estimation, or is a caustic
  for (uint k = 0u; k < kMostSurfaces; ++k) {
    Hit hit = closestHit(ray, triangle);
#if CLOUDS
    // A cloud on the way
    float distance = min(hit.t, 1e30);
    if (collides(ray.origin, ray.direction, randomWords(numbers, 1u + k, kPurposeCloud), distance, throughput)) {
      ++scatterings;
      if (last || scatterings > tracer.maxScatterings) break;
      vec3 place = ray.origin + distance * ray.direction;
      if (counts(scatterings)) sum += throughput * lightIn(place, numbers, 1u + k);
      ray = Ray(place, 0.0, isotropicDirection(unitFloat(randomWords(numbers, 1u + k, kPurposeCloudWay).xy)), 3e38);
      triangle = kNoHit;
      isSampled = NEXT_EVENT != 0;
      pdf = 0.0;
      continue;
    }
#endif
#if BODIES
    // The medium of the body that the ray is in
    int body = bodyAround();
    if (body >= 0 && bodies[body].kind == BODY_MEDIUM) {
      vec3 through = exp(-bodies[body].extinction * min(hit.t, 1e30)),
           scattered = (1.0 - through) * bodies[body].reflectance;
      if (entry.isKnown) {
        if (counts(scatterings + 1u)) sum += throughput * scattered * entry.light;
        throughput *= through;
      } else {
        // Where no record is known the path goes on from there, as often as it matters.
        float stopped = scattered.r + scattered.g + scattered.b, passed = through.r + through.g + through.b,
              share = stopped / max(stopped + passed, 1e-20);
        if (randomPair(numbers, 1u + k, kPurposeBody).x < share) {
          throughput *= scattered / share;
          if (++scatterings > tracer.maxScatterings || ++bounces > kMostBounces) break;
          if (counts(scatterings)) sum += throughput * entry.light;
          aroundRay = ivec4(-1);
          vec3 outwards = cosineSample(entry.surface.normal, randomPair(numbers, 1u + k, kPurposeScatter));
          if (!(dot(outwards, entry.surface.geometricNormal) > 0.0)) break;
          ray = Ray(offsetRay(entry.surface.position, entry.surface.geometricNormal, entry.surface.magnitude), 0.0,
                    outwards, 3e38);
          triangle = kNoHit;
          pdf = 0.0;
          continue;
        }
        throughput *= through / (1.0 - share);
      }
    }
#endif

    // What is at its end
    if (hit.triangle == kNoHit) {
#if ENVIRONMENT
      if (counts(scatterings)) {
        vec3 sky = environmentRadiance(ray.direction);
#if SHINING && ENVIRONMENT_PICTURE
        if (pdf > 0.0) sky *= powerHeuristic(pdf, tracer.environmentPick * environmentPdf(ray.direction));
        if (isSampled) sky = vec3(0.0);
#endif
        sum += throughput * sky;
      }
#endif
      break;
    }
    Surface surface = surfaceAt(hit.triangle, hit.barycentrics, ray.direction);
    triangle = hit.triangle;
#if EMISSION
    if (counts(scatterings)) {
      vec3 emission = emissionAt(surface.material, triangle, hit.barycentrics);
#if SHINING
      float cosine = -dot(surface.geometricNormal, ray.direction);
      if (pdf > 0.0) emission *= powerHeuristic(pdf, lampDensityOfHit(triangle, ray.origin, hit.t, cosine));
#endif
      if (isSampled) emission = vec3(0.0);
      sum += throughput * emission;
    }
#endif
    if (last) break;
    pdf = 0.0;
#if CLOUDS
    isSampled = isSampled && bodies[surface.material].kind == BODY_CLOUD;
#endif

    // On from there
    float side;
    vec3 direction = ray.direction;
    if (!passes(surface, false, throughput, direction, side)) {
      ++scatterings;
      if (scatterings > tracer.maxScatterings) break;
      throughput *= wholeAlbedoAt(surface);
      if (counts(scatterings))
        sum += throughput / kPi *
               lampIrradiance(surface, triangle, isWithin, randomPair(numbers, 1u + k, kPurposeLamp).x);
      bool found;
      vec3 kept = cachedIrradiance(surface.position + cache.rayOrigin, surface.normal, found);
      if (found) {
        sum += throughput / kPi * kept;
        last = tracer.minScatterings > 1u;  // what shines directly is in no record
        if (!last) break;
      }
      if (++bounces > kMostBounces) break;
      direction = cosineSample(surface.normal, randomPair(numbers, 1u + k, kPurposeScatter));
#if SHINING
#if CLOUDS
      if (cloudAround < 0)  // a cloud would dim it
#endif
      {
        if (counts(scatterings))
          sum += throughput / kPi * shiningIrradiance(surface, triangle, isWithin, numbers, 1u + k);
        pdf = dot(direction, surface.normal) / kPi;
        isSampled = isWithin;
      }
#endif
      if (!(dot(direction, surface.geometricNormal) > 0.0)) break;
    } else if (materials[surface.material].kind != PATH_NONE) {
      ++scatterings;
#if BODIES
      if (side < 0.0 && surface.front && bodyAround() >= 0) enterThrough(surface, triangle, numbers, 1u + k);
#else
      if (side < 0.0) isWithin = surface.front;
      isSampled = isSampled || bounces > 0u;
#endif
    }
    ray = Ray(offsetRay(surface.position, side * surface.geometricNormal, surface.magnitude), 0.0, direction, 3e38);
  }
  return sum;
}

// What the pixel's surface shows of its surroundings. alpha: of a coat whose lobe rays are drawn from, else 0.
vec3 reflectedBy(Surface surface, uint triangle, vec3 view, PathNumbers numbers, out float alpha) {
  vec3 sum = vec3(0.0);
  alpha = 0.0;
  PathMaterial material = materials[surface.material];
  if (material.kind == PATH_DIFFUSE || material.kind == PATH_NONE) return sum;
  bool isSmooth = material.kind != PATH_COATED && (material.kind != PATH_CONDUCTOR || material.roughness == 0.0);
  if (isSmooth) {
    bool isGlass = material.kind == PATH_DIELECTRIC;
    for (int way = 0; way < 2; ++way) {
#if CLOUDS
      if (way == 0 && bodies[surface.material].kind == BODY_CLOUD) continue;  // nothing is reflected
      cloudAround = -1;
#endif
      if (way == 1 && !isGlass) break;
      vec3 throughput = vec3(1.0), direction = view;
      float side;
#if BODIES
      aroundRay = ivec4(-1);
#endif
      if (!passes(surface, way == 0, throughput, direction, side)) return sum;
      if (isGlass && way == 1 && side > 0.0) break;  // total reflection has been counted
#if BODIES
      if (side < 0.0 && bodyAround() >= 0) enterThrough(surface, triangle, numbers, 0u);
      else aroundRay = ivec4(-1);
#endif
      vec3 start = offsetRay(surface.position, side * surface.geometricNormal, surface.magnitude);
      bool isWithin = BODIES == 0 && isGlass && side < 0.0 && surface.front;
      sum += radianceAlong(Ray(start, 0.0, direction, 3e38), triangle, throughput, 1u,
                           PathNumbers(numbers.pixel, 2u * numbers.sampleIndex + uint(way), numbers.seed), isWithin,
                           false);
    }
    return sum;
  }
#if COATS
  Coat coat = coatAt(surface);
  if (all(equal(coat.specular, vec3(0.0)))) return sum;
  vec3 t, b, normal = dot(surface.normal, view) < 0.0 ? surface.normal : surface.geometricNormal;
  tangentFrame(normal, t, b);
  vec3 o = -vec3(dot(view, t), dot(view, b), dot(view, normal));
  float ofRays = 1.0 - smoothstep(kRays, kNoRays, coat.alpha);
  if (ofRays < 1.0) {
    bool found;
    vec3 kept = cachedIrradiance(surface.position + cache.rayOrigin, surface.normal, found);
    sum += (1.0 - ofRays) / kPi * coatAlbedo(coat, o.z) * kept;
  }
  if (!(ofRays > 0.0)) return sum;
  alpha = coat.alpha;
  int count = coat.alpha < 0.01 ? 1 : rays;  // a lobe narrower than a pixel needs no more
  vec2 start = randomPair(numbers, 0u, kPurposeScatter);
  for (int i = 0; i < rays && i < count; ++i) {
    vec3 h = ggxSample(o, coat.alpha, fract(start + float(i) * vec2(0.7548776662, 0.5698402910)));  // [Roberts2018]
    vec3 li = reflect(-o, h);
    if (!(li.z > 0.0)) continue;
    vec3 direction = normalize(li.x * t + li.y * b + li.z * normal);
    if (!(dot(direction, surface.geometricNormal) > 0.0)) continue;
    float pdf, facets = ggxReflect(o, li, coat.alpha, pdf);
    if (!(pdf > 0.0)) continue;
    vec3 throughput = ofRays * facets / (pdf * float(count)) * coatFresnel(coat, clamp(dot(o, h), 0.0, 1.0));
    Ray ray = Ray(offsetRay(surface.position, surface.geometricNormal, surface.magnitude), 0.0, direction, 3e38);
    uint number = numbers.sampleIndex * uint(rays) + uint(i);
    sum += radianceAlong(ray, triangle, throughput, 1u, PathNumbers(numbers.pixel, number, numbers.seed), false,
                         false);
  }
#endif
  return sum;
}

#if GRIDS
// Whether light along the pixel's ray collides in a cloud before its surface; then its radiance.
bool cloudBefore(vec3 eye, vec3 view, float distance, PathNumbers numbers, out vec3 radiance) {
  vec3 throughput = vec3(1.0);
  radiance = vec3(0.0);
  if (!collides(eye, view, randomWords(numbers, 0u, kPurposeCloud), distance, throughput)) return false;
  vec3 place = eye + distance * view;
  if (counts(1u)) radiance = throughput * lightIn(place, numbers, 0u);
  Ray ray = Ray(place, 0.0, isotropicDirection(unitFloat(randomWords(numbers, 0u, kPurposeCloudWay).xy)), 3e38);
  radiance += radianceAlong(ray, kNoHit, throughput, 1u, numbers, false, NEXT_EVENT != 0);
  return true;
}
#endif

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, tracer.picture.xy))) return;
  if (keepsCoats && imageLoad(reflected, pixel).a > 0.0) return;
  int index = pixel.y * tracer.picture.x + pixel.x;
  vec3 sum = vec3(0.0);
  float alpha = 0.0;  // of a rough coat; -1: a cloud is before the surface
  Hit hit;
  Surface surface;
  if (seenAt(index, hit, surface)) {
    vec3 eye, view;
    rayOf(index, eye, view);
#if GRIDS
    if (cloudBefore(eye, view, hit.t, PathNumbers(uint(index), uint(pixelSample), tracer.seed), sum)) alpha = -1.0;
    else
#endif
    {
#if NORMAL_MAPS
      applyNormalMap(surface, hit.triangle);
#endif
      sum = reflectedBy(surface, hit.triangle, view, PathNumbers(uint(index), uint(pixelSample), tracer.seed), alpha);
    }
  }
  imageStore(reflected, pixel, vec4(weight * sum, alpha));
}
