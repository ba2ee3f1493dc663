// BSDFs as pure functions. Directions are unit and point away from the surface; `normal` is on the side of `out`
// (towards the camera); densities are over solid angle, 1/sr.

const float kPi = 3.14159265358979324;

#include "lib/tangent.glsl"

// Directions about a normal with density cos / pi.
vec3 cosineSample(vec3 normal, vec2 xi) {
  float r = sqrt(xi.x), angle = 2.0 * kPi * xi.y;
  vec3 t, b;
  tangentFrame(normal, t, b);
  return normalize(r * cos(angle) * t + r * sin(angle) * b + sqrt(1.0 - xi.x) * normal);
}

// Points on a triangle, uniform by area: weights of its second and third corner.
vec2 triangleSample(vec2 xi) {
  float r = sqrt(xi.x);
  return vec2(r * (1.0 - xi.y), r * xi.y);
}

// The weight of one of two sampling strategies that could both have produced a sample: power heuristic, exponent 2
// [Veach1997].
// a: density of the strategy used, above 0; b: that of the other.
float powerHeuristic(float a, float b) {
  float r = b / a;
  return 1.0 / (1.0 + r * r);
}

#if GLOSSY
#include "lib/ggx.glsl"
#endif
