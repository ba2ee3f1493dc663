// Lab 1: the rendering equation and the furnace. Sample solution.

// TASK 1. Radiance that a Lambertian surface reflects of the radiance arriving from direction wi: the integrand of the
// rendering equation.
vec3 reflected(vec3 albedo, vec3 n, vec3 wi, vec3 incoming) {
  return albedo / PI * incoming * max(0.0, dot(n, wi));
}

// TASK 2. A cosine-distributed direction on the hemisphere about n.
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

// TASK 4. Solid angle at x per unit area at y, whose lit side faces along ny.
float solidAngleOfArea(vec3 x, vec3 y, vec3 ny) {
  vec3 way = x - y;
  float square = dot(way, way);
  return max(0.0, dot(ny, way * inversesqrt(square))) / square;
}

// TASK 5. Radiance in a closed box whose walls all emit `emission` and reflect `albedo`, for light reflected at most
// `bounces` times.
float furnace(float emission, float albedo, int bounces) {
  float sum = 0.0, part = emission;
  for (int k = 0; k <= bounces; ++k) {
    sum += part;
    part *= albedo;
  }
  return sum;
}
