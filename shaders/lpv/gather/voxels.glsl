// Coarse surface voxels: one bit per voxel, bricks of 4x4x4 in two words (engine/lpv/surface_voxels.hpp).
#include "lib/clamped_int.glsl"
layout(binding = 6) uniform usamplerBuffer voxelBricks;
uniform vec3 voxelMinimum;   // of voxel 0
uniform float voxelSize;     // scene units
uniform ivec3 voxelBrickCount;

// Whether a surface lies between two points, both slightly off their surfaces: a run of set voxels with free ones
// before and after it. A run at either end of the ray belongs to that end's own surface or to one that meets it there;
// in a corner the nearest voxels are always set. toBorder: the ray continues beyond the second point to the border, and
// anything it meets there blocks it.
bool isBlocked(vec3 from, vec3 to, bool toBorder) {
  vec3 start = (from - voxelMinimum) / voxelSize, direction = (to - from) / voxelSize;
  vec3 inverse = 1.0 / mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  ivec3 count = 4 * voxelBrickCount;
  vec3 far = max(-start * inverse, (vec3(count) - start) * inverse);
  float end = min(toBorder ? 3.0e38 : 1.0, min(far.x, min(far.y, far.z)));
  float t = 0.0, nudge = 1e-3 / length(direction);  // a thousandth of a voxel, to step into the next one
  bool wasFree = false, met = false;
  int most = 2 * (count.x + count.y + count.z);
  for (int i = 0; i < most && t < end; ++i) {  // ends: most follows from uniforms
    ivec3 voxel = clampedInt(floor(start + t * direction), ivec3(0), count - 1);
    ivec3 brick = voxel >> 2, within = voxel & 3;
    uvec2 bits = texelFetch(voxelBricks, (brick.z * voxelBrickCount.y + brick.y) * voxelBrickCount.x + brick.x).xy;
    bool empty = bits.x == 0u && bits.y == 0u;
    int bit = (within.z << 4) + (within.y << 2) + within.x;
    if (empty || (((bit < 32 ? bits.x : bits.y) >> uint(bit & 31)) & 1u) == 0u) {
      if (met) return true;
      wasFree = true;
    } else if (wasFree) {
      if (toBorder) return true;
      met = true;
    }
    vec3 low = empty ? vec3(4 * brick) : vec3(voxel), high = low + (empty ? 4.0 : 1.0);
    vec3 leave = max((low - start) * inverse, (high - start) * inverse);
    t = max(min(leave.x, min(leave.y, leave.z)), t) + nudge;
  }
  return false;
}
