// Form factor from a point with normal +z to a triangle: the contour integral [Lambert1760], [BaumRushmeierWinget1989
// eq 6], after clipping at the horizon. The triangle faces the point (clockwise as seen from it is positive here; the
// absolute value is returned).
#include "lib/angle.glsl"

// z component of one edge's contour integral: the angle between a and b times the z of the unit vector across them.
float contour(vec3 a, vec3 b) {
  vec3 across = cross(a, b);
  float s = length(across);
  return s > 0.0 ? angleOf(s, dot(a, b)) * across.z / s : 0.0;
}

float pointToTriangle(vec3 a, vec3 b, vec3 c) {
  const float kTwoPi = 6.283185307179586;
  bvec3 above = bvec3(a.z > 0.0, b.z > 0.0, c.z > 0.0);
  if (!any(above)) return 0.0;
  // Far and small: the edges' terms would cancel.
  vec3 across = cross(b - a, c - a), m = (a + b + c) / 3.0;
  float distance2 = dot(m, m), doubledArea = length(across);
  if (all(above) && distance2 > 2000.0 * doubledArea)
    return max(m.z, 0.0) * abs(dot(m, across)) / (kTwoPi * distance2 * distance2);
  if (all(above)) return abs(contour(a, b) + contour(b, c) + contour(c, a)) / kTwoPi;
  // Rotate the corners so that a is alone on its side of the horizon.
  if (above.y != above.x && above.y != above.z) {
    vec3 t = a; a = b; b = c; c = t;
  } else if (above.z != above.x && above.z != above.y) {
    vec3 t = a; a = c; c = b; b = t;
  }
  vec3 ab = mix(a, b, a.z / (a.z - b.z)), ac = mix(a, c, a.z / (a.z - c.z));
  ab.z = 0.0;
  ac.z = 0.0;
  if (a.z > 0.0) return abs(contour(a, ab) + contour(ab, ac) + contour(ac, a)) / kTwoPi;
  return abs(contour(ab, b) + contour(b, c) + contour(c, ac) + contour(ac, ab)) / kTwoPi;
}
