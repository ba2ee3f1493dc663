// Samples one light, chosen by its share of the scene's power, and a point on it: storage block 4. Flags: NEXT_EVENT,
// SUN, SPOTS, POINTS, EMISSION, ENVIRONMENT_PICTURE. A constant environment is left to scattered rays, which sample it
// optimally.
#include "lib/spot.glsl"

struct LightSample {
  vec3 direction;  // unit, towards it
  float pdf;       // density with which this direction is sampled, 1/sr; 0: the light has only one direction
  // radiance over pdf; for a light with one direction, the irradiance across the rays over the probability of picking
  // it
  vec3 value;
  vec3 end;        // its position; unused at infinity
  bool infinite;
};

#if NEXT_EVENT
layout(std430, binding = 4) readonly restrict buffer LightBlock { PathLight lights[]; };
uint pickedLight;  // by sampleLight; for callers that need it

// The light that these words select.
uint pick(uvec4 words) {
  uint i = scaledWord(words.x, uint(lights.length()));
  return unitFloat(words.y) >= lights[i].threshold ? lights[i].alias : i;
}

// xi: position on the light; words: select the light. False: the selected light does not reach the point.
bool sampleLight(vec3 position, vec2 xi, uvec4 words, out LightSample light) {
  pickedLight = pick(words);
  PathLight source = lights[pickedLight];
  light = LightSample(vec3(0.0), 0.0, vec3(0.0), source.a, false);
  bool reaches = false;
#if EMISSION
  if (source.kind == PATH_LIGHT_TRIANGLE) {
    vec2 w = triangleSample(xi);
    vec3 p = source.a + w.x * source.b + w.y * source.c;
    vec3 away = p - position;
    float distance2 = dot(away, away);
    light.direction = away * inversesqrt(distance2);
    float cosine = dot(light.direction, normalOf(source.p));
    reaches = abs(cosine) > 0.0 && distance2 > 0.0;
    if (reaches) {
      light.pdf = pickDensity(source.p) * distance2 / abs(cosine);
      light.value = emissionAt(source.q, source.p, w) / light.pdf;
      light.end = p;
    }
  }
#endif
#if ENVIRONMENT_PICTURE
  if (source.kind == PATH_LIGHT_ENVIRONMENT) {
    vec3 radiance;
    light.direction = environmentSample(xi, words.zw, radiance, light.pdf);
    light.infinite = true;
    light.pdf *= source.probability;
    light.value = radiance / light.pdf;
    reaches = light.pdf > 0.0;
  }
#endif
#if SUN
  if (source.kind == PATH_LIGHT_SUN) {
    light.direction = -source.b;
    light.infinite = true;
    light.value = source.c / source.probability;
    reaches = true;
  }
#endif
#if SPOTS || POINTS
  if (source.kind == PATH_LIGHT_POINT || source.kind == PATH_LIGHT_SPOT) {
    vec3 away = source.a - position;
    float distance2 = dot(away, away);
    reaches = distance2 > 0.0;
    if (reaches) {
      light.direction = away * inversesqrt(distance2);
      light.value = source.c / (source.probability * distance2);
#if SPOTS
      if (source.kind == PATH_LIGHT_SPOT)
        light.value *=
            spotFalloff(-dot(light.direction, source.b), uintBitsToFloat(source.p), uintBitsToFloat(source.q));
#endif
      reaches = any(greaterThan(light.value, vec3(0.0)));
    }
  }
#endif
  return reaches;
}
#endif
