// Probes of lab 4. Points are laid out as in demo/labs/propagation/propagation.cpp.
const vec3 kAxes[6] =
    vec3[6](vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0), vec3(0, 0, 1), vec3(0, 0, -1));
vec4 along(vec4 c, int k) { return propagated(c, kAxes[k], kAxes[(k + 2) % 6], kAxes[(k + 4) % 6]); }
const ivec3 kGrid = ivec3(12, 8, 8);

vec4 probe() {
#if PROBE == 1
  return vec4(injectionCell(point(0).xyz, point(1).xyz, point(2).xyz, point(2).w), 0.0);
#elif PROBE == 2
  return injectedLight(point(0).xyz, point(0).w);
#elif PROBE == 3
  return vec4(fluxInto(point(0), point(1).xyz, point(1).w));
#elif PROBE == 4
  return propagated(point(0), point(1).xyz, point(2).xyz, point(3).xyz);
#elif PROBE == 5
  // All six neighbours together: energy and direction.
  vec4 sum = vec4(0.0);
  for (int k = 0; k < 6; ++k) sum += along(point(0), k);
  return sum;
#elif PROBE == 6
  return vec4(irradianceAt(point(0), point(1).xyz, point(1).w));
#elif PROBE == 7
  // One step on a grid of 12 by 8 by 8 cells, stored in the inputs: each cell gathers from its six neighbours.
  ivec3 cell = ivec3(int(labIndex) % kGrid.x, int(labIndex) / kGrid.x % kGrid.y, int(labIndex) / (kGrid.x * kGrid.y));
  vec4 sum = vec4(0.0);
  for (int k = 0; k < 6; ++k) {
    ivec3 from = cell - ivec3(kAxes[k]);
    if (all(greaterThanEqual(from, ivec3(0))) && all(lessThan(from, kGrid)))
      sum += along(labInputs[from.x + kGrid.x * (from.y + kGrid.y * from.z)], k);
  }
  return sum;
#elif PROBE == 8
  // Total flux of an intensity, by directions uniform over the sphere.
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    float z = 2.0 * random() - 1.0, angle = 2.0 * PI * random();
    sum += fluxInto(point(0), vec3(sqrt(1.0 - z * z) * vec2(cos(angle), sin(angle)), z), 4.0 * PI);
  }
  return vec4(sum / 64.0);
#endif
}
