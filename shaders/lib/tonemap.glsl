// Radiance to display: a filmic curve and sRGB encoding.
// Curve: the rational fit of the ACES reference rendering [Narkowicz2015], applied per channel to linear values.
vec3 filmic(vec3 x) {
  x *= 0.6;  // the fit as published is 1/0.6 times brighter than the reference
  return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

vec3 srgbFromLinear(vec3 x) {  // IEC 61966-2-1
  return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, greaterThan(x, vec3(0.0031308)));
}
