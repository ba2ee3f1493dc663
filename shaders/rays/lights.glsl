// Samples one light, chosen by its share of the scene's power, and a point on it: storage block 4. Flags: NEXT_EVENT,
// SUN, SPOTS, POINTS, EMISSION, ENVIRONMENT_PICTURE. A constant environment is left to scattered rays, which sample it
// optimally. SUN_APART: the sun is the first light, and is not drawn with the others. LIGHT_HIERARCHY: lamps are drawn
// by what they may bring to a point.
#include "lib/spot.glsl"
#include "lib/tangent.glsl"
#include "lib/round_light.glsl"
#if NEXT_EVENT
struct LightPick {
  uint light;
  float probability;
  float balance;  // the probability that weighs a sample against scattered rays, over this one
};
#if LIGHT_HIERARCHY
#include "rays/light_hierarchy.glsl"
#endif
#endif
#if EMISSION && NEXT_EVENT
#include "lib/spherical_triangle.glsl"

// Solid angle of a triangle from which directions to it are drawn; a: its first corner, relative to the point. 0: its
// points are drawn by area. That serves as well where it is small, and where it is thin or the point is about in its
// plane, single precision does not hold the angle.
float nearAngle(vec3 a, vec3 ab, vec3 ac) {
  vec3 b = a + ab, c = a + ac, n = cross(ab, ac);
  float area = 0.5 * length(n), nearest2 = min(min(dot(a, a), dot(b, b)), dot(c, c)), volume = dot(a, n);
  if (area < 0.05 * nearest2 || volume * volume < 1e-5 * area * area * area) return 0.0;
  float angle = sphericalTriangle(normalize(a), normalize(b), normalize(c));
  return angle > 1e-3 ? angle : 0.0;
}

// Density, 1/sr, with which next-event estimation draws a direction to a triangle; perArea: the probability of the
// triangle over its area; angle: by nearAngle.
float lampDensity(float perArea, float area, float angle, float distance2, float cosine) {
  return perArea * (angle > 0.0 ? area / angle : distance2 / cosine);
}

// The same, of a direction in which a ray from `position` has hit it at the distance t, for weighing the two.
float lampDensityOfHit(uint triangle, vec3 position, float t, float cosine) {
  uint first = triangle * TRIANGLE_WORDS;
  vec3 a = uintBitsToFloat(triangleData[first].xyz), ab = uintBitsToFloat(triangleData[first + 1u].xyz) - a,
       ac = uintBitsToFloat(triangleData[first + 2u].xyz) - a;
  float area = 0.5 * length(cross(ab, ac));
#if LIGHT_HIERARCHY
  float perArea = lampProbability(lampLeaf(triangle), position) / area;
#else
  float perArea = pickDensity(triangle);
#endif
  return lampDensity(perArea, area, nearAngle(a - position, ab, ac), t * t, cosine);
}
#endif

struct LightSample {
  vec3 direction;  // unit, towards it
  float pdf;       // density with which this direction is sampled, 1/sr; 0: sun and lamps, which rays do not find
  // radiance over pdf; of sun and lamps so that its mean over samples, times the cosine, is the irradiance
  vec3 value;
  vec3 end;        // its position; unused at infinity
  bool infinite;
};

#if NEXT_EVENT
layout(std430, binding = 4) readonly restrict buffer LightBlock { PathLight lights[]; };
uint pickedLight;  // by sampleLight; for callers that need it

// The light that these words select.
uint pick(uvec4 words) {
  uint i = uint(SUN_APART) + scaledWord(words.x, uint(lights.length() - SUN_APART));
  return unitFloat(words.y) >= lights[i].threshold ? lights[i].alias : i;
}

// A light for a surface at that position, with that normal; a normal of zero takes light from all sides.
LightPick pickAt(uvec4 words, vec3 position, vec3 normal) {
#if LIGHT_HIERARCHY
#if ENVIRONMENT_PICTURE || (SUN && !SUN_APART)
  uint i = pick(words);
  if (lights[i].kind == PATH_LIGHT_SUN || lights[i].kind == PATH_LIGHT_ENVIRONMENT)
    return LightPick(i, lights[i].probability, 1.0);
  words.x = words.z;
#endif
  return drawLamp(words, position, normal);
#else
  uint i = pick(words);
  return LightPick(i, lights[i].probability, 1.0);
#endif
}

