// Lab 8: participating media. Sample solution.

// TASK 1. The phase function of Henyey and Greenstein, a density over solid angle; cosine 1 is straight ahead.
float henyeyGreenstein(float cosine, float g) {
  float d = 1.0 + g * g - 2.0 * g * cosine;
  return (1.0 - g * g) / (4.0 * PI * d * sqrt(d));
}

// TASK 2. A cosine sampled from it; u is uniform in [0,1).
float sampleHenyeyGreenstein(float u, float g) {
  if (abs(g) < 1e-3) return 2.0 * u - 1.0;
  float s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
  return clamp((1.0 + g * g - s * s) / (2.0 * g), -1.0, 1.0);
}

// TASK 3. Distance that light travels in a homogeneous medium before it collides.
float freeFlight(float u, float scattering, float absorption) {
  return -log(1.0 - u) / (scattering + absorption);
}

// TASK 4. The same for the extinction base + slope * distance, by delta tracking; `length` if the medium ends without a
// collision.
float deltaTracking(float base, float slope, float majorant, float length) {
  float t = 0.0;
  for (int k = 0; k < 10000; ++k) {
    t -= log(1.0 - random()) / majorant;
    if (t >= length) return length;
    if (random() * majorant < base + slope * t) return t;
  }
  return length;
}

// TASK 5. A liquid's coefficient in 1/mm from the tables of [Narasimhan2006]: measured in 1e-2 / mm, with `millilitres`
// of it in 23 litres of water.
float naturalCoefficient(float table, float millilitres) {
  return table * 0.01 * 23000.0 / millilitres;
}
