// One propagation step of all cascades, as a gather: each cell reads its six neighbours once, in three colour channels.
//
// A front lies in a buffer, cell by cell, x fastest, all of red before green before blue; the sum of fronts in another. No branches where a sum
// begins or ends: a software rasteriser runs both sides of each.
#include "lpv/common.glsl"
#include "lpv/stored_units.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(std430, binding = 0) readonly buffer Source { vec4 source[]; };
layout(std430, binding = 1) writeonly buffer Next { vec4 next[]; };
layout(std430, binding = 2) buffer Sums { vec4 sums[]; };
#if BLOCKED
layout(std430, binding = 3) readonly buffer Faces { vec4 faces[]; };  // lpv/geometry_faces.comp
#endif
uniform bool sumBegins;  // the fronts of this step and of those that follow are a new sum: that of the later steps, with several cascades

#if BLOCKED
#define POTENTIAL(face) faces[face]
#else
#define POTENTIAL(face) vec4(0.0)
#endif

#if FACE_KERNEL
// Face by face in world axes: what the deviations need.
#define GATHER(axis, way, offset, stride, toFrame, fromFrame, face)                                                    \
  if (uint(local.axis - int(way)) < uint(cells)) {                                                                     \
    int from = at - int(way) * stride;                                                                                 \
    vec4 light[3] = vec4[3](source[from], source[from + channel], source[from + 2 * channel]);                         \
    gatherFaces(light, way * offset, POTENTIAL(face), sum);                                                            \
  }

void gatherFaces(vec4 light[3], vec3 travel, vec4 potential, inout vec4 sum[3]) {
  addFace(light, shBasis(travel), kFaceFront, facePasses(potential, travel), reprojected(travel), sum);
  for (int i = 0; i < 4; ++i) {
    vec3 towards, normal;
    sideFace(i, travel, towards, normal);
    addFace(light, shBasis(towards), kFaceSide, facePasses(potential, towards), reprojected(normal), sum);
  }
}
#else
// From the neighbour behind along one axis; `way` is +1 or -1, `stride` that axis' step in the buffer. toFrame and fromFrame rotate
// (c0, x, y, z) into (c0, travel, u, v) and back. `face` is the crossed face's index.
#define GATHER(axis, way, offset, stride, toFrame, fromFrame, face)                                                    \
  if (uint(local.axis - int(way)) < uint(cells)) {                                                                     \
    const vec4 turn = vec4(1.0, way, 1.0, 1.0);                                                                        \
    int from = at - int(way) * stride;                                                                                 \
    FaceValues openings = solidAngles(transmittanceTowardsFaces(POTENTIAL(face).toFrame * turn));                      \
    sum[0] += (carry(source[from].toFrame * turn, openings) * turn).fromFrame;                                         \
    sum[1] += (carry(source[from + channel].toFrame * turn, openings) * turn).fromFrame;                               \
    sum[2] += (carry(source[from + 2 * channel].toFrame * turn, openings) * turn).fromFrame;                           \
  }
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x, layers = cells * lpv.shape.y;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, layers)))) return;
  ivec3 local = ivec3(cell.xy, cell.z % cells);
  int at = (cell.z * cells + cell.y) * cells + cell.x, layer = cells * cells, channel = layer * layers;
  // The faces before this cell, at its lower corner in the geometry volume.
  int corners = cells + 1, corner = ((cell.z / cells * corners + local.z) * corners + cell.y) * corners + cell.x;
  int facesOfAxis = corners * corners * corners * lpv.shape.y;
  vec4 sum[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));

  GATHER(x, 1.0, vec3(1, 0, 0), 1, xyzw, xyzw, corner)
  GATHER(x, -1.0, vec3(1, 0, 0), 1, xyzw, xyzw, corner + 1)
  GATHER(y, 1.0, vec3(0, 1, 0), cells, xzwy, xwyz, facesOfAxis + corner)
  GATHER(y, -1.0, vec3(0, 1, 0), cells, xzwy, xwyz, facesOfAxis + corner + corners)
  GATHER(z, 1.0, vec3(0, 0, 1), layer, xwyz, xzwy, 2 * facesOfAxis + corner)
  GATHER(z, -1.0, vec3(0, 0, 1), layer, xwyz, xzwy, 2 * facesOfAxis + corner + corners * corners)

  next[at] = kNextUnits * sum[0];
  next[at + channel] = kNextUnits * sum[1];
  next[at + 2 * channel] = kNextUnits * sum[2];

  for (int i = 0; i < 3; ++i) sums[at + i * channel] = kSumUnits * sum[i] + (sumBegins ? vec4(0.0) : sums[at + i * channel]);
}