#if SUN
// xi: position on its disc. True: the sun reaches every point.
bool sampleSun(PathLight sun, vec2 xi, out LightSample light) {
  light = LightSample(-sun.b, 0.0, sun.c / sun.probability, vec3(0.0), true);
  if (sun.size > 0.0) {  // E = L pi sin^2 of the half angle, of which samples take L 2 pi (1 - cos)
    light.direction = coneSample(light.direction, sun.size, xi);
    light.value *= 2.0 / (2.0 - sun.size);
  }
  return true;
}
#endif

// xi: position on the light; words: on the environment. False: that light does not reach the point. With SUN_APART not
// of the sun.
bool sampleOf(PathLight source, vec3 position, vec2 xi, uvec4 words, out LightSample light) {
  light = LightSample(vec3(0.0), 0.0, vec3(0.0), source.a, false);
  bool reaches = false;
#if EMISSION
  if (source.kind == PATH_LIGHT_TRIANGLE) {
    vec3 a = source.a - position, n = cross(source.b, source.c);
    vec2 w = triangleSample(xi);
    float angle = nearAngle(a, source.b, source.c);
    if (angle > 0.0) {
      vec3 d = sphericalTriangleSample(normalize(a), normalize(a + source.b), normalize(a + source.c), angle, xi);
      vec3 across = cross(a, d);  // by Cramer's rule
      w = clamp(vec2(dot(across, source.c), -dot(across, source.b)) / dot(d, n), 0.0, 1.0);
      w.y = min(w.y, 1.0 - w.x);
    }
    vec3 away = a + w.x * source.b + w.y * source.c;
    float distance2 = dot(away, away);
    light.direction = away * inversesqrt(distance2);
    float cosine = dot(light.direction, normalOf(source.p));
    reaches = abs(cosine) > 0.0 && distance2 > 0.0;
    if (reaches) {
      float area = 0.5 * length(n);
#if LIGHT_HIERARCHY
      float perArea = source.probability / area;
#else
      float perArea = pickDensity(source.p);
#endif
      light.pdf = lampDensity(perArea, area, angle, distance2, abs(cosine));
      light.value = emissionAt(source.q, source.p, w) / light.pdf;
      light.end = position + away;
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
#if SUN && !SUN_APART
  if (source.kind == PATH_LIGHT_SUN) reaches = sampleSun(source, xi, light);
#endif
#if SPOTS || POINTS
  if (source.kind == PATH_LIGHT_POINT || source.kind == PATH_LIGHT_SPOT) {
    vec3 away = source.a - position;
    float distance2 = dot(away, away);
    reaches = distance2 > 0.0;
    if (reaches) {
      light.direction = away * inversesqrt(distance2);
      light.value = source.c / (source.probability * distance2);
      if (source.size > 0.0) {  // L = I / (pi r^2), of which samples take L 2 pi (1 - cos)
        float lessCosine = ballLessCosine(source.size, distance2);
        light.value *= 2.0 * lessCosine * distance2 / (source.size * source.size);
        light.direction = coneSample(light.direction, lessCosine, xi);
        light.end = position + light.direction * distanceToBall(away, source.size, light.direction);
      }
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

// Of the light that pickAt has chosen.
bool samplePicked(LightPick picked, vec3 position, vec2 xi, uvec4 words, out LightSample light) {
  PathLight source = lights[picked.light];
  source.probability = picked.probability;
  bool reaches = sampleOf(source, position, xi, words, light);
  if (light.pdf > 0.0) light.pdf = max(light.pdf * picked.balance, 1e-30);
  return reaches;
}

// words: select the light.
bool sampleLight(vec3 position, vec3 normal, vec2 xi, uvec4 words, out LightSample light) {
  LightPick picked = pickAt(words, position, normal);
  pickedLight = picked.light;
  return samplePicked(picked, position, xi, words, light);
}
#endif
