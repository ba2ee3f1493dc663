// Lab 2: shadow maps and reflective shadow maps. README.md tells what is asked; PI, frame() and random() are there.
// Take NOT_DONE(n) out when a task is done.

// TASK 1. How far the depth of a surface changes over half a texel of the shadow map; nothing where the surface turns
// its back on the light.
float slopeBias(vec3 n, vec3 toLight, float texel) {
  NOT_DONE(1)
  return 0.0;
}

// TASK 2. Share of light that passes: the four texels about the point are (0,0), (1,0), (0,1), (1,1), f lies between
// them in [0,1).
float filteredShadow(vec4 stored, float depth, float bias, vec2 f) {
  NOT_DONE(2)
  return 0.0;
}

// TASK 3. Flux that a texel's surface reflects. `irradiance` is at right angles to a far sun, `texelArea` the texel's
// area at right angles too, `cosine` the surface's to the sun.
float texelFlux(float albedo, float irradiance, float texelArea, float cosine) {
  NOT_DONE(3)
  return 0.0;
}

// TASK 4. Irradiance at x, normal n, from the surface of a texel at p, normal np, that reflects `flux` as Lambert's
// do.
float texelLight(vec3 x, vec3 n, vec3 p, vec3 np, float flux) {
  NOT_DONE(4)
  return 0.0;
}

// TASK 5. A sample of the disc about a pixel's place in the map, denser towards the middle: offset radius * u.x in
// direction 2 pi u.y, and its weight.
vec3 discSample(vec2 u, float radius) {
  NOT_DONE(5)
  return vec3(0.0);
}
