// Light of points, spots and the sun by way of refracting boundaries and mirrors, for the vertices at which paths
// requested it: specular manifold sampling [Zeltner2020]. A straight line to the lamp is no light path there, and no
// ray finds such lamps.
//
// From a random seed, Newton's method turns the ray that leaves the vertex until, refracted and reflected on its way,
// it ends on the lamp. The ray's derivatives by its first direction [Igehy1999] are Newton's matrix. They also say
// how the light spreads: a cone of solid angle dw at the vertex has the cross-section |det J| dw at the lamp, and
// along it L / n^2 is conserved. Whether boundaries reflect or refract is drawn first, one after the other. Several
// ways may lead to one lamp. Which of them Newton's method finds depends on the seed. The number of further seeds
// until the same way is found again has the mean 1 / (its probability), so it weighs the way without bias.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };

#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "pathtracer/fresnel.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/environment.glsl"
#include "rays/lights.glsl"
#include "rays/view.glsl"
layout(rgba32ui, binding = 0) readonly uniform uimage2D filmMean;  // w: number of samples
#include "pathtracer/path.glsl"
#if INSPECTED
#include "pathtracer/inspected.glsl"
#endif
#include "pathtracer/shadow_ray.glsl"
#if INTERIORS
#include "pathtracer/crossing.glsl"
#endif
#include "pathtracer/bsdf.glsl"
#include "pathtracer/manifold_request.glsl"

// Mirrors and refracting bodies: a ball around each, centre and radius; the first of its triangles, their number, bits
// of their area; and of each triangle its number and bits of the share of the area up to its end.
uniform int casterCount;
uniform vec4 casters[MOST_CASTERS];
uniform uvec4 casterParts[MOST_CASTERS];
layout(binding = 5) uniform usamplerBuffer casterTriangles;

const uint kPurposeSeed = kFreePurpose + 5u;
const uint kMostSteps = 16u;   // of Newton's method
const uint kMostHits = 24u;    // along a ray, boundaries that change nothing included
const uint kMostTurns = 18u;   // refractions and reflections
const uint kReflects = 4u;     // of 32: how often a boundary's reflection is sought instead of its refraction
const float kStill = 1e-4;     // radians; a step of Newton's method below this ends it
const float kSameWay = 1e-3;   // radians; between two findings of one way
const float kMostStep = 0.5;   // radians
const float kSteeper = 0.9;    // of the sine of the critical angle

// The lamp's point, or a direction to the sun.
struct Target {
  bool infinite;
  vec3 place;       // or the unit direction to it
  vec3 value;       // intensity, or irradiance, over the probability of the lamp
  vec3 normal;      // of a lamp's ball there; zero: a point
  bool isSpot;
  PathLight lamp;
};

Target drawTarget(PathNumbers numbers, uint event) {
  pickedLight = pick(randomWords(numbers, event, kPurposePick));
  PathLight lamp = lights[pickedLight];
  vec2 xi = randomPair(numbers, event, kPurposeLight);
  Target target = Target(lamp.kind == PATH_LIGHT_SUN, lamp.a, lamp.c / lamp.probability, vec3(0.0),
                         lamp.kind == PATH_LIGHT_SPOT, lamp);
  if (target.infinite) {
    target.place = -lamp.b;
    if (lamp.size > 0.0) {  // as in rays/lights.glsl
      target.place = coneSample(target.place, lamp.size, xi);
      target.value *= 2.0 / (2.0 - lamp.size);
    }
  } else if (lamp.size > 0.0) {  // any point of the ball, whose radiance is I / (pi r^2)
    target.normal = coneSample(vec3(0.0, 1.0, 0.0), 2.0, xi);
    target.place += lamp.size * target.normal;
    target.value *= 4.0;
  }
  return target;
}

