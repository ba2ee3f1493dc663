// Probes of lab 7. Points are laid out as in demo/labs/paths/paths.cpp.
const vec3 kDown = vec3(0.0, -1.0, 0.0), kUp = vec3(0.0, 1.0, 0.0);

// Light from a square lamp of radiance 1 (point(0) = side, height, albedo) at a point of the floor: one sample of the
// lamp, one cosine-weighted.
float bothStrategies(vec3 x) {
  float side = point(0).x, height = point(0).y, albedo = point(0).z, pdfArea = 1.0 / (side * side);
  vec2 u = random2() - 0.5;
  vec3 y = vec3(side * u.x, height, side * u.y);
  float value = lampSample(1.0, albedo, x, kUp, y, kDown, pdfArea) *
                misWeight(densityOverSolidAngle(pdfArea, x, y, kDown), normalize(y - x).y / PI);
  float radius = sqrt(random()), angle = 2.0 * PI * random();
  vec3 w = vec3(radius * cos(angle), sqrt(max(1e-12, 1.0 - radius * radius)), radius * sin(angle));
  vec3 hit = x + w * (height / w.y);
  if (all(lessThan(abs(hit.xz), vec2(0.5 * side))))
    value += albedo * misWeight(w.y / PI, densityOverSolidAngle(pdfArea, x, hit, kDown));
  return value;
}

vec4 probe() {
#if PROBE == 1
  return vec4(misWeight(point(0).x, point(0).y));
#elif PROBE == 2
  float a = random() + 1e-3, b = 5.0 * random() + 1e-3;
  return vec4(misWeight(a, b) + misWeight(b, a));
#elif PROBE == 3
  return vec4(
      lampSample(point(3).x, point(3).y, point(0).xyz, vec3(0.0, 0.0, 1.0), point(1).xyz, point(2).xyz, point(3).z));
#elif PROBE == 4
  float side = point(0).x, sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    vec2 u = random2() - 0.5;
    sum += lampSample(1.0, point(0).z, vec3(point(1).x, 0.0, 0.0), kUp, vec3(side * u.x, point(0).y, side * u.y), kDown,
                      1.0 / (side * side));
  }
  return vec4(sum / 64.0);
#elif PROBE == 6
  float throughput = point(0).x;
  bool alive = roulette(throughput, point(0).y, point(0).z);
  return alive ? vec4(1.0, throughput, 0.0, 0.0) : vec4(0.0);
#elif PROBE == 7
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    float throughput = point(0).x;
    if (roulette(throughput, point(0).y, random())) sum += throughput;
  }
  return vec4(sum / 64.0);
#elif PROBE == 8
  int bounces;
  float radiance = furnacePath(point(0).x, point(0).y, point(0).z, bounces);
  return vec4(radiance, float(bounces), 0.0, 0.0);
#elif PROBE == 9
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    int bounces;
    sum += furnacePath(point(0).x, point(0).y, point(0).z, bounces);
  }
  return vec4(sum / 64.0);
#elif PROBE == 10
  // The correct result for a path's number of bounces is known: the ratio is 1.
  int bounces;
  float radiance = furnacePath(point(0).x, point(0).y, point(0).z, bounces), ratio = point(0).y / point(0).z, sum = 0.0;
  for (int k = clamp(bounces, 0, 10000); k >= 0; --k) sum = sum * ratio + 1.0;
  return vec4(radiance / (point(0).x * sum));
#elif PROBE == 11
  return vec4(standardError(point(0).x, point(0).y, point(0).z));
#elif PROBE == 12
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) sum += bothStrategies(vec3(point(1).x, 0.0, 0.0));
  return vec4(sum / 64.0);
#elif PROBE == 13
  // The floor from above: 3 by 2 units around the point below the lamp.
  vec3 x = vec3((vec2(pixel()) + 0.5) / 32.0 - vec2(1.5, 1.0), 0.0).xzy;
  float sum = 0.0, square = 0.0;
  for (int k = 0; k < 64; ++k) {
    float value = bothStrategies(x);
    sum += value;
    square += value * value;
  }
  float error = standardError(sum, square, 64.0);
  return vec4(vec3(sum / 64.0), error * error);
#elif PROBE == 14
  float sum = 0.0;
  for (int k = 0; k < int(point(2).x); ++k) sum += bothStrategies(vec3(point(1).x, 0.0, 0.0));
  return vec4(sum / point(2).x);
#endif
}
