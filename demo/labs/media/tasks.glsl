// Lab 8: participating media. README.md describes the tasks; PI, frame() and random() are available.
// Remove NOT_DONE(n) when a task is done.

// TASK 1. The phase function of Henyey and Greenstein, a density over solid angle; cosine 1 is straight ahead.
float henyeyGreenstein(float cosine, float g) {
  NOT_DONE(1)
  return 0.0;
}

// TASK 2. A cosine sampled from it; u is uniform in [0,1).
float sampleHenyeyGreenstein(float u, float g) {
  NOT_DONE(2)
  return 0.0;
}

// TASK 3. Distance that light travels in a homogeneous medium before it collides.
float freeFlight(float u, float scattering, float absorption) {
  NOT_DONE(3)
  return 0.0;
}

// TASK 4. The same for the extinction base + slope * distance, by delta tracking; `length` if the medium ends without a
// collision.
float deltaTracking(float base, float slope, float majorant, float length) {
  NOT_DONE(4)
  return 0.0;
}

// TASK 5. A liquid's coefficient in 1/mm from the tables of [Narasimhan2006]: measured in 1e-2 / mm, with `millilitres`
// of it in 23 litres of water.
float naturalCoefficient(float table, float millilitres) {
  NOT_DONE(5)
  return 0.0;
}