// What the lamp sends along a ray that arrives in direction d.
vec3 sentAlong(Target target, vec3 d) {
  vec3 value = target.value;
  if (target.normal != vec3(0.0)) value *= max(-dot(d, target.normal), 0.0);
#if SPOTS
  if (target.isSpot)
    value *= spotFalloff(dot(d, -target.lamp.b), uintBitsToFloat(target.lamp.p), uintBitsToFloat(target.lamp.q));
#endif
  return value;
}

// A caster, by what it fills of the view from a point, roughly. u: random, and what is left of it.
int drawCaster(vec3 from, inout float u) {
  float sum = 0.0;
  int drawn = 0;
  for (int i = 0; i < MOST_CASTERS && i < casterCount; ++i) {  // each takes its share of those before it and itself
    vec3 to = casters[i].xyz - from;
    float weight = uintBitsToFloat(casterParts[i].z) / (dot(to, to) + casters[i].w * casters[i].w);
    sum += weight;
    float share = sum > 0.0 ? weight / sum : 0.0;
    if (u < share) drawn = i;
    u = u < share ? u / share : (u - share) / (1.0 - share);
  }
  return drawn;
}

// A point of a caster's surface, uniform by area.
vec3 drawCasterPoint(uvec4 part, float u, vec2 xi) {
  int low = int(part.x), high = int(part.x + part.y) - 1;
  while (low < high) {  // ends: halves
    int middle = (low + high) / 2;
    if (uintBitsToFloat(texelFetch(casterTriangles, middle).y) > u) high = middle;
    else low = middle + 1;
  }
  uint first = texelFetch(casterTriangles, low).x * TRIANGLE_WORDS;
  vec2 w = triangleSample(xi);
  vec3 a = uintBitsToFloat(triangleData[first].xyz), b = uintBitsToFloat(triangleData[first + 1u].xyz),
       c = uintBitsToFloat(triangleData[first + 2u].xyz);
  return a + w.x * (b - a) + w.y * (c - a);
}

// A direction from which Newton's method begins. A third of them each straight to the lamp, right where a pane or a
// water's surface lies between; to a point of a caster; and into the ball around a caster. normal: of the vertex's
// surface, if seeds behind it lead to nothing; else zero.
vec3 seedDirection(PathNumbers numbers, ManifoldRequest request, vec3 from, vec3 normal, Target target) {
  uvec4 words = pcg4d(randomWords(numbers, request.event, kPurposeSeed) + request.trials), other = pcg4d(words);
  uint way = scaledWord(other.x, 3u);
  if (way == 0u) return target.infinite ? target.place : normalize(target.place - from);
  float u = unitFloat(words.x);
  int caster = drawCaster(from, u);
  if (way == 1u) {
    vec3 to = drawCasterPoint(casterParts[caster], unitFloat(words.y), unitFloat(words.zw)) - from;
    return dot(to, to) > 0.0 ? normalize(to) : vec3(0.0, 1.0, 0.0);
  }
  vec3 to = casters[caster].xyz - from;
  float distance2 = dot(to, to), radius = casters[caster].w;
  if (distance2 > radius * radius)
    return coneSample(to * inversesqrt(distance2), ballLessCosine(radius, distance2), unitFloat(words.zw));
  return normal == vec3(0.0) ? coneSample(vec3(0.0, 1.0, 0.0), 2.0, unitFloat(words.zw))
                             : coneSample(normal, 1.0, unitFloat(words.zw));
}

// A ray and its derivatives by the two parameters of its first direction.
struct Tube {
  vec3 origin, direction;
  vec3 origins[2], directions[2];
};

