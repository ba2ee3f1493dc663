// Lab 1: the rendering equation and the furnace. README.md describes the tasks; PI, frame() and random() are available
// (its theory section lists them).
// Remove NOT_DONE(n) when a task is done.

// TASK 1. Radiance that a Lambertian surface reflects of the radiance arriving from direction wi: the integrand of the
// rendering equation.
vec3 reflected(vec3 albedo, vec3 n, vec3 wi, vec3 incoming) {
  NOT_DONE(1)
  return vec3(0.0);
}

// TASK 2. A cosine-distributed direction on the hemisphere about n. u: two independent numbers in [0,1).
vec3 sampleCosine(vec2 u, vec3 n) {
  NOT_DONE(2)
  return n;
}

// TASK 3. The density of sampleCosine over solid angle, for any unit vector w.
float pdfCosine(vec3 n, vec3 w) {
  NOT_DONE(3)
  return 0.0;
}

// TASK 4. Solid angle at x per unit area at y, whose lit side faces along ny; 0 if x sees its back.
float solidAngleOfArea(vec3 x, vec3 y, vec3 ny) {
  NOT_DONE(4)
  return 0.0;
}

// TASK 5. Radiance in a closed box whose walls all emit `emission` and reflect `albedo`, for light reflected at most
// `bounces` times.
float furnace(float emission, float albedo, int bounces) {
  NOT_DONE(5)
  return 0.0;
}
