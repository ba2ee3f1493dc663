// Directions from a point to a triangle, uniform in its solid angle [Arvo1995]. Of points that are uniform by area the
// density grows with distance^2 / cosine. Corners are unit vectors from the point, in either order.
//
// tan(angle / 2) = |a . (b x c)| / (1 + a.b + b.c + c.a) [vanOosterom1983]. The triangle's volume is formed of
// differences of its corners: a triangle that is small has small ones.

float sphericalTriangle(vec3 a, vec3 b, vec3 c) {
  return 2.0 * atan(abs(dot(a, cross(b - a, c - a))), 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
}

// Unit, from `a` along the great circle through `b`.
vec3 alongArc(vec3 a, vec3 b) {
  vec3 chord = b - a;
  return normalize(chord + 0.5 * dot(chord, chord) * a);
}

// xi.x draws a corner d = cos(s) a + sin(s) t on the arc from a to c, so that (a, b, d) has that share of the angle w.
// In van Oosterom's formula with h = tan(s / 2):
//   tan(w / 2) = h |a . (b x t)| / (1 + a.b + h b.t)
// xi.y draws a point of the arc from b to d, uniform in its cosine to b. One minus this cosine keeps its digits.
vec3 sphericalTriangleSample(vec3 a, vec3 b, vec3 c, float angle, vec2 xi) {
  float w = 0.5 * xi.x * angle;
  vec3 t = alongArc(a, c);
  vec2 h = normalize(vec2(cos(w) * abs(dot(a, cross(b - a, t))) - sin(w) * dot(b, t), sin(w) * (1.0 + dot(a, b))));
  vec3 d = (h.x - h.y) * (h.x + h.y) * a + 2.0 * h.x * h.y * t;
  float less = 0.5 * xi.y * dot(d - b, d - b);
  return xi.y > 0.0 ? (1.0 - less) * b + sqrt(less * (2.0 - less)) * alongArc(b, d) : b;
}
