// Lab 2: shadow maps and reflective shadow maps. README.md describes the tasks; PI, frame() and random() are available.
// Remove NOT_DONE(n) when a task is done.

// TASK 1. Change of a surface's depth over half a texel of the shadow map; 0 if the surface faces away from the light.
float slopeBias(vec3 n, vec3 toLight, float texel) {
  NOT_DONE(1)
  return 0.0;
}

// TASK 2. Fraction of light that passes. The four texels around the point are (0,0), (1,0), (0,1), (1,1); f in [0,1) is
// the position between them.
float filteredShadow(vec4 stored, float depth, float bias, vec2 f) {
  NOT_DONE(2)
  return 0.0;
}

// TASK 3. Flux that a texel's surface reflects. `irradiance` and `texelArea` are measured perpendicular to the rays of
// a distant sun; `cosine` is between the surface's normal and the sun.
float texelFlux(float albedo, float irradiance, float texelArea, float cosine) {
  NOT_DONE(3)
  return 0.0;
}

// TASK 4. Irradiance at x with normal n, from the surface of a texel at p with normal np, which reflects `flux` as a
// Lambertian surface.
float texelLight(vec3 x, vec3 n, vec3 p, vec3 np, float flux) {
  NOT_DONE(4)
  return 0.0;
}

// TASK 5. A sample of the disc around a pixel's position in the map, denser towards the middle: offset radius * u.x in
// direction 2 pi u.y, and its weight.
vec3 discSample(vec2 u, float radius) {
  NOT_DONE(5)
  return vec3(0.0);
}
