// How surfaces scatter light: pure functions. Directions are unit and point away from the surface; `normal` is on the side of `out`
// (towards the camera); a density is over solid angle, 1/sr.

const float kPi = 3.14159265358979324;

// An orthonormal frame about a unit vector [Duff2017].
void tangentFrame(vec3 n, out vec3 t, out vec3 b) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float p = -1.0 / (s + n.z), q = n.x * n.y * p;
  t = vec3(1.0 + s * n.x * n.x * p, s * q, -s * n.x);
  b = vec3(q, s + n.y * n.y * p, -n.y);
}

// Directions about a normal with density cos / pi.
vec3 cosineSample(vec3 normal, vec2 xi) {
  float r = sqrt(xi.x), angle = 2.0 * kPi * xi.y;
  vec3 t, b;
  tangentFrame(normal, t, b);
  return normalize(r * cos(angle) * t + r * sin(angle) * b + sqrt(1.0 - xi.x) * normal);
}

// Points on a triangle by area: weights of its second and third corner.
vec2 triangleSample(vec2 xi) {
  float r = sqrt(xi.x);
  return vec2(r * (1.0 - xi.y), r * xi.y);
}

// The share that one of two ways of sampling has in what both could have found: power heuristic, exponent 2 [Veach1997].
// a: density of the way taken, above 0; b: that of the other.
float powerHeuristic(float a, float b) {
  float r = b / a;
  return 1.0 / (1.0 + r * r);
}
