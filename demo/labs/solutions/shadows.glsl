// Lab 2: shadow maps and reflective shadow maps. Sample solution.

// TASK 1. Change of a surface's depth over half a texel of the shadow map; 0 if the surface faces away from the light.
float slopeBias(vec3 n, vec3 toLight, float texel) {
  float cosine = dot(n, toLight);
  if (cosine <= 0.0) return 0.0;
  return 0.5 * texel * sqrt(max(0.0, 1.0 - cosine * cosine)) / cosine;
}

// TASK 2. Fraction of light that passes. The four texels around the point are (0,0), (1,0), (0,1), (1,1); f in [0,1) is
// the position between them.
float filteredShadow(vec4 stored, float depth, float bias, vec2 f) {
  vec4 lit = step(vec4(depth - bias), stored);
  return mix(mix(lit.x, lit.y, f.x), mix(lit.z, lit.w, f.x), f.y);
}

// TASK 3. Flux that a texel's surface reflects. `irradiance` and `texelArea` are measured perpendicular to the rays of
// a distant sun; `cosine` is between the surface's normal and the sun.
float texelFlux(float albedo, float irradiance, float texelArea, float cosine) {
  return albedo * irradiance * texelArea;
}

// TASK 4. Irradiance at x with normal n, from the surface of a texel at p with normal np, which reflects `flux` as a
// Lambertian surface.
float texelLight(vec3 x, vec3 n, vec3 p, vec3 np, float flux) {
  vec3 way = x - p;
  float square = dot(way, way);
  return flux / PI * max(0.0, dot(np, way)) * max(0.0, -dot(n, way)) / (square * square);
}

// TASK 5. A sample of the disc around a pixel's position in the map, denser towards the middle: offset radius * u.x in
// direction 2 pi u.y, and its weight.
vec3 discSample(vec2 u, float radius) {
  float angle = 2.0 * PI * u.y;
  return vec3(radius * u.x * cos(angle), radius * u.x * sin(angle), 2.0 * PI * radius * radius * u.x);
}
