// Probes of lab 8. Points are laid out as in demo/labs/media/media.cpp.

// One photon in a slab of thickness `depth` (in optical units if the coefficients are), entering at the top with that
// cosine: (1, 0, length) came back, (0, 1, length) went through, (0, 0, length) was absorbed.
vec3 slabWalk(float cosine, float depth, float scattering, float absorption, float g) {
  float z = 0.0, way = 0.0;
  vec3 w = vec3(sqrt(max(0.0, 1.0 - cosine * cosine)), 0.0, cosine);
  for (int k = 0; k < 4000; ++k) {
    float t = freeFlight(random(), scattering, absorption);
    float toBorder = w.z > 0.0 ? (depth - z) / w.z : w.z < 0.0 ? -z / w.z : 1e30;
    if (t >= toBorder) return vec3(w.z < 0.0 ? 1.0 : 0.0, w.z > 0.0 ? 1.0 : 0.0, way + toBorder);
    z += t * w.z;
    way += t;
    if (random() * (scattering + absorption) >= scattering) break;
    float c = sampleHenyeyGreenstein(random(), g), s = sqrt(max(0.0, 1.0 - c * c)), turn = 2.0 * PI * random();
    vec3 a, b;
    frame(w, a, b);
    w = normalize(c * w + s * (cos(turn) * a + sin(turn) * b));
  }
  return vec3(0.0, 0.0, way);
}

vec4 probe() {
#if PROBE == 1
  return vec4(henyeyGreenstein(point(0).x, point(0).y));
#elif PROBE == 2
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) sum += 4.0 * PI * henyeyGreenstein(2.0 * random() - 1.0, point(0).x);
  return vec4(sum / 64.0);
#elif PROBE == 3
  return vec4(sampleHenyeyGreenstein(random(), point(0).x));
#elif PROBE == 4
  float sum = 0.0;
  for (int k = 0; k < 64; ++k) sum += sampleHenyeyGreenstein(random(), point(0).x);
  return vec4(sum / 64.0);
#elif PROBE == 5
  return vec4(freeFlight(random(), point(0).x, point(0).y));
#elif PROBE == 6
  return vec4(freeFlight(point(0).z, point(0).x, point(0).y));
#elif PROBE == 7
  return vec4(deltaTracking(point(0).x, point(0).y, point(0).z, point(0).w));
#elif PROBE == 8
  return vec4(naturalCoefficient(point(0).x, point(0).y));
#elif PROBE == 9
  // Reflected and transmitted: point(0) = depth, scattering, absorption, g; point(1).x selects.
  float sum = 0.0;
  for (int k = 0; k < 16; ++k) {
    vec3 end = slabWalk(1.0, point(0).x, point(0).y, point(0).z, point(0).w);
    sum += point(1).x < 0.5 ? end.x : end.y;
  }
  return vec4(sum / 16.0);
#elif PROBE == 10
  // Mean path length through a slab without absorption that is lit evenly from all sides.
  float sum = 0.0;
  for (int k = 0; k < 16; ++k) sum += slabWalk(sqrt(random()), point(0).x, point(0).y, 0.0, point(0).w).z;
  return vec4(sum / 16.0);
#elif PROBE == 11
  // Transmittance of a wedge: longer to the right, denser to the bottom.
  vec2 p = (vec2(pixel()) + 0.5) / vec2(96.0, 64.0);
  float hits = 0.0;
  for (int k = 0; k < 64; ++k)
    hits += deltaTracking(point(0).x, 2.0 * p.y, point(0).x + 2.0 * p.y * 2.0 * p.x + 0.1, 2.0 * p.x) >= 2.0 * p.x
                ? 1.0
                : 0.0;
  float mean = hits / 64.0;
  // Laplace's rule for the variance: pixels that saw only one kind of event are not certain.
  float guess = (hits + 1.0) / 66.0;
  return vec4(vec3(mean), guess * (1.0 - guess) / 64.0);
#endif
}
