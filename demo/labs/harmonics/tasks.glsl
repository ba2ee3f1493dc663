// Lab 3: spherical harmonics and the cosine lobe. README.md describes the tasks; PI, frame() and random() are
// available.
// Remove NOT_DONE(n) when a task is done.

// TASK 1. The real spherical harmonics of bands 0 and 1 in the direction of a unit vector: (Y00, Y1x, Y1y, Y1z).
vec4 shBasis(vec3 w) {
  NOT_DONE(1)
  return vec4(0.0);
}

// TASK 2. Coefficients of the clamped cosine max(0, dot(w, n)).
vec4 cosineLobe(vec3 n) {
  NOT_DONE(2)
  return vec4(0.0);
}

// TASK 3. One sample's contribution to the estimate of an environment's coefficients: radiance from w, where w was
// drawn with density pdf.
vec4 projectSample(vec3 w, float radiance, float pdf) {
  NOT_DONE(3)
  return vec4(0.0);
}

// TASK 4. Irradiance at a surface with normal n, from the coefficients of radiance.
float irradiance(vec4 radiance, vec3 n) {
  NOT_DONE(4)
  return 0.0;
}

// TASK 5. The coefficients of a function after rotation by `angle` about the z axis, from x towards y.
vec4 rotateAboutZ(vec4 c, float angle) {
  NOT_DONE(5)
  return vec4(0.0);
}
