// Injection by image atomics: one invocation a texel of the reflective shadow map. Coefficient i of cell (x, y, z) is counted at
// (4 x + i, y, z) of its channel's image; lpv/resolve.comp brings the images into the form that blending gives.
// FILL_FIXED: 32-bit integers, core OpenGL 4.3; `fixedScale` is derived from the largest flux that there can be, so that nothing overflows;
// integer sums do not depend on their order, so every run gives the same bits. FILL_FLOAT: NV_shader_atomic_float.
// FILL_HALF: NV_shader_atomic_fp16_vector, four half floats at once, as the published text has it, only where
// there are no atomics on 32 bits; its image has one texel a cell.
#if FILL_FLOAT
#extension GL_NV_shader_atomic_float : require
#endif
#if FILL_HALF
#extension GL_NV_gpu_shader5 : require
#extension GL_NV_shader_atomic_fp16_vector : require
#endif
#include "lib/sh.glsl"
#include "lpv/common.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler2DArray rsmPosition;
layout(binding = 1) uniform sampler2DArray rsmNormal;
layout(binding = 2) uniform sampler2DArray rsmFlux;
#if FILL_FIXED
#define FILL_FORMAT r32i
#define FILL_IMAGE iimage3D
#elif FILL_FLOAT
#define FILL_FORMAT r32f
#define FILL_IMAGE image3D
#else
#define FILL_FORMAT rgba16f
#define FILL_IMAGE image3D
#endif
layout(binding = 0, FILL_FORMAT) coherent uniform FILL_IMAGE countRed;
layout(binding = 1, FILL_FORMAT) coherent uniform FILL_IMAGE countGreen;
layout(binding = 2, FILL_FORMAT) coherent uniform FILL_IMAGE countBlue;
uniform float fluxScale;   // 1, or without units 1 / texel area of the light's map
uniform float fixedScale;  // integer steps a unit of a coefficient stored in the finest cascade, see lpv/fixed.glsl

#if FILL_FIXED
#define COUNT(image, at, c)                                                       \
  for (int i = 0; i < 4; ++i)                                                     \
    imageAtomicAdd(image, ivec3(4 * at.x + i, at.yz), int(round((c)[i] * stepsOfCascade(k, fixedScale))))
#elif FILL_FLOAT
#define COUNT(image, at, c) \
  for (int i = 0; i < 4; ++i) imageAtomicAdd(image, ivec3(4 * at.x + i, at.yz), (c)[i])
#else
#define COUNT(image, at, c) imageAtomicAdd(image, at, f16vec4(c))
#endif

#include "lpv/fixed.glsl"
#include "lpv/vpl.glsl"

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);  // z: the map's layer
  if (any(greaterThanEqual(texel, textureSize(rsmPosition, 0)))) return;
  vec4 position = texelFetch(rsmPosition, texel, 0);
  vec3 normal = texelFetch(rsmNormal, texel, 0).xyz;
  vec3 flux = texelFetch(rsmFlux, texel, 0).rgb;
  if (!isUsableVpl(position, normal, flux)) return;
  for (int k = 0; k < lpv.shape.y; ++k) {
    ivec3 cell;
    if (!vplCell(k, position.xyz, normal, cell)) continue;
    ivec3 at = ivec3(cell.xy, k * lpv.shape.x + cell.z);
    vec4 lobe = vplLobe(k, normal, fluxScale);
    COUNT(countRed, at, flux.r * lobe);
    COUNT(countGreen, at, flux.g * lobe);
    COUNT(countBlue, at, flux.b * lobe);
  }
}
