// One direction of the propagation step [Kaplanyan2010, section 4.3; Kirsch2010]: what reaches a cell from the neighbour
// behind it along one axis. Everything is in the frame (travel, u, v) of that axis: vec4(c0, c along, c u, c v).
//
// For each of the five faces of the destination but the shared one: the intensity I towards the face's centre, the flux
// Omega * max(0, I) * transmittance, then Phi / pi * lobe(face normal) [LPV2015, 6.2: no 1/(4 pi), reprojection Phi_l = Phi_f].
// Seen from the source's centre a side face's centre lies along (2 travel + side) / sqrt(5).
// Solid angles: exact, one front and four sides make 2 pi / 3, six neighbours 4 pi: band 0 is conserved.
#include "lib/sh.glsl"

const float kFrontSolidAngle = 0.40066968464623916;  // 4 atan(sqrt(11) / 33)
const float kSideSolidAngle = 0.42343135443673924;   // 2 atan(3 sqrt(11) / 11) - pi / 3
const float kAlongSide = 0.89442719099991588;        // 2 / sqrt(5)
const float kAcrossSide = 0.44721359549995794;       // 1 / sqrt(5)

// Value of a two-band function towards the front face and the sides +u, -u, +v, -v.
struct FaceValues {
  float front;
  vec4 sides;
};

FaceValues evaluateTowardsFaces(vec4 c) {
  float constant = kY00 * c.x;
  float base = constant + kY1 * kAlongSide * c.y;
  vec2 across = kY1 * kAcrossSide * c.zw;
  return FaceValues(constant + kY1 * c.y, base + vec4(across.x, -across.x, across.y, -across.y));
}

// Fraction that passes a blocking potential. A surfel blocks what meets its front, light that travels against its normal:
// the potential is evaluated towards where the light comes from.
FaceValues transmittanceTowardsFaces(vec4 potential) {
  FaceValues b = evaluateTowardsFaces(vec4(potential.x, -potential.yzw));
  return FaceValues(1.0 - clamp(b.front, 0.0, 1.0), 1.0 - clamp(b.sides, 0.0, 1.0));
}

vec4 carry(vec4 source, FaceValues transmittance) {
  FaceValues intensity = evaluateTowardsFaces(source);
  float front = kFrontSolidAngle * max(intensity.front, 0.0) * transmittance.front;
  vec4 sides = kSideSolidAngle * max(intensity.sides, 0.0) * transmittance.sides;
  float total = front + sides.x + sides.y + sides.z + sides.w;
  return vec4(kLobe0 * total, kLobe1 * vec3(front, sides.x - sides.y, sides.z - sides.w)) / kPi;
}
