// Latitude-longitude pictures of all directions: the top row is +y, u grows with atan2(x, -z).
#include "lib/angle.glsl"
const float kTwoPi = 6.28318530717958648;

// Rotation about +y; `turn` is the angle's cosine and sine.
vec3 turnAboutY(vec3 d, vec2 turn) { return vec3(d.x * turn.x + d.z * turn.y, d.y, d.z * turn.x - d.x * turn.y); }

// u, v in 0..1 of a direction of any length; v = 0 at the top.
vec2 latitudeLongitude(vec3 d) {
  float across = length(d.xz), azimuth = across > 0.0 ? angleOf(abs(d.x), -d.z) : 0.0;  // any at the poles
  return vec2(0.5 + (d.x < 0.0 ? -azimuth : azimuth) / kTwoPi, angleOf(across, d.y) / (0.5 * kTwoPi));
}
