// One direction of the propagation step [Kaplanyan2010, section 4.3; Kirsch2010]: the light that reaches a cell from
// the neighbour behind it along one axis. Everything is in that axis' frame (travel, u, v).
//
// For each of the destination's five faces other than the shared one: the intensity I towards the face's centre, the
// flux Omega * max(0, I) * transmittance, then Phi / pi * lobe(face normal) [LPV2015, 6.2: no 1/(4 pi), reprojection
// Phi_l = Phi_f]. Seen from the source's centre, a side face's centre lies along (2 travel + side) / sqrt(5). The solid
// angles are exact: one front and four sides make 2 pi / 3, six neighbours 4 pi, so band 0 is conserved.
//
// Functions are kept in face units, (Y00 c0, Y1 / sqrt(5) c1). Their value towards the front is then x + sqrt(5) y, and
// towards the sides x + 2 y + z, x + 2 y - z, x + 2 y + w and x + 2 y - w. Together with reprojecting the fluxes of all
// six neighbours at once, this halves the arithmetic.
#include "lib/sh.glsl"

const float kFrontSolidAngle = 0.40066968464623916;  // 4 atan(sqrt(11) / 33)
const float kSideSolidAngle = 0.42343135443673924;   // 2 atan(3 sqrt(11) / 11) - pi / 3
const float kRoot5 = 2.2360679774997897;
const vec4 kFaceUnits = vec4(kY00, vec3(kY1 / kRoot5));  // converts coefficients to face units

// Value towards the front face and the sides +u, -u, +v, -v.
struct FaceValues {
  float front;
  vec4 sides;
};

FaceValues evaluateTowardsFaces(vec4 f) {
  float base = f.x + 2.0 * f.y;
  return FaceValues(f.x + kRoot5 * f.y, base + vec4(f.z, -f.z, f.w, -f.w));
}

// Fraction transmitted through a blocking potential. A surfel blocks light that hits its front, travelling against its
// normal, so the potential is evaluated towards where the light comes from.
FaceValues transmittanceTowardsFaces(vec4 potential) {
  FaceValues b = evaluateTowardsFaces(vec4(potential.x, -potential.yzw));
  return FaceValues(1.0 - clamp(b.front, 0.0, 1.0), 1.0 - clamp(b.sides, 0.0, 1.0));
}

// Solid angles times transmittances.
FaceValues solidAngles(FaceValues transmittance) {
  return FaceValues(kFrontSolidAngle * transmittance.front, kSideSolidAngle * transmittance.sides);
}

// Fluxes to the faces: total, along travel, along u and along v.
vec4 carry(vec4 source, FaceValues openings) {
  FaceValues intensity = evaluateTowardsFaces(source);
  float front = max(intensity.front, 0.0) * openings.front;
  vec4 sides = max(intensity.sides, 0.0) * openings.sides;
  return vec4(front + (sides.x + sides.y) + (sides.z + sides.w), front, sides.x - sides.y, sides.z - sides.w);
}

// Fluxes in world axes, reprojected, as coefficients (kLobe0 and kLobe1 over pi) and in face units. Each constant is
// rounded once: a product of rounded constants would gain or lose the same 1e-7 in every step.
const vec4 kFluxInCoefficients = vec4(0.28209479177387814, vec3(0.32573500793527993));
const vec4 kFluxInFaceUnits = vec4(0.07957747154594767, vec3(0.07117625434171772));  // 1 / (4 pi), 1 / (2 sqrt(5) pi)
