// Lab 3: spherical harmonics and the cosine lobe. Sample solution.

// TASK 1. The real spherical harmonics of bands 0 and 1 in the direction of a unit vector: (Y00, Y1x, Y1y, Y1z).
vec4 shBasis(vec3 w) {
  return vec4(0.5 / sqrt(PI), 0.5 * sqrt(3.0 / PI) * w);
}

// TASK 2. Coefficients of the clamped cosine max(0, dot(w, n)).
vec4 cosineLobe(vec3 n) {
  return vec4(0.5 * sqrt(PI), sqrt(PI / 3.0) * n);
}

// TASK 3. One sample's contribution to the estimate of an environment's coefficients: radiance from w, where w was
// drawn with density pdf.
vec4 projectSample(vec3 w, float radiance, float pdf) {
  return shBasis(w) * (radiance / pdf);
}

// TASK 4. Irradiance at a surface with normal n, from the coefficients of radiance.
float irradiance(vec4 radiance, vec3 n) {
  return dot(radiance, cosineLobe(n));
}

// TASK 5. The coefficients of a function after rotation by `angle` about the z axis, from x towards y.
vec4 rotateAboutZ(vec4 c, float angle) {
  float s = sin(angle), k = cos(angle);
  return vec4(c.x, k * c.y - s * c.z, s * c.y + k * c.z, c.w);
}
