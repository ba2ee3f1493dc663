// Lab 7: path tracing. README.md describes the tasks; PI, frame() and random() are available.
// Remove NOT_DONE(n) when a task is done.

// Given, from lab 1: converts a density over a lamp's area to a density over solid angle at x, p(omega) d omega = p(A)
// dA; 0 if x sees the lamp's back.
float densityOverSolidAngle(float pdfArea, vec3 x, vec3 y, vec3 ny) {
  vec3 way = x - y;
  float square = dot(way, way), cosine = dot(ny, way * inversesqrt(square));
  return cosine > 0.0 ? pdfArea * square / cosine : 0.0;
}

// TASK 1. The balance heuristic: the weight of a sample at which its own strategy has density `own` and the other
// strategy `other`.
float misWeight(float own, float other) {
  NOT_DONE(1)
  return 0.0;
}

// TASK 2. Next-event estimation: the contribution of a lamp's point y to the radiance reflected at x, where y was drawn
// with density pdfArea over the lamp.
float lampSample(float radiance, float albedo, vec3 x, vec3 n, vec3 y, vec3 ny, float pdfArea) {
  NOT_DONE(2)
  return 0.0;
}

// TASK 3. Russian roulette: whether the path continues, with probability `survival`; u is uniform in [0,1).
bool roulette(inout float throughput, float survival, float u) {
  NOT_DONE(3)
  return false;
}

// TASK 4. One path in a closed box of walls that emit `emission` and reflect `albedo`: its radiance, and the number of
// reflections.
float furnacePath(float emission, float albedo, float survival, out int bounces) {
  NOT_DONE(4)
  bounces = 0;
  return 0.0;
}

// TASK 5. Standard error of the mean of n samples with this sum and sum of squares.
float standardError(float sum, float squares, float n) {
  NOT_DONE(5)
  return 0.0;
}
