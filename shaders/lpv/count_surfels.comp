// Fills the geometry volume by atomics, as lpv/inject_atomic.comp does for light: one invocation per tile of the
// reflective shadow map. The blocking potential is that of lpv/geometry_volume.geom. FILL_FIXED: `fixedScale` is
// derived from the total area of all texels, so it works only for the sun's map, whose texel areas are bounded.
#include "shared/bindings.h"
#if FILL_FLOAT
#extension GL_NV_shader_atomic_float : require
#endif
#include "lib/sh.glsl"
#include "cascades/block.glsl"
#include "lpv/fixed.glsl"
#include "lpv/surfel.glsl"
#include "lpv/tile.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = UNIT_RSM_POSITION) uniform sampler2DArray rsmPosition;
layout(binding = UNIT_RSM_NORMAL) uniform sampler2DArray rsmNormal;
layout(binding = UNIT_RSM_FLUX) uniform sampler2DArray rsmFlux;  // w: area
layout(std430, binding = 0) buffer Counts { WORD_TYPE words[]; };
uniform float fixedScale;

COUNT_TYPE run;
int runCorner;

void addRun() {
  if (runCorner >= 0) ADD_TO(4 * runCorner, run)
}

void main() {
  ivec3 tile = ivec3(gl_GlobalInvocationID);  // z: layer of the map
  ivec3 size = textureSize(rsmPosition, 0);
  if (any(greaterThanEqual(ivec3(kTile * tile.xy, tile.z), size))) return;
  int corners = grids.shape.x + 1;
  for (int k = 0; k < grids.shape.y; ++k) {
    float s = grids.cascades[k].cellSize, steps = stepsOfCascade(k, fixedScale);
    runCorner = -1;
    run = COUNT_TYPE(0);
    for (int i = 0; i < kTile * kTile; ++i) {
      ivec3 texel = texelOfTile(tile, i);
      if (any(greaterThanEqual(texel.xy, size.xy))) continue;
      vec4 position = texelFetch(rsmPosition, texel, 0);
      vec3 normal = texelFetch(rsmNormal, texel, 0).xyz;
      float area = texelFetch(rsmFlux, texel, 0).w;
      ivec3 corner;
      if (!isUsableSurfel(position, normal, area) || !surfelCorner(k, position.xyz, corner)) continue;
      int at = ((k * corners + corner.z) * corners + corner.y) * corners + corner.x;
      if (at != runCorner) {
        addRun();
        run = COUNT_TYPE(0);
        runCorner = at;
      }
      run += STEPS(area / (s * s) * shCosineLobe(normal), steps);
    }
    addRun();
  }
}