#if SMOOTH_NORMALS
// Derivative of the shading normal where the hit moves by `move` within the triangle.
vec3 normalMove(Surface surface, uint triangle, vec3 move) {
  uint first = triangle * TRIANGLE_WORDS, n = first + TRIANGLE_WORDS - 3u;
  vec3 a = uintBitsToFloat(triangleData[first].xyz), e1 = uintBitsToFloat(triangleData[first + 1u].xyz) - a,
       e2 = uintBitsToFloat(triangleData[first + 2u].xyz) - a;
  vec3 na = uintBitsToFloat(triangleData[n].xyz), n1 = uintBitsToFloat(triangleData[n + 1u].xyz) - na,
       n2 = uintBitsToFloat(triangleData[n + 2u].xyz) - na;
  vec3 whole = na + surface.barycentrics.x * n1 + surface.barycentrics.y * n2;
  float size = length(whole), g11 = dot(e1, e1), g12 = dot(e1, e2), g22 = dot(e2, e2), det = g11 * g22 - g12 * g12;
  if (!(size > 1e-6) || !(det > 0.0)) return vec3(0.0);
  float p = dot(move, e1), q = dot(move, e2);
  vec3 turned = ((g22 * p - g12 * q) * n1 + (g11 * q - g12 * p) * n2) / (det * size);
  vec3 moved = turned - surface.normal * dot(surface.normal, turned);
  return surface.front ? moved : -(turned - surface.normal * dot(surface.normal, turned));
}
#endif

// Moves the tube's origin to the hit, `t` along it.
void moveTube(inout Tube tube, Surface surface, float t) {
  float along = dot(tube.direction, surface.geometricNormal);
  for (int i = 0; i < 2; ++i) {
    vec3 moved = tube.origins[i] + t * tube.directions[i];
    tube.origins[i] = moved - tube.direction * (dot(moved, surface.geometricNormal) / along);
  }
  tube.origin = surface.position;
}

// Reflects or refracts the tube at its origin, as scatter() does; eta: index before over index behind. Returns the
// reflectance of a boundary; 1 for total reflection, which leaves a tube that was to be refracted as it was.
float turnTube(inout Tube tube, Surface surface, uint triangle, bool reflects, float eta) {
  vec3 n = surface.normal, d = tube.direction;
  bool isShaded = dot(n, d) < 0.0;
  if (!isShaded) n = surface.geometricNormal;
  float cosI = clamp(-dot(d, n), 0.0, 1.0), cosT, reflectance = fresnelDielectric(cosI, eta, cosT);
  float scale = reflects ? 1.0 : eta, along = reflects ? 2.0 * cosI : eta * cosI - cosT;
  if (!reflects && !(cosT > 0.0)) return 1.0;
  vec3 turned = scale * d + along * n;
  float side = dot(turned, surface.geometricNormal);
  if (reflects ? side <= 0.0 : side >= 0.0) {  // the shading normal sends it to the wrong side of the face
    if (!reflects) return reflectance;
    isShaded = false;
    n = surface.geometricNormal;
    cosI = -dot(d, n);
    along = 2.0 * cosI;
    turned = d + along * n;
  }
  for (int i = 0; i < 2; ++i) {
    vec3 tilt = vec3(0.0);
#if SMOOTH_NORMALS
    if (isShaded) tilt = normalMove(surface, triangle, tube.origins[i]);
#endif
    float dI = -dot(tube.directions[i], n) - dot(d, tilt),
          dAlong = reflects ? 2.0 * dI : eta * dI - eta * eta * cosI * dI / cosT;
    tube.directions[i] = scale * tube.directions[i] + dAlong * n + along * tilt;
  }
  tube.direction = normalize(turned);
  return reflectance;
}

// One way from the vertex, traced along its turns as far as the lamp.
struct Way {
  bool fails;
  bool isSteeper;  // total reflection at the first boundary: to be tried again in another direction
  bool isBlocked;  // by a surface
  vec3 through;    // what boundaries, mirrors and media leave of the light
  uint turns;
  float ior;       // at the lamp
  Tube tube;       // its last segment
  float reach;     // of that, to the lamp
};

#if MEDIA
vec3 transmittance(uvec4 inside, vec3 from, vec3 direction, float distance, inout uvec4 words) {
  int medium = mediumInside(inside);
  return medium < 0 ? vec3(1.0)
                    : mediumTransmittance(mediumOf(medium), from, direction, max(distance, 0.0), words);
}
#endif

