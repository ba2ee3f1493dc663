// The propagation kernel face by face, as published: one term for each of the destination's five faces. Slower than
// kernel.glsl, which is the same in closed form, but every deviation of public implementations can be reproduced here,
// each by its own flag.
#include "lib/sh.glsl"

const float kFaceFront = 0.40066968464623916;  // sr, see kernel.glsl
#if SIDE_SOLID_ANGLE
const float kFaceSide = 0.4234413544;          // deviation lpv.side-solid-angle: a digit typo for 0.4234313544
#else
const float kFaceSide = 0.42343135443673924;
#endif
#if FOUR_PI_KERNEL
uniform float amplifier;                       // deviation lpv.four-pi-kernel: Omega / (4 pi), times a hand-set factor
#endif

// The i-th side face of the destination: the direction from the source's centre to the face's centre, and the face's
// normal.
void sideFace(int i, vec3 travel, out vec3 towards, out vec3 normal) {
  float sign_ = (i & 1) == 0 ? 1.0 : -1.0;
#if SIDE_DIRECTIONS
  // Deviation lpv.side-directions: the travel direction is multiplied componentwise by a vector that is right only for
  // travel along z.
  vec2 across = i < 2 ? vec2(sign_, 0.0) : vec2(0.0, sign_);
  towards = travel * vec3(across, 2.0) / sqrt(5.0);
  normal = travel * vec3(across, 0.0);
#else
  vec3 u = abs(travel.yzx), v = abs(travel.zxy);
  normal = sign_ * (i < 2 ? u : v);
  towards = (2.0 * travel + normal) / sqrt(5.0);
#endif
}

float facePasses(vec4 potential, vec3 towards) {
#if BLOCKING_DIRECTION
  vec3 direction = towards;   // deviation lpv.blocking-direction: evaluated in the direction of travel
#else
  vec3 direction = -towards;  // a surfel blocks light that hits its front
#endif
  return 1.0 - clamp(dot(potential, shBasis(direction)), 0.0, 1.0);
}

// Contribution of a flux through a face: a cosine lobe about the face's normal.
vec4 reprojected(vec3 normal) {
#if FOUR_PI_KERNEL
  return shCosineLobe(normal) * (amplifier / (4.0 * kPi));
#else
  return shCosineLobe(normal) / kPi;
#endif
}

void addFace(vec4 source[3], vec4 basis, float solidAngle, float passes, vec4 lobe, inout vec4 sum[3]) {
  for (int channel = 0; channel < 3; ++channel)
    sum[channel] += solidAngle * max(dot(source[channel], basis), 0.0) * passes * lobe;
}
