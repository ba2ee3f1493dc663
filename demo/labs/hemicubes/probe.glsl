// Probes of lab 6. Points are laid out as in demo/labs/hemicubes/hemicubes.cpp.

// Three patches: point(0) emission, point(1) reflectance, point(2..4) rows of form factors.
vec3 swept(vec3 radiosity) {
  float F[9] = float[9](point(2).x, point(2).y, point(2).z, point(3).x, point(3).y, point(3).z, point(4).x, point(4).y,
                        point(4).z);
  return sweep(radiosity, point(0).xyz, point(1).xyz, F);
}

// One random point of the hemicube, whose total area is 12: its weight if the ray from x hits the square (side,
// height), 0 otherwise.
float hemicubeSample(vec3 x, float side, float height) {
  vec3 d;
  float weight, which = 12.0 * random();
  vec2 u = random2();
  if (which < 4.0) {
    vec2 p = 2.0 * u - 1.0;
    d = vec3(p, 1.0);
    weight = deltaTop(p, 12.0);
  } else {
    float y = 2.0 * u.x - 1.0;
    d = which < 6.0    ? vec3(1.0, y, u.y)
        : which < 8.0  ? vec3(-1.0, y, u.y)
        : which < 10.0 ? vec3(y, 1.0, u.y)
                       : vec3(y, -1.0, u.y);
    weight = deltaSide(y, u.y, 12.0);
  }
  if (height == 0.0) return weight;
  vec2 hit = x.xy + d.xy * (height / max(d.z, 1e-6));
  return all(lessThan(abs(hit), vec2(0.5 * side))) ? weight : 0.0;
}

vec4 probe() {
#if PROBE == 1
  return vec4(deltaTop(point(0).xy, point(0).z));
#elif PROBE == 2
  return vec4(deltaSide(point(0).x, point(0).y, point(0).z));
#elif PROBE == 3
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) sum += hemicubeSample(vec3(0.0), 0.0, 0.0);
  return vec4(sum / 64.0);
#elif PROBE == 4
  return vec4(pixelDirection(int(point(0).x), ivec2(point(0).yz), int(point(0).w)), 0.0);
#elif PROBE == 5
  // Form factor of a square above the patch, point(0) = side, height, away.
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) sum += hemicubeSample(vec3(point(0).z, 0.0, 0.0), point(0).x, point(0).y);
  return vec4(sum / 64.0);
#elif PROBE == 6
  return vec4(swept(point(5).xyz), 0.0);
#elif PROBE == 7
  vec3 radiosity = point(0).xyz;
  for (int k = 0; k < 200; ++k) radiosity = swept(radiosity);
  return vec4(radiosity, 0.0);
#elif PROBE == 8
  return vec4(errorBound(point(0).x, point(0).y));
#elif PROBE == 9
  // Sweep until the bound is small; then 1 if the reference, point(5), is within it.
  vec3 radiosity = point(0).xyz;
  float bound = 1e30, most = max(point(1).x, max(point(1).y, point(1).z));
  for (int k = 0; k < 1000 && !(bound < 1e-3); ++k) {
    vec3 next = swept(radiosity), off = abs(next - radiosity);
    bound = errorBound(max(off.x, max(off.y, off.z)), most);
    radiosity = next;
  }
  vec3 off = abs(radiosity - point(5).xyz);
  return vec4(bound < 1e-3 && max(off.x, max(off.y, off.z)) <= bound + 2e-6 * length(point(5)) ? 1.0 : 0.0);
#elif PROBE == 10
  vec3 x = vec3((vec2(pixel()) + 0.5) / 16.0 - vec2(3.0, 2.0), 0.0);
  float sum = 0.0, square = 0.0;
  for (int k = 0; k < 256; ++k) {
    float value = hemicubeSample(x, point(0).x, point(0).y);
    sum += value;
    square += value * value;
  }
  float mean = sum / 256.0;
  // Pixels that saw nothing are not certain: add the error of one hit.
  return vec4(vec3(mean), (max(0.0, square / 256.0 - mean * mean) + 0.01 / 256.0) / 255.0);
#elif PROBE == 11
  vec3 radiosity = point(0).xyz;
  for (int k = 0; k < int(point(6).x); ++k) radiosity = swept(radiosity);
  return vec4(radiosity, 0.0);
#endif
}
