// One more bounce: combines the injected light and the light that surfaces reflect after propagation into the source of
// the next propagation.
//
// Light that crosses one of a cell's six faces is held back there by the surfels' blocking potential B
// (lpv/kernel.glsl). The blocked part returns to the cell it came from, times the albedo, as a cosine lobe about the
// surfels' mean normal. Every face sees the sum of all wavefronts, T - S; since max(0, sum) <= sum of max(0, .), no
// more is held back than in the steps themselves.
// Bounded: clamping negative intensities lets a cosine lobe gain a factor 1.138208 in its first step, never more
// (engine/lpv/README.md). That factor is divided out, so a source of flux S returns at most rho S, and the sum of all
// bounces stays below S / (1 - rho).
#include "cascades/block.glsl"
#include "lpv/kernel.glsl"
#include "lpv/sums.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 6) uniform sampler3D injectedRed;
layout(binding = 7) uniform sampler3D injectedGreen;
layout(binding = 8) uniform sampler3D injectedBlue;
layout(binding = 9) uniform sampler3D geometryVolume;
layout(binding = 10) uniform sampler3D reflectance;
layout(binding = 0, rgba32f) uniform image3D sourceRed;  // S, replaced by the next one
layout(binding = 1, rgba32f) uniform image3D sourceGreen;
layout(binding = 2, rgba32f) uniform image3D sourceBlue;
uniform bool first;         // S is still the injected grid
uniform float sourceShare;  // 1: T begins with S; 0 with the deviation lpv.fewer-steps

const float kClampGain = 1.138208;

vec4 reflected[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));

float heldBack(vec4 light, FaceValues passes) {
  FaceValues intensity = evaluateTowardsFaces(light);
  return kFrontSolidAngle * max(intensity.front, 0.0) * (1.0 - passes.front) +
         kSideSolidAngle * dot(max(intensity.sides, 0.0), 1.0 - passes.sides);
}

// The face through which light leaves the cell, with `way` along an axis; `corner` is the first of its four corners, u
// and v lead to the others. toFrame rotates (c0, x, y, z) into (c0, travel, u, v).
#define FACE(way, axis, corner, u, v, toFrame)                                                                      \
  {                                                                                                                 \
    ivec3 a = corner, b = corner + u, c = corner + v, d = corner + u + v;                                           \
    vec4 potential = 0.25 * (texelFetch(geometryVolume, a, 0) + texelFetch(geometryVolume, b, 0) +                  \
                             texelFetch(geometryVolume, c, 0) + texelFetch(geometryVolume, d, 0));                  \
    vec3 tint = 0.25 * (texelFetch(reflectance, a, 0).rgb + texelFetch(reflectance, b, 0).rgb +                     \
                        texelFetch(reflectance, c, 0).rgb + texelFetch(reflectance, d, 0).rgb);                     \
    if (potential.x > 0.0) {                                                                                        \
      const vec4 turn = vec4(1.0, way, 1.0, 1.0);                                                                   \
      FaceValues passes = transmittanceTowardsFaces((kFaceUnits * potential).toFrame * turn);                       \
      float directed = length(potential.yzw);                                                                       \
      /* Surfels back to back have no mean normal: then back to where the light comes from. */                      \
      vec3 normal = directed > 1e-3 * potential.x ? potential.yzw / directed : (-(way)) * vec3(axis);               \
      vec3 albedo = tint * (kLobe0 / potential.x);                                                                  \
      vec3 held = vec3(heldBack(light[0].toFrame * turn, passes), heldBack(light[1].toFrame * turn, passes),        \
                       heldBack(light[2].toFrame * turn, passes));                                                  \
      vec3 flux = albedo / kClampGain * held;                                                                       \
      for (int i = 0; i < 3; ++i) reflected[i] += flux[i] / kPi * shCosineLobe(normal);                             \
    }                                                                                                               \
  }

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = grids.shape.x;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, cells * grids.shape.y)))) return;
  ivec3 corner = ivec3(cell.xy, cell.z / cells * (cells + 1) + cell.z % cells);
  vec4 injected[3] =
      vec4[3](texelFetch(injectedRed, cell, 0), texelFetch(injectedGreen, cell, 0), texelFetch(injectedBlue, cell, 0));
  vec4 source[3] = injected;
  if (!first) source = vec4[3](imageLoad(sourceRed, cell), imageLoad(sourceGreen, cell), imageLoad(sourceBlue, cell));
  vec4 light[3] = vec4[3](SUM_AT(nearSums, cell, 0), SUM_AT(nearSums, cell, 1), SUM_AT(nearSums, cell, 2));  // T
#if JOINED
  light[0] += SUM_AT(farSums, cell, 0);
  light[1] += SUM_AT(farSums, cell, 1);
  light[2] += SUM_AT(farSums, cell, 2);
#endif
  for (int i = 0; i < 3; ++i) light[i] = kFaceUnits * (light[i] - sourceShare * source[i]);

  const ivec3 x = ivec3(1, 0, 0), y = ivec3(0, 1, 0), z = ivec3(0, 0, 1);
  FACE(1.0, x, corner + x, y, z, xyzw)
  FACE(-1.0, x, corner, y, z, xyzw)
  FACE(1.0, y, corner + y, x, z, xzwy)
  FACE(-1.0, y, corner, x, z, xzwy)
  FACE(1.0, z, corner + z, x, y, xwyz)
  FACE(-1.0, z, corner, x, y, xwyz)

  imageStore(sourceRed, cell, injected[0] + reflected[0]);
  imageStore(sourceGreen, cell, injected[1] + reflected[1]);
  imageStore(sourceBlue, cell, injected[2] + reflected[2]);
}
