// Reflectance of a smooth boundary between dielectrics, unpolarised [BornWolf, 1.5.2]: (r_s^2 + r_p^2) / 2.
// cosI: of the angle to the normal on the side of the light, 0..1; eta: index on that side over the other's.
// cosT: the cosine on the other side; 0 in total reflection.
float fresnelDielectric(float cosI, float eta, out float cosT) {
  // 1 - eta^2 sin^2 without its cancellation near eta = 1
  float cos2T = (1.0 - eta) * (1.0 + eta) + eta * eta * cosI * cosI;
  cosT = 0.0;
  if (cos2T <= 0.0) return 1.0;
  cosT = sqrt(cos2T);
  float s = (eta * cosI - cosT) / (eta * cosI + cosT), p = (cosI - eta * cosT) / (cosI + eta * cosT);
#if FRESNEL_AMPLITUDES
  // [VPT2024 eq 2.11]: the mean of the amplitudes, by magnitude, in place of the mean of their squares
  return 0.5 * abs(s + p);
#elif FRESNEL_SCHLICK
  // [Schlick1994] by the cosine on the light's own side, where that is the denser one too.
  float r0 = (eta - 1.0) / (eta + 1.0), m = 1.0 - cosI;
  r0 *= r0;
  return r0 + (1.0 - r0) * (m * m) * (m * m) * m;
#else
  return 0.5 * (s * s + p * p);
#endif
}
