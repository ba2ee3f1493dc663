// Phase functions: scattering of light that travels along `w` into the direction `to`, both unit, as a density over
// solid angle in 1/sr. cos = dot(w, to): 1 is straight ahead.

const float kOver4Pi = 0.079577471545947668;

// An orthonormal frame about a unit vector [Duff2017].
void phaseFrame(vec3 w, out vec3 t, out vec3 b) {
  float s = w.z >= 0.0 ? 1.0 : -1.0;
  float p = -1.0 / (s + w.z), q = w.x * w.y * p;
  t = vec3(1.0 + s * w.x * w.x * p, s * q, -s * w.x);
  b = vec3(q, s + w.y * w.y * p, -w.y);
}

vec3 phaseDirection(vec3 w, float sine, float cosine, float turn) {
  vec3 t, b;
  phaseFrame(w, t, b);
  float angle = 6.28318530717958648 * turn;
  return normalize(sine * (cos(angle) * t + sin(angle) * b) + cosine * w);
}

// Henyey-Greenstein [HenyeyGreenstein1941] of mean cosine g, given as om = 1 - g and op = 1 + g (both rounded from
// double precision). With v = 1 - xi and d = om v + op xi the textbook's inversion becomes 1 - cos = 2 (om/d)^2 v (v +
// op xi) and 1 + cos = 2 (op/d)^2 xi (xi + om v): sums of positive terms, so neither g -> 0 nor |g| -> 1 loses digits.
vec3 henyeyGreensteinSample(vec3 w, float om, float op, vec2 xi) {
  float v = 1.0 - xi.x, d = om * v + op * xi.x;
  float a = om / d, b = op / d;
  float omc = 2.0 * a * a * v * (v + op * xi.x);
  float opc = 2.0 * b * b * xi.x * (xi.x + om * v);
  float cosine = omc < 1.0 ? 1.0 - omc : opc - 1.0;
  return phaseDirection(w, sqrt(omc * opc), cosine, xi.y);
}

// One component per channel. 1 - cos and 1 + cos come from differences of the vectors, not from their dot product.
vec3 henyeyGreensteinPdf(vec3 w, vec3 to, vec3 om, vec3 op) {
  vec3 apart = w - to, together = w + to;
  vec3 forward = om * om + (op - om) * (0.5 * dot(apart, apart));
  vec3 backward = op * op + (om - op) * (0.5 * dot(together, together));
  vec3 d = mix(backward, forward, lessThanEqual(om, vec3(1.0)));
  return kOver4Pi * om * op / (d * sqrt(d));
}

// Rayleigh: 3 / (16 pi) (1 + cos^2); inverted in closed form [Frisvad2011].
vec3 rayleighSample(vec3 w, vec2 xi) {
  float z = abs(4.0 * xi.x - 2.0);
  float a = pow(z + sqrt(z * z + 1.0), 1.0 / 3.0);
  float cosine = min(a - 1.0 / a, 1.0);
  return phaseDirection(w, sqrt((1.0 - cosine) * (1.0 + cosine)), xi.x < 0.5 ? -cosine : cosine, xi.y);
}

float rayleighPdf(vec3 w, vec3 to) {
  float cosine = dot(w, to);
  return 0.75 * kOver4Pi * (1.0 + cosine * cosine);
}
