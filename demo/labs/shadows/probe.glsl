// Probes of lab 2. Points are laid out as in demo/labs/shadows/shadows.cpp.

// The wall z = 0, lit by a square of the floor that begins `gap` in front of it: point(0) = side, gap, albedo, cosine
// of the sun; its irradiance is 1.
float wallSample(vec3 x) {
  float side = point(0).x, cosine = point(0).w;
  vec2 u = random2();
  vec3 p = vec3(side * (u.x - 0.5), 0.0, point(0).y + side * u.y);
  return texelLight(x, vec3(0.0, 0.0, 1.0), p, vec3(0.0, 1.0, 0.0),
                    texelFlux(point(0).z, 1.0, side * side * cosine, cosine));
}

vec4 probe() {
#if PROBE == 1
  return vec4(slopeBias(point(0).xyz, point(1).xyz, point(0).w));
#elif PROBE == 2
  return vec4(filteredShadow(point(0), point(1).x, point(1).y, point(1).zw));
#elif PROBE == 3
  return vec4(texelFlux(point(0).x, point(0).y, point(0).z, point(0).w));
#elif PROBE == 4
  return vec4(texelLight(point(0).xyz, point(1).xyz, point(2).xyz, point(3).xyz, point(0).w));
#elif PROBE == 5
  return vec4(discSample(point(0).xy, point(0).z), 0.0);
#elif PROBE == 6
  // The integral of 1 + x^2 over the disc.
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    vec3 s = discSample(random2(), point(0).x);
    sum += s.z * (1.0 + s.x * s.x);
  }
  return vec4(sum / 64.0);
#elif PROBE == 9
  float sum = 0.0;
  for (int k = 0; k < int(point(0).y); ++k) {
    vec3 s = discSample(random2(), point(0).x);
    sum += s.z * (1.0 + s.x * s.x);
  }
  return vec4(sum / point(0).y);
#elif PROBE == 7
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) sum += wallSample(vec3(point(1).x, point(1).y, 0.0));
  return vec4(sum / 64.0);
#elif PROBE == 8
  vec3 x = vec3((float(pixel().x) + 0.5) / 32.0 - 1.5, 2.0 - (float(pixel().y) + 0.5) / 32.0, 0.0);
  float sum = 0.0, square = 0.0;
  for (int k = 0; k < 64; ++k) {
    float value = wallSample(x);
    sum += value;
    square += value * value;
  }
  float mean = sum / 64.0;
  return vec4(vec3(mean), max(0.0, square / 64.0 - mean * mean) / 63.0);
#endif
}
