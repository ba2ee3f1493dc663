// Boundaries that rays cross, and media that straight lines cross: the boundaries beside a surface, and the part of a
// shadow ray's light that arrives. Include the lights, path.glsl and shadow_ray.glsl before this file.
//
// Flags: INTERIORS (closed boundaries: paths count those that contain them), MEDIA, HETEROGENEOUS; deviations
// STRAIGHT_SHADOW_RAYS, UNATTENUATED_SHADOW_RAYS.
#include "pathtracer/boundary.glsl"
#if MEDIA
#include "pathtracer/media.glsl"
layout(std430, binding = 6) restrict readonly buffer MediumBlock { MediumRecord media[]; };
// NVIDIA's compiler refuses a structure of such a block as an argument (C1317), where OpenGL allows it.
MediumRecord mediumOf(int index) { return media[index]; }
// Read wherever they are used on GPUs, rather than kept in registers.
MediumRecord mediumAt(int index) { return media[index + int(hiddenZero())]; }
#endif
#if HETEROGENEOUS
#include "pathtracer/density.glsl"
DensityRecord gridOf(MediumRecord medium) { return densityRecords[medium.grid + int(hiddenZero())]; }
#endif

int rankOf(uint triangle) { return int(materials[triangleData[triangle * TRIANGLE_WORDS].w].boundary); }

// Whether a ray comes from the triangle's front side.
bool facesAgainst(uint triangle, vec3 direction) { return dot(normalOf(triangle), direction) < 0.0; }

#if TOUCHING
// Crosses all boundaries within a gap of a surface, where rounding decides. Rays that continue behind the surface start
// inside `beyond`, rays in front of it inside `before`. Coinciding faces may be hit in any order, up to half a gap
// before the surface too, so the counts decide: a boundary can be entered if the path is outside it and left if it is
// inside. A short ray finds the faces, hit after hit.
struct Coincident {
  uvec4 beyond, before;
  float tMin;
  uint skip;
  uint crossed;
  float gap;  // of the surface
};
Coincident coincident;
const uint kMostCoincident = 8u;
#if SPILLED
void reloadCoincident() {
  uvec4 w = state[wordAt(kCoincidentWord + 2u)];
  coincident = Coincident(state[wordAt(kCoincidentWord)], state[wordAt(kCoincidentWord + 1u)],
                          uintBitsToFloat(w.x), w.y, w.z, uintBitsToFloat(w.w));
}
void spillCoincident() {
  state[wordAt(kCoincidentWord)] = coincident.beyond;
  state[wordAt(kCoincidentWord + 1u)] = coincident.before;
  state[wordAt(kCoincidentWord + 2u)] =
      uvec4(floatBitsToUint(coincident.tMin), coincident.skip, coincident.crossed, floatBitsToUint(coincident.gap));
}
#else
void reloadCoincident() {}
void spillCoincident() {}
#endif

// ahead: one gap long, through to the far side of the surface.
Ray coincidentRay(Coincident b, vec3 position, vec3 ahead) { return Ray(position - ahead, b.tMin, 2.0 * ahead, 1.0); }

// Handles a hit of the short ray. False: the search is over, and `hit` is the first surface found that bounds nothing,
// or kNoHit.
bool crossCoincident(inout Coincident b, inout Hit hit, vec3 ahead) {
  if (hit.triangle == kNoHit) return false;
  int rank = rankOf(hit.triangle);
  bool front = facesAgainst(hit.triangle, ahead);
  if (hit.t < 0.25) {
    if (rank >= 0 && isInsideOf(b.before, rank) == front) crossBoundary(b.before, rank, !front);
  } else {
    if (rank < 0) return false;
    if (isInsideOf(b.beyond, rank) != front) crossBoundary(b.beyond, rank, front);
  }
  b.tMin = hit.t;
  b.skip = hit.triangle;
  if (++b.crossed < kMostCoincident) return true;
  hit.triangle = kNoHit;
  return false;
}
#endif

#if MEDIA
const uint kMostTries = 256u;  // tentative collisions of a straight line through a grid

