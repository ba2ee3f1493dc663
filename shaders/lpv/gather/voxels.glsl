// Where surfaces are, coarsely: one bit a voxel, bricks of 4x4x4 in two words (engine/lpv/surface_voxels.hpp).
layout(binding = 6) uniform usamplerBuffer voxelBricks;
uniform vec3 voxelMinimum;   // of voxel 0
uniform float voxelSize;     // scene units
uniform ivec3 voxelBrickCount;

// Whether a surface lies between two points, both a little off their surfaces; the first point's own voxel does not count. toBorder: the ray goes on
// beyond the second.
bool isBlocked(vec3 from, vec3 to, bool toBorder) {
  vec3 start = (from - voxelMinimum) / voxelSize, direction = (to - from) / voxelSize;
  float end = toBorder ? 3.0e38 : 1.0;
  vec3 inverse = 1.0 / mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  ivec3 count = 4 * voxelBrickCount, first = ivec3(floor(start));
  vec3 far = max((vec3(0.0) - start) * inverse, (vec3(count) - start) * inverse);
  end = min(end, min(far.x, min(far.y, far.z)));
  float t = 0.0, nudge = 1e-3 / length(direction);  // a thousandth of a voxel, into the next
  int most = 2 * (count.x + count.y + count.z);
  for (int step_ = 0; step_ < most && t < end; ++step_) {
    ivec3 voxel = clamp(ivec3(floor(start + t * direction)), ivec3(0), count - 1);
    ivec3 brick = voxel >> 2, within = voxel & 3;
    uvec2 bits = texelFetch(voxelBricks, (brick.z * voxelBrickCount.y + brick.y) * voxelBrickCount.x + brick.x).xy;
    vec3 low, size;
    if (bits.x == 0u && bits.y == 0u) {
      low = vec3(4 * brick);
      size = vec3(4.0);
    } else {
      int bit = (within.z << 4) + (within.y << 2) + within.x;
      if ((((bit < 32 ? bits.x : bits.y) >> uint(bit & 31)) & 1u) != 0u && voxel != first) return true;
      low = vec3(voxel);
      size = vec3(1.0);
    }
    vec3 leave = max((low - start) * inverse, (low + size - start) * inverse);
    t = max(min(leave.x, min(leave.y, leave.z)), t) + nudge;
  }
  return false;
}
