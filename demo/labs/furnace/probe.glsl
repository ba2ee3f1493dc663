// Probes of lab 1. Points are laid out as in demo/labs/furnace/furnace.cpp.

// A square lamp of radiance 1, facing down: point(0) = side, height.
const int kLampSamples = 64;
float lampSample(vec3 x) {
  vec2 u = random2() - 0.5;
  vec3 y = vec3(point(0).x * u.x, point(0).y, point(0).x * u.y);
  float perArea = solidAngleOfArea(x, y, vec3(0.0, -1.0, 0.0)) * point(0).x * point(0).x;
  return reflected(vec3(point(0).z), vec3(0.0, 1.0, 0.0), normalize(y - x), vec3(1.0)).x * perArea;
}

vec3 uniformDirection() {
  float z = 2.0 * random() - 1.0, angle = 2.0 * PI * random();
  return vec3(sqrt(1.0 - z * z) * vec2(cos(angle), sin(angle)), z);
}

vec4 probe() {
#if PROBE == 1
  return vec4(reflected(point(0).xyz, point(1).xyz, point(2).xyz, point(3).xyz), 0.0);
#elif PROBE == 2
  // Furnace: radiance 1 from all directions, sampled uniformly over the sphere.
  float sum = 0.0;
  for (int k = 0; k < 64; ++k)
    sum += 4.0 * PI * reflected(vec3(point(0).w), point(0).xyz, uniformDirection(), vec3(1.0)).x;
  return vec4(sum / 64.0);
#elif PROBE == 3
  vec3 n = point(0).xyz, w = sampleCosine(random2(), n), t, b;
  frame(n, t, b);
  return vec4(dot(n, w), dot(t, w), dot(b, w), length(w));
#elif PROBE == 4
  return vec4(pdfCosine(point(0).xyz, point(1).xyz));
#elif PROBE == 5
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) sum += 4.0 * PI * pdfCosine(point(0).xyz, uniformDirection());
  return vec4(sum / 64.0);
#elif PROBE == 6
  // Furnace again, with the student's own directions: no noise remains.
  vec3 n = point(0).xyz, w = sampleCosine(random2(), n);
  return vec4(reflected(vec3(point(0).w), n, w, vec3(1.0)).x / pdfCosine(n, w));
#elif PROBE == 7
  return vec4(solidAngleOfArea(point(0).xyz, point(1).xyz, point(2).xyz));
#elif PROBE == 8
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) sum += lampSample(vec3(point(1).x, 0.0, point(1).z));
  return vec4(sum / 64.0);
#elif PROBE == 9
  return vec4(furnace(point(0).x, point(0).y, int(point(0).z)));
#elif PROBE == 10
  // The floor from above: 6 by 4 units around the point below the lamp.
  vec3 x = vec3((vec2(pixel()) + 0.5) / 16.0 - vec2(3.0, 2.0), 0.0).xzy;
  float sum = 0.0, square = 0.0;
  for (int k = 0; k < kLampSamples; ++k) {
    float value = lampSample(x);
    sum += value;
    square += value * value;
  }
  float mean = sum / float(kLampSamples);
  return vec4(vec3(mean), max(0.0, square / float(kLampSamples) - mean * mean) / float(kLampSamples - 1));
#elif PROBE == 11
  // Furnace with point(1).x samples per invocation, uniform directions.
  float sum = 0.0;
  for (int k = 0; k < int(point(1).x); ++k)
    sum += 4.0 * PI * reflected(vec3(point(0).w), point(0).xyz, uniformDirection(), vec3(1.0)).x;
  return vec4(sum / point(1).x);
#endif
}