// The vertex, on the side of a surface to which a direction points.
struct Vertex {
  vec3 place;
  uvec4 inside;
  float ior;
};

// direction: from the vertex; if it is totally reflected at the first boundary, a steeper one.
Way followWay(Vertex vertex, uint skip, inout vec3 direction, Target target, uvec4 pattern, uvec4 words) {
  vec3 t1, t2;
  tangentFrame(direction, t1, t2);
  Way way = Way(false, false, false, vec3(1.0), 0u, vertex.ior,
                Tube(vertex.place, direction, vec3[2](vec3(0.0), vec3(0.0)), vec3[2](t1, t2)), 0.0);
  uvec4 inside = vertex.inside;
  float start = 0.0, behind = 0.0;  // along the segment: where to look for hits, and where its medium begins
  for (uint k = 0u; k < kMostHits; ++k) {
    Ray ray = Ray(way.tube.origin, start, way.tube.direction, 3e38);
    BvhTraversal traversal = beginRay(ray, skip);
    for (int left = bvhStepCount(); left > 0 && !isDone(traversal); --left) advanceRay(traversal, false);
    Hit hit = finishRay(traversal, ray.direction);
    way.reach = target.infinite ? 3e38 : dot(target.place - ray.origin, ray.direction);
    bool hits = hit.triangle != kNoHit &&
                (target.infinite || way.reach <= 0.0 || hit.t < way.reach * (1.0 - 1e-4));
    Surface surface;
    PathMaterial material;
    int rank = -1;
    bool turns = false;
    if (hits) {
      surface = surfaceAt(hit.triangle, hit.barycentrics, ray.direction);
      material = materials[surface.material];
      turns = material.kind == PATH_MIRROR || (material.kind == PATH_CONDUCTOR && material.roughness == 0.0);
#if INTERIORS
      rank = rankOf(hit.triangle);
#endif
    }
#if MEDIA
    float ends = hits ? hit.t : target.infinite ? kFar : way.reach;
    way.through *= transmittance(inside, ray.origin + behind * ray.direction, ray.direction, ends - behind, words);
#endif
    // The lamp, or what shades it.
    if (rank < 0 && !turns) {
      way.isBlocked = hits;
      way.fails = way.turns == 0u;
      return way;
    }
    // A boundary or a mirror.
    skip = hit.triangle;
    float ior = way.ior;
#if INTERIORS
    uvec4 beyond = inside;
    if (rank >= 0) {
      way.fails = !crossBoundary(beyond, rank, surface.front);
      ior = iorInside(beyond);
      if (ior == way.ior) {  // the light goes straight on
        inside = beyond;
        start = behind = hit.t;
        if (way.fails) return way;
        continue;
      }
      way.fails = way.fails || material.kind != PATH_DIELECTRIC || material.roughness > 0.0;
    }
#endif
#if NORMAL_MAPS
    way.fails = way.fails || material.normalTexture.layer >= 0;
#endif
    way.fails = way.fails || way.turns >= kMostTurns;
    if (way.fails) return way;
    // The ray turns there.
    bool reflects = turns || (pattern[way.turns / 6u] >> (5u * (way.turns % 6u)) & 31u) < kReflects;
    moveTube(way.tube, surface, hit.t);
    float fresnel = turnTube(way.tube, surface, hit.triangle, reflects, way.ior / ior);
    if (turns) {
      vec3 reflectance = material.specular;
#if GLOSSY
      if (material.kind == PATH_CONDUCTOR)
        reflectance = schlick(reflectance, max(-dot(ray.direction, surface.normal), 0.0));
#endif
      way.through *= reflectance;
    } else {
      way.through *= reflects ? fresnel * (32.0 / float(kReflects))
                              : (1.0 - fresnel) * (32.0 / float(32u - kReflects));
      if (!reflects && fresnel == 1.0) {
        vec3 along = ray.direction - dot(ray.direction, surface.normal) * surface.normal;
        float sine = kSteeper * ior / way.ior;
        way.isSteeper = way.turns == 0u;
        direction = normalize(sine * normalize(along) - sqrt(max(1.0 - sine * sine, 0.0)) * surface.normal);
        way.fails = true;
        return way;
      }
#if INTERIORS
      if (!reflects) {
        inside = beyond;
        way.ior = ior;
      }
#endif
    }
    way.tube.origin = beside(surface, reflects ? surface.geometricNormal : -surface.geometricNormal);
    ++way.turns;
    start = behind = 0.0;
  }
  way.fails = true;
  return way;
}

