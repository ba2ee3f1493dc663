// Fresnel reflectance of a smooth boundary between dielectrics, unpolarised [BornWolf, 1.5.2]: (r_s^2 + r_p^2) / 2.
// cosI: cosine to the normal on the incident side, 0..1; eta: index on that side over that on the other.
// cosT: the cosine on the other side; 0 for total internal reflection.
float fresnelDielectric(float cosI, float eta, out float cosT) {
  // 1 - eta^2 sin^2 without its cancellation near eta = 1
  float cos2T = (1.0 - eta) * (1.0 + eta) + eta * eta * cosI * cosI;
  cosT = 0.0;
  if (cos2T <= 0.0) return 1.0;
  cosT = sqrt(cos2T);
  float s = (eta * cosI - cosT) / (eta * cosI + cosT), p = (cosI - eta * cosT) / (cosI + eta * cosT);
#if FRESNEL_AMPLITUDES
  // [VPT2024 eq 2.11]: the absolute mean of the amplitudes instead of the mean of their squares
  return 0.5 * abs(s + p);
#elif FRESNEL_SCHLICK
  // [Schlick1994] with the cosine on the incident side, even if that side is the denser one
  float r0 = (eta - 1.0) / (eta + 1.0), m = 1.0 - cosI;
  r0 *= r0;
  return r0 + (1.0 - r0) * (m * m) * (m * m) * m;
#else
  return 0.5 * (s * s + p * p);
#endif
}
