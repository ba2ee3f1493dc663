// Lab 1: the rendering equation and the furnace. Sample solution.

// TASK 1. What a surface of Lambert's reflects of the radiance that arrives from direction wi: the integrand of the
// rendering equation.
vec3 reflected(vec3 albedo, vec3 n, vec3 wi, vec3 incoming) {
  return albedo / PI * incoming * max(0.0, dot(n, wi));
}

// TASK 2. A direction on the hemisphere about n, distributed as the cosine to n.
vec3 sampleCosine(vec2 u, vec3 n) {
  vec3 t, b;
  frame(n, t, b);
  float radius = sqrt(u.x), angle = 2.0 * PI * u.y;
  return normalize(radius * (cos(angle) * t + sin(angle) * b) + sqrt(max(0.0, 1.0 - u.x)) * n);
}

// TASK 3. The density of sampleCosine over solid angle.
float pdfCosine(vec3 n, vec3 w) {
  return max(0.0, dot(n, w)) / PI;
}

// TASK 4. Solid angle at x of a unit of area at y, whose lit side looks along ny.
float solidAngleOfArea(vec3 x, vec3 y, vec3 ny) {
  vec3 way = x - y;
  float square = dot(way, way);
  return max(0.0, dot(ny, way * inversesqrt(square))) / square;
}

// TASK 5. Radiance in a closed box whose walls all emit `emission` and reflect `albedo`, light that was reflected
// `bounces` times at most.
float furnace(float emission, float albedo, int bounces) {
  float sum = 0.0, part = emission;
  for (int k = 0; k <= bounces; ++k) {
    sum += part;
    part *= albedo;
  }
  return sum;
}
