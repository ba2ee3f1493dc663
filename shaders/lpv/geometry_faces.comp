// Blocking potential at the centre of every face: the mean of the four geometry-volume cells at the face's corners
// [Kaplanyan2010; LPV2015, figure 5.3]. Computed once per frame, so that each propagation step reads one texel per
// face.
// Face (i,j,k) of axis x lies between the cells (i-1,j,k) and (i,j,k); likewise for y and z.
#include "cascades/block.glsl"
#include "lpv/stored_units.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
#if FROM_BUFFER
layout(binding = 0) uniform samplerBuffer geometryVolume;  // as counted by atomics
#else
layout(binding = 0) uniform sampler3D geometryVolume;
#endif
layout(std430, binding = 3) writeonly buffer Faces { vec4 faces[]; };  // all x faces, then y, then z

vec4 potential(ivec3 corner) {
#if FROM_BUFFER
  int corners = grids.shape.x + 1;
  return texelFetch(geometryVolume, (corner.z * corners + corner.y) * corners + corner.x);
#else
  return texelFetch(geometryVolume, corner, 0);
#endif
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  int corners = grids.shape.x + 1;
  int layer = at.z % corners;
  if (any(greaterThanEqual(at, ivec3(corners, corners, corners * grids.shape.y)))) return;
  // Faces beyond the last cell of an axis do not exist; the values written for them are never read.
  vec4 here = potential(at);
  ivec3 x = ivec3(at.x + 1 < corners ? 1 : 0, 0, 0);
  ivec3 y = ivec3(0, at.y + 1 < corners ? 1 : 0, 0);
  ivec3 z = ivec3(0, 0, layer + 1 < corners ? 1 : 0);
  vec4 hereX = potential(at + x), hereY = potential(at + y), hereZ = potential(at + z);
  int face = (at.z * corners + at.y) * corners + at.x, facesOfAxis = corners * corners * corners * grids.shape.y;
  faces[face] = 0.25 * kStoredUnits * (here + hereY + hereZ + potential(at + y + z));
  faces[face + facesOfAxis] = 0.25 * kStoredUnits * (here + hereX + hereZ + potential(at + x + z));
  faces[face + 2 * facesOfAxis] = 0.25 * kStoredUnits * (here + hereX + hereY + potential(at + x + y));
}
