// Probes of lab 3. Points are laid out as in demo/labs/harmonics/harmonics.cpp.
vec3 uniformDirection() {
  float z = 2.0 * random() - 1.0, angle = 2.0 * PI * random();
  return vec3(sqrt(1.0 - z * z) * vec2(cos(angle), sin(angle)), z);
}
// An environment within bands 0 and 1: base + slope cos; point(0) = axis, slope; point(1).x = base.
float environment(vec3 w) { return point(1).x + point(0).w * dot(w, point(0).xyz); }
vec4 projected(int samples) {
  vec4 sum = vec4(0.0);
  for (int k = 0; k < samples; ++k) {
    vec3 w = uniformDirection();
    sum += projectSample(w, environment(w), 0.25 / PI);
  }
  return sum / float(samples);
}

vec4 probe() {
#if PROBE == 1
  return shBasis(point(0).xyz);
#elif PROBE == 2
  // Orthonormal: the integral of (basis . a)(basis . b) is a . b.
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    vec4 y = shBasis(uniformDirection());
    sum += 4.0 * PI * dot(y, point(0)) * dot(y, point(1));
  }
  return vec4(sum / 64.0);
#elif PROBE == 3
  return cosineLobe(point(0).xyz);
#elif PROBE == 4
  // The lobe's coefficient along point(1) by integration, minus the student's.
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    vec3 w = uniformDirection();
    sum +=
        4.0 * PI * max(0.0, dot(w, point(0).xyz)) * dot(shBasis(w), point(1)) - dot(cosineLobe(point(0).xyz), point(1));
  }
  return vec4(sum / 64.0);
#elif PROBE == 5
  return projectSample(point(0).xyz, point(1).x, point(1).y);
#elif PROBE == 6
  // Coefficients along point(2).
  return vec4(dot(projected(64), point(2)));
#elif PROBE == 7
  return vec4(irradiance(point(0), point(1).xyz));
#elif PROBE == 8
  return vec4(irradiance(projected(64), point(2).xyz));
#elif PROBE == 9
  return rotateAboutZ(point(0), point(1).x);
#elif PROBE == 10
  // A white ball in that environment, seen from +z in orthographic projection.
  vec2 p = (vec2(pixel()) + 0.5 - vec2(48.0, 32.0)) / 30.0 * vec2(1.0, -1.0);
  if (dot(p, p) >= 1.0) return vec4(0.0);
  vec3 n = vec3(p, sqrt(1.0 - dot(p, p)));
  float sum = 0.0, square = 0.0;
  for (int k = 0; k < 64; ++k) {
    float value = irradiance(projected(1), n) / PI;
    sum += value;
    square += value * value;
  }
  float mean = sum / 64.0;
  return vec4(vec3(mean), max(0.0, square / 64.0 - mean * mean) / 63.0);
#elif PROBE == 11
  return vec4(dot(projected(int(point(3).x)), point(2)));
#endif
}
