// Probes of lab 5. Points are laid out as in demo/labs/cascades/cascades.cpp.

// Three cascades about the origin with different lights, so that seams show: cascade k has the irradiance 1 + 0.3 k +
// 0.1 sin(x + k).
float lightOf(int k, vec3 p) { return 1.0 + 0.3 * float(k) + 0.1 * sin(p.x + float(k)); }
float shown(vec3 p, float halfExtent, float band, float cell) {
  int k = cascadeOf(p, vec3(0.0), halfExtent, 3);
  if (k < 0) return 0.0;
  float fineCell = cell * exp2(float(k)), coarseCell = 2.0 * fineCell;
  float weight = k == 2 ? 1.0 : blendWeight(p, vec3(0.0), halfExtent * exp2(float(k)), band);
  return blended(lightOf(k, p) * fineCell * fineCell, fineCell, lightOf(min(k + 1, 2), p) * coarseCell * coarseCell,
                 coarseCell, weight);
}

vec4 probe() {
#if PROBE == 1
  return vec4(snapped(point(0).xyz, point(0).w), 0.0);
#elif PROBE == 2
  return vec4(float(cascadeOf(point(0).xyz, point(1).xyz, point(0).w, int(point(1).w))));
#elif PROBE == 3
  return vec4(blendWeight(point(0).xyz, point(1).xyz, point(0).w, point(1).w));
#elif PROBE == 4
  return vec4(blended(point(0).x, point(0).y, point(0).z, point(0).w, point(1).x));
#elif PROBE == 5
  return vec4(splitDistance(int(point(0).x), int(point(0).y), point(0).z, point(0).w, point(1).x));
#elif PROBE == 6
  // The jump across a border: evaluate both sides.
  vec3 p = point(0).xyz, inside = p * 0.9999, outside = p * 1.0001;
  return vec4(shown(inside, point(0).w, point(1).x, point(1).y), shown(outside, point(0).w, point(1).x, point(1).y),
              0.0, 0.0);
#elif PROBE == 7
  vec3 p = vec3((vec2(pixel()) + 0.5 - vec2(48.0, 32.0)) / 10.0, 0.3);
  return vec4(vec3(shown(p, point(0).x, point(0).y, point(0).z)), 0.0);
#elif PROBE == 8
  // Points within 64 cells about the origin.
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) {
    vec3 place = (vec3(random(), random(), random()) - 0.5) * 64.0 * point(0).x,
         moved = snapped(place, point(0).x) - place;
    sum += dot(moved, moved) / 3.0;
  }
  return vec4(sum / 64.0);
#elif PROBE == 9
  float sum = 0.0;
  for (int k = 0; k < 64; ++k)
    sum +=
        blendWeight((vec3(random(), random(), random()) * 2.0 - 1.0) * point(0).x, vec3(0.0), point(0).x, point(0).y);
  return vec4(sum / 64.0);
#endif
}
