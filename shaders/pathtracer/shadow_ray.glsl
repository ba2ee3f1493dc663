// The shadow ray of next-event estimation. It waits until the lane's one traversal is free.

// A sampled lamp whose ray waits to be traced.
struct Shadow {
  bool waits;
  bool infinite;
  uint skip;
  vec3 light;      // contribution to the path's radiance if nothing blocks it
  vec3 origin;
  vec3 direction;  // to the lamp, its length the distance; unit if the lamp is at infinity
#if INTERIORS
  float tMin;
  float from;      // where the current medium begins
  float ior;
  uint crossed;    // number of boundaries crossed
  uvec4 inside;    // the closed boundaries that contain the current position
  uvec4 words;     // random
#endif
#if INSPECTED
  uint kind;       // of the lamp
  uint number;     // its triangle, or index among the lights
#endif
};
Shadow shadow;

#if INTERIORS
#include "pathtracer/boundary.glsl"
const uint kPurposeTransmittance = kFreePurpose + 3u;
#endif

#if SPILLED
void reloadShadow() {
  uvec4 w0 = state[wordAt(kShadowWord)], w1 = state[wordAt(kShadowWord + 1u)], w2 = state[wordAt(kShadowWord + 2u)];
  shadow.origin = uintBitsToFloat(w0.xyz);
  shadow.skip = w0.w;
  shadow.direction = uintBitsToFloat(w1.xyz);
  shadow.infinite = w1.w != 0u;
  shadow.light = uintBitsToFloat(w2.xyz);
#if INTERIORS
  uvec4 w3 = state[wordAt(kShadowWord + 3u)];
  shadow.tMin = uintBitsToFloat(w2.w);
  shadow.from = uintBitsToFloat(w3.x);
  shadow.ior = uintBitsToFloat(w3.y);
  shadow.crossed = w3.z;
  shadow.inside = state[wordAt(kShadowWord + 4u)];
  shadow.words = state[wordAt(kShadowWord + 5u)];
#endif
}
void spillShadow() {
  state[wordAt(kShadowWord)] = uvec4(floatBitsToUint(shadow.origin), shadow.skip);
  state[wordAt(kShadowWord + 1u)] = uvec4(floatBitsToUint(shadow.direction), shadow.infinite ? 1u : 0u);
#if INTERIORS
  state[wordAt(kShadowWord + 2u)] = uvec4(floatBitsToUint(shadow.light), floatBitsToUint(shadow.tMin));
  state[wordAt(kShadowWord + 3u)] =
      uvec4(floatBitsToUint(shadow.from), floatBitsToUint(shadow.ior), shadow.crossed, 0u);
  state[wordAt(kShadowWord + 4u)] = shadow.inside;
  state[wordAt(kShadowWord + 5u)] = shadow.words;
#else
  state[wordAt(kShadowWord + 2u)] = uvec4(floatBitsToUint(shadow.light), 0u);
#endif
}
#else
void reloadShadow() {}
void spillShadow() {}
#endif

// start: origin of the ray, on the triangle `skip`. head: length of the way in the medium before it, since origins keep
// a distance from surfaces; negative: the way begins behind it.
void queueShadowRay(Path path, vec3 contribution, vec3 start, LightSample light, uint skip, float head,
                    PathNumbers numbers) {
  shadow.waits = true;
  shadow.infinite = light.infinite;
  shadow.skip = skip;
  shadow.light = lightOf(path, contribution);
#if INSPECTED
  shadow.kind = lights[pickedLight].kind;
  shadow.number = shadow.kind == PATH_LIGHT_TRIANGLE ? lights[pickedLight].p : pickedLight;
#endif
  shadow.origin = start;
  shadow.direction = light.infinite ? light.direction : light.end - start;
#if INTERIORS
  shadow.tMin = 0.0;
  shadow.from = light.infinite ? -head : -head / length(shadow.direction);
  shadow.ior = iorInside(path.inside);
  shadow.crossed = 0u;
  shadow.inside = path.inside;
  shadow.words = randomWords(numbers, path.event, kPurposeTransmittance);
#endif
  spillShadow();
}

#if INSPECTED
// Records the shadow ray's contribution. The path has not moved since, though it may have a new direction.
// inFlight: the ray started at a point of a flight through a medium, which scatters there.
void noteShadow(Path path, bool inFlight, PathNumbers numbers) {
  path.scatterings += inFlight ? 1u : 0u;
  noteLight(path, numbers, shadow.light, shadow.kind, shadow.number, shadow.origin,
            shadow.infinite ? shadow.direction : shadow.origin + shadow.direction, shadow.infinite);
}
#endif
