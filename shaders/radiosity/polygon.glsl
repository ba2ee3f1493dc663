// Form factor from a point with normal +z to a triangle: the contour integral [Lambert1760], [BaumRushmeierWinget1989
// eq 6], after clipping at the horizon. The triangle faces the point (clockwise as seen from it is positive here; the
// absolute value is returned). Triangles are a corner and the edges from it round to it: of a narrow one that is far
// from the origin the corners alone do not say how narrow it is.
#include "lib/angle.glsl"

// z component of the contour integral of the edge from p on: the angle that it spans times the z of the unit vector
// across it.
float contour(vec3 p, vec3 edge) {
  vec3 across = cross(p, edge);
  float s = length(across);
  return s > 0.0 ? angleOf(s, dot(p, p + edge)) * across.z / s : 0.0;
}

// contour(p, edge + step) - contour(p, edge) for a short step, in terms of it, since the two nearly cancel.
float contourStep(vec3 p, vec3 edge, vec3 step) {
  vec3 v = cross(p, edge), dv = cross(p, step), w = v + dv;
  float sine = length(v), otherSine = length(w), cosine = dot(p, p + edge), otherCosine = cosine + dot(p, step);
  if (!(sine > 0.0 && otherSine > 0.0)) return contour(p, edge + step) - contour(p, edge);
  float further = dot(dv, v + w) / (sine + otherSine),  // otherSine - sine
        between = further * cosine - dot(p, step) * sine, turn = angleOf(abs(between),
                                                                         cosine * otherCosine + sine * otherSine);
  return angleOf(otherSine, otherCosine) / otherSine * dv.z +
         ((between < 0.0 ? -turn : turn) * sine - angleOf(sine, cosine) * further) / (sine * otherSine) * v.z;
}

// The contour integral of a triangle above the horizon. In a sliver those of the long edges nearly cancel; there it is
// that of two right-angled triangles, on both sides of its height.
float contourOf(vec3 a, vec3 ab, vec3 bc, vec3 ca) {
  vec3 squares = vec3(dot(ab, ab), dot(bc, bc), dot(ca, ca)), across = cross(ab, bc);
  float longest = max(squares.x, max(squares.y, squares.z));
  if (dot(across, across) > 0.01 * longest * longest) return contour(a, ab) + contour(a + ab, bc) + contour(a - ca, ca);
  // Rotate the corners so that ab is the longest edge, and make it 1 long.
  if (squares.y == longest) {
    vec3 t = ab;
    a += ab, ab = bc, bc = ca, ca = t, squares = squares.yzx;
  } else if (squares.z == longest) {
    vec3 t = ca;
    a -= ca, ca = bc, bc = ab, ab = t, squares = squares.zxy;
  }
  float scale = inversesqrt(longest);
  a *= scale, ab *= scale, bc *= scale, ca *= scale;
  // The height's foot, from the nearer end of ab.
  bool nearA = squares.z < squares.y;
  float foot = nearA ? -dot(ca, ab) : dot(bc, ab);
  vec3 height = (nearA ? -ca : bc) - foot * ab;
  return contourStep(a + ab, (nearA ? foot - 1.0 : foot) * ab, height) -
         contourStep(a, (nearA ? foot : foot + 1.0) * ab, height);
}

float formFactor(vec3 a, vec3 ab, vec3 bc, vec3 ca) {
  const float kTwoPi = 6.283185307179586;
  vec3 b = a + ab, c = a - ca;
  bvec3 above = bvec3(a.z > 0.0, b.z > 0.0, c.z > 0.0);
  if (!any(above)) return 0.0;
  // Far and small: the edges' terms would cancel.
  vec3 across = cross(ab, bc), m = a + (ab - ca) / 3.0;
  float distance2 = dot(m, m), longest = max(dot(ab, ab), max(dot(bc, bc), dot(ca, ca)));
  if (all(above) && distance2 > 2000.0 * longest)
    return max(m.z, 0.0) * abs(dot(m, across)) / (kTwoPi * distance2 * distance2);
  // Rotate the corners so that a is alone on its side of the horizon.
  if (above.y != above.x && above.y != above.z) {
    vec3 t = a; a = b; b = c; c = t;
    t = ab; ab = bc; bc = ca; ca = t;
  } else if (above.z != above.x && above.z != above.y) {
    vec3 t = a; a = c; c = b; b = t;
    t = ab; ab = ca; ca = bc; bc = t;
  }
  float toB = a.z / (a.z - b.z), toC = a.z / (a.z - c.z);
  vec3 onAb = a + toB * ab, along = toC * bc + toC * bc.z / (a.z - b.z) * ab;  // the horizon's
  onAb.z = 0.0;
  float sum = 0.0;
  if (!all(above)) {
    if (a.z > 0.0) {
      ab *= toB, bc = along, ca *= toC;
    } else {
      vec3 rest = (1.0 - toB) * ab;
      sum = contourOf(onAb, rest + bc, (1.0 - toC) * ca, -along);
      a = onAb, ab = rest, ca = -rest - bc;
    }
  }
  return abs(sum + contourOf(a, ab, bc, ca)) / kTwoPi;
}

float pointToTriangle(vec3 a, vec3 b, vec3 c) { return formFactor(a, b - a, c - b, a - c); }
