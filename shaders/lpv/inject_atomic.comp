// Injection by atomics: one invocation per tile of the reflective shadow map. Coefficient i of a cell is accumulated in
// word 4 cell + i of the first wavefront, all red, then green, then blue, in place.
// FILL_FIXED: 32-bit integers, core OpenGL 4.3, which lpv/resolve.comp converts to floats. `fixedScale` is derived from
// the largest possible flux, so nothing overflows. Each light is rounded separately and integer sums do not depend on
// their order, so every run and every order of the texels gives the same bits.
// FILL_FLOAT: NV_shader_atomic_float.
// FILL_HALF: NV_shader_atomic_fp16_vector, four half floats at once in images, as in the published text; used only
// where 32-bit float atomics are missing.
#include "shared/bindings.h"
#if FILL_FLOAT
#extension GL_NV_shader_atomic_float : require
#endif
#if FILL_HALF
#extension GL_NV_gpu_shader5 : require
#extension GL_NV_shader_atomic_fp16_vector : require
#endif
#include "lib/sh.glsl"
#include "cascades/block.glsl"
#include "lpv/fixed.glsl"
#include "lpv/tile.glsl"
#include "lpv/vpl.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = UNIT_RSM_POSITION) uniform sampler2DArray rsmPosition;
layout(binding = UNIT_RSM_NORMAL) uniform sampler2DArray rsmNormal;
layout(binding = UNIT_RSM_FLUX) uniform sampler2DArray rsmFlux;
#if FILL_HALF
layout(binding = 0, rgba16f) coherent uniform image3D countRed;
layout(binding = 1, rgba16f) coherent uniform image3D countGreen;
layout(binding = 2, rgba16f) coherent uniform image3D countBlue;
#else
// unordered Counts: integer atomics commute
layout(std430, binding = 0) buffer Counts { WORD_TYPE words[]; };
#endif
uniform float fluxScale;   // 1; without units, 1 / texel area of the light's map
uniform float fixedScale;  // integer steps per unit of a coefficient stored in the finest cascade, see lpv/fixed.glsl

COUNT_TYPE run[3];  // sum over the texels since `runCell` was entered
int runCell;        // index in the stack of cascades; -1: none yet

void addRun() {
  if (runCell < 0) return;
  int cells = grids.shape.x;
#if FILL_HALF
  ivec3 at = ivec3(runCell % cells, runCell / cells % cells, runCell / (cells * cells));
  imageAtomicAdd(countRed, at, f16vec4(run[0]));
  imageAtomicAdd(countGreen, at, f16vec4(run[1]));
  imageAtomicAdd(countBlue, at, f16vec4(run[2]));
#else
  int word = 4 * runCell, channel = 4 * cells * cells * cells * grids.shape.y;
  ADD_TO(word, run[0])
  ADD_TO(word + channel, run[1])
  ADD_TO(word + 2 * channel, run[2])
#endif
}

void main() {
  ivec3 tile = ivec3(gl_GlobalInvocationID);  // z: layer of the map
  ivec3 size = textureSize(rsmPosition, 0);
  if (any(greaterThanEqual(ivec3(kTile * tile.xy, tile.z), size))) return;
  int cells = grids.shape.x;
  for (int k = 0; k < grids.shape.y; ++k) {
    float steps = stepsOfCascade(k, fixedScale);
    runCell = -1;
    run = COUNT_TYPE[3](COUNT_TYPE(0), COUNT_TYPE(0), COUNT_TYPE(0));
    for (int i = 0; i < kTile * kTile; ++i) {
      ivec3 texel = texelOfTile(tile, i);
      if (any(greaterThanEqual(texel.xy, size.xy))) continue;
      vec4 position = texelFetch(rsmPosition, texel, 0);
      vec3 normal = texelFetch(rsmNormal, texel, 0).xyz;
      vec3 flux = texelFetch(rsmFlux, texel, 0).rgb;
      ivec3 cell;
      if (!isUsableVpl(position, normal, flux) || !vplCell(k, position.xyz, normal, cell)) continue;
      int at = ((k * cells + cell.z) * cells + cell.y) * cells + cell.x;
      if (at != runCell) {
        addRun();
        run = COUNT_TYPE[3](COUNT_TYPE(0), COUNT_TYPE(0), COUNT_TYPE(0));
        runCell = at;
      }
      vec4 lobe = vplLobe(k, normal, fluxScale);
      run[0] += STEPS(flux.r * lobe, steps);
      run[1] += STEPS(flux.g * lobe, steps);
      run[2] += STEPS(flux.b * lobe, steps);
    }
    addRun();
  }
}
