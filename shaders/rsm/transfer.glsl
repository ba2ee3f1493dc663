// Irradiance that one surfel of the reflective shadow map sends to a point: [Dachsbacher2005 eq 1] in watts,
//   E = Phi / pi * <n_p|x - x_p>+ <n|x_p - x>+ / |x - x_p|^4,
// Phi is the texel's flux, Phi / pi its radiant intensity along its normal. Next to the surfel this is unbounded,
// though a surface of exitance Phi / A never gives more than Phi / A. NEAR selects the replacement used there
// (README.md, "Near a surfel").
#include "rsm/read.glsl"
const float kPi = 3.14159265358979;
#define NEAR_NONE 0
#define NEAR_CLAMP 1  // the distance is clamped to minimumDistance2 from below
#define NEAR_DISC 2   // d^2 + A/pi replaces one d^2: exact on the axis of a disc of area A
// the exact form factor of the surfel's outline within near2 (d^2 < 4 A at perpendicular incidence), otherwise the
// point
#define NEAR_QUAD 3
#if NEAR == NEAR_CLAMP
uniform float minimumDistance2;  // over surfel.across: scene units squared
#endif

#if NEAR == NEAR_QUAD
#include "lib/angle.glsl"
// One edge's term of Lambert's polygon formula: angle between a and b, times the unit normal of their plane, along n.
float edgeIntegral(vec3 a, vec3 b, vec3 n) {
  vec3 across = cross(a, b);
  float sine = length(across);
  return sine > 0.0 ? angleOf(sine, dot(a, b)) * dot(across, n) / sine : 0.0;
}

// Form factor from a point with normal n to the parallelogram centre +- u/2 +- v/2 (relative to the point), clipped at
// the point's horizon: F = 1/(2 pi) |sum over edges| [Lambert 1760; BaumRushmeierWinget1989 eq 10]. A convex outline
// crosses the horizon at most twice; the piece of the horizon between the crossings closes it.
float quadFormFactor(vec3 centre, vec3 u, vec3 v, vec3 n) {
  vec3 corners[4] =
      vec3[4](centre + 0.5 * (u + v), centre + 0.5 * (v - u), centre - 0.5 * (u + v), centre + 0.5 * (u - v));
  vec3 leaves = vec3(0.0), enters = vec3(0.0);
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec3 a = corners[i], b = corners[(i + 1) & 3];
    float ha = dot(a, n), hb = dot(b, n);
    if (ha <= 0.0 && hb <= 0.0) continue;
    if (ha <= 0.0) enters = a = mix(a, b, ha / (ha - hb));
    if (hb <= 0.0) leaves = b = mix(a, b, ha / (ha - hb));
    sum += edgeIntegral(a, b, n);
  }
  sum += edgeIntegral(leaves, enters, n);  // both zero if nothing is clipped
  return abs(sum) / (2.0 * kPi);
}
#endif

vec3 surfelIrradiance(RsmSurfel surfel, vec3 position, vec3 normal) {
  vec3 away = position - surfel.position;
  float d2 = dot(away, away);
  if (!(d2 > 0.0)) return vec3(0.0);  // the surfel itself
  vec3 direction = away * inversesqrt(d2);
  float emitted = dot(surfel.normal, direction);
  if (!(emitted > 0.0)) return vec3(0.0);
#if NEAR == NEAR_QUAD
  if (d2 < surfel.near2) {  // its centre may lie below the horizon and a part of it above
    // The other side of a thin lit surface lies in the surfel's own plane. Rounding may put it just in front, where it
    // would receive the surfel's full exitance. So a receiver must be clear of the surfel by a twentieth of its edge.
    float clear = 0.025 * sqrt(surfel.near2) * -dot(surfel.normal, normal);
    if (dot(surfel.normal, away) < clear) return vec3(0.0);
    vec3 u, v;
    rsmSurfelEdges(surfel, u, v);
    return surfel.flux / length(cross(u, v)) * quadFormFactor(-away, u, v, normal);
  }
#endif
  float received = -dot(normal, direction);
  if (!(received > 0.0)) return vec3(0.0);
#if NEAR == NEAR_DISC
  d2 += surfel.area / kPi;
#elif NEAR == NEAR_CLAMP
  d2 = max(d2, minimumDistance2 * surfel.across);
#endif
  return surfel.flux * (emitted * received / (kPi * d2));
}