// A step of Newton's method: by how much the way misses the lamp, across it, and how that changes with the direction.
// Returns the step along the two tangents of the direction; det: of that change.
vec2 newtonStep(inout Way way, Target target, out float det) {
  Tube tube = way.tube;
  bool isAhead = target.infinite ? dot(tube.direction, target.place) > 0.0 : way.reach > 0.0;
  if (!target.infinite && !isAhead) way.reach = length(target.place - tube.origin);  // the ray turns round to it
  vec3 e1, e2, miss = target.infinite ? tube.direction : tube.origin + way.reach * tube.direction - target.place;
  tangentFrame(target.infinite ? target.place : tube.direction, e1, e2);
  mat2 change;
  for (int i = 0; i < 2; ++i) {
    vec3 c = target.infinite ? tube.directions[i] : tube.origins[i] + way.reach * tube.directions[i];
    change[i] = vec2(dot(c, e1), dot(c, e2));
  }
  det = change[0].x * change[1].y - change[0].y * change[1].x;
  vec2 off = vec2(dot(miss, e1), dot(miss, e2));
  vec2 step = vec2(off.y * change[1].x - off.x * change[1].y, off.x * change[0].y - off.y * change[0].x) / det;
  float size = length(step);
  way.fails = !(size < 3e38) || (size < kStill && !isAhead);
  return step;
}

// What a request looks for, and from where.
struct Seeker {
  Target target;
  uvec4 pattern;         // which boundaries reflect
  Vertex front, behind;  // the vertex, in front of its surface and behind it
  vec3 normal;           // of the surface; 0 in a medium
  bool isOneSided;
  Bsdf bsdf;
};

Seeker seekerOf(ManifoldRequest request, PathNumbers numbers) {
  Seeker seeker;
  seeker.target = drawTarget(numbers, request.event);
  seeker.pattern = randomWords(numbers, request.event, kPurposeWay);
  seeker.normal = vec3(0.0);
  seeker.front = seeker.behind = Vertex(request.position, request.inside, request.ior);
  seeker.isOneSided = true;
  if (request.triangle != kNoHit) {
    Surface surface = surfaceAt(request.triangle, request.barycentrics, request.incoming);
    PathMaterial material = materials[surface.material];
#if NORMAL_MAPS
    applyNormalMap(surface, request.triangle);
#endif
    seeker.normal = surface.geometricNormal;
    seeker.front.place = beside(surface, seeker.normal);
    seeker.behind.place = beside(surface, -seeker.normal);
#if ROUGH_DIELECTRICS
    int rank = rankOf(request.triangle);
    seeker.isOneSided = material.kind != PATH_DIELECTRIC;
    if (!seeker.isOneSided && rank >= 0) {
      crossBoundary(seeker.behind.inside, rank, surface.front);
      seeker.behind.ior = iorInside(seeker.behind.inside);
    }
#endif
    Path arriving;
    arriving.direction = request.incoming;
    arriving.ior = request.ior;
    seeker.bsdf = bsdfOf(arriving, surface, material, seeker.behind.ior);
  }
  return seeker;
}