vec3 mediumTransmittance(MediumRecord medium, vec3 origin, vec3 direction, float distance, inout uvec4 words) {
  vec3 through = vec3(1.0);
#if HETEROGENEOUS
  if (medium.grid >= 0) {
    // Ratio tracking [Novak2014]: each tentative collision multiplies by the probability of a null collision. Roulette
    // starts below a tenth. A bound far above the density causes endless null collisions, so after a maximum number the
    // rest of the way is integrated cell by cell. That keeps the mean unbiased: at every collision, the estimate so far
    // times the transmittance of the rest has the transmittance of the whole way as its mean.
    DensityMarch march;
    float bound = 0.0, t = 0.0;
    uint tries = 0u;
    bool goesOn = densityMarchStart(gridOf(medium), origin, direction, distance, march);
    int left = densityMostBlocks(gridOf(medium));
    for (; left > 0 && goesOn && densityMarchNext(gridOf(medium), march, bound); --left) {  // ends: as many as blocks
      ++loopIterations;
      float rate = medium.majorant * bound;
      if (!(rate > 0.0)) continue;
      t = march.near;
      for (uint step = 0u; step <= kMostTries; ++step) {
        ++loopIterations;
        goesOn = ++tries <= kMostTries;
        if (!goesOn) break;
        words = pcg4d(words);
        t += exponentialSample(words.x) / rate;
        if (t >= march.far) break;
        float d = densityAt(gridOf(medium), march.origin + t * march.direction);
        through *= max(1.0 - medium.extinction * (d / rate), vec3(0.0));
        float largest = max(through.r, max(through.g, through.b));
        if (largest < 0.1) {
          goesOn = unitFloat(words.y) < 10.0 * largest;
          if (!goesOn) break;
          through /= 10.0 * largest;
        }
      }
    }
    if (tries > kMostTries) {
      float rest = densityIntegral(gridOf(medium), march.origin, march.direction, t, march.last);
      through *= exp(-medium.extinction * rest);
    } else if (!goesOn && tries > 0u) {
      through = vec3(0.0);
    }
  } else
#endif
  {
    through = exp(-medium.extinction * min(distance, kFar));
  }
  return through;
}
#endif

// Handles a shadow ray's hit. Index-matched boundaries are crossed; a refracting one blocks the light, since the
// straight line is no light path then. True: the ray continues behind it. Otherwise the remaining shadow.light arrives.
bool crossShadow(Hit hit) {
  int rank = -1;
  bool front = false;
  if (hit.triangle != kNoHit) {
    rank = rankOf(hit.triangle);
    front = facesAgainst(hit.triangle, shadow.direction);
    if (rank < 0 || shadow.crossed >= 255u) {
      shadow.light = vec3(0.0);
      return false;
    }
  }
#if MEDIA && !UNATTENUATED_SHADOW_RAYS  // [VPT2024, 4.1] only tests whether a point is in shadow
  int medium = mediumInside(shadow.inside);
  if (medium >= 0) {
    float unit = shadow.infinite ? 1.0 : length(shadow.direction),
          far = hit.triangle == kNoHit ? (shadow.infinite ? kFar : 1.0) : hit.t;
    uvec4 words = shadow.words;
    vec3 through = mediumTransmittance(mediumOf(medium), shadow.origin + shadow.from * shadow.direction,
                                       shadow.direction / unit, max(far - shadow.from, 0.0) * unit, words);
#if HETEROGENEOUS
    forgetAddresses();
    reloadShadow();
#endif
    shadow.words = words;
    shadow.light *= through;
  }
#endif
  if (hit.triangle == kNoHit || all(equal(shadow.light, vec3(0.0)))) return false;
  crossBoundary(shadow.inside, rank, front);
  ++shadow.crossed;
  shadow.tMin = shadow.from = hit.t;
  shadow.skip = hit.triangle;
  return true;
}

// Whether a shadow ray that has crossed a boundary is still in the refractive index it started in.
bool shadowGoesOn() {
#if !STRAIGHT_SHADOW_RAYS
  if (iorInside(shadow.inside) != shadow.ior) shadow.light = vec3(0.0);
#endif
  return any(greaterThan(shadow.light, vec3(0.0)));
}