// Follows one way. True: the request is done with.
bool seek(inout ManifoldRequest request, Seeker seeker, PathNumbers numbers) {
  bool isOver = false;
  // Follow a way from the seed, or in the direction to which Newton's method has turned.
  bool isSurface = seeker.normal != vec3(0.0);
  if (request.steps == 0u)
    request.direction = seedDirection(numbers, request, seeker.front.place,
                                      seeker.isOneSided ? seeker.normal : vec3(0.0), seeker.target);
  vec3 direction = request.direction, t1, t2;
  bool isBehind = isSurface && !(dot(direction, seeker.normal) > 0.0);
  Vertex vertex = isBehind ? seeker.behind : seeker.front;
  Way way;
  way.fails = true;
  way.isSteeper = false;
  if (!isBehind || !seeker.isOneSided)
    way = followWay(vertex, request.triangle, request.direction, seeker.target, seeker.pattern, seeker.pattern);
  if (way.isSteeper && ++request.steps <= kMostSteps) return false;
  float det = 0.0;
  if (!way.fails) {
    vec2 step = newtonStep(way, seeker.target, det);
    float size = length(step);
    if (!way.fails && !(size < kStill)) {
      tangentFrame(direction, t1, t2);
      step *= min(kMostStep / size, 1.0);
      request.direction = normalize(direction + step.x * t1 + step.y * t2);
      way.fails = ++request.steps > kMostSteps;
      if (!way.fails) return false;
    }
  }

  // The seed has led to a way, or to none.
  request.steps = 0u;
  bool hasFound = !way.fails && !way.isBlocked;
  if (request.status == kManifoldFirst) {
    isOver = !hasFound || !counts(request.scatterings + way.turns);
    if (isOver) return true;
    float pdf, ratio = vertex.ior / way.ior;
    vec3 value = vec3(0.0);
    if (isSurface) value = evaluate(seeker.bsdf, -request.incoming, direction, pdf);
#if MEDIA
    else value = phaseValue(mediumOf(mediumInside(request.inside)), request.incoming, direction);
#endif
    Path path;
    path.throughput = request.throughput;
    path.ior = vertex.ior;
    request.contribution =
        lightOf(path, value * way.through * sentAlong(seeker.target, way.tube.direction) * (ratio * ratio / abs(det)));
    isOver = !any(greaterThan(request.contribution, vec3(0.0)));
    request.found = direction;
    request.status = kManifoldTrials;
    request.trials = 1u;
  } else if (hasFound && length(direction - request.found) < kSameWay) {
    vec3 light = request.contribution * float(request.trials);
    spillRadiance(spilledRadiance() + light);
#if INSPECTED
    Path path;
    path.scatterings = request.scatterings;
    noteLight(path, numbers, light, seeker.target.lamp.kind, pickedLight, seeker.front.place, seeker.target.place,
              seeker.target.infinite);
#endif
    isOver = true;
  } else {
    ++request.trials;
  }
  return isOver;
}

// The lane's next request. False: there is none.
bool takeRequest(out ivec2 pixel) {
  uint number;
  if (loopIterations >= tracer.iterations || !takeFrom(kSeeking + turn, number)) return false;
  return findPixel(number, pixel) && manifoldStatus() != kManifoldDone;
}

void main() {
  PathNumbers numbers;
  ManifoldRequest request;
  Seeker seeker;
  bool isSeeking = false;
  while (true) {  // ends: each way adds iterations, up to tracer.iterations; the next submission continues
    if (!isSeeking) {
      ivec2 pixel;
      if (!takeRequest(pixel)) break;
      numbers = numbersOf(pixel, imageLoad(filmMean, pixel).w);
      request = restoreManifold();
      seeker = seekerOf(request, numbers);
      isSeeking = true;
    }
    loopIterations += 4u;
    bool isOver = seek(request, seeker, numbers);
    if (!isOver && loopIterations < tracer.iterations) continue;
    if (isOver) request.status = kManifoldDone;
    saveManifold(request);
    addTo((isOver ? kReady : kSeeking) + 1u - turn, numberOf(home));
    isSeeking = false;
    if (!isOver) break;
  }
  atomicMax(longest, loopIterations);
  atomicAdd(allIterations, loopIterations);
}
