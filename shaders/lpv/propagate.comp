// One propagation step of all cascades, as a gather: each cell reads its six neighbours once, in three colour channels.
// One work group per brick that light has reached (lpv/bricks.glsl).
//
// A wavefront lies in one buffer, cell by cell, x fastest, all red, then green, then blue; the sum of wavefronts lies
// in another. They are read as texels: on llvmpipe a gather from a storage block takes three times as long. Starting a
// sum uses no branches, because a software rasteriser executes both sides of each.
#include "cascades/block.glsl"
#include "lpv/stored_units.glsl"
#include "lpv/bricks.glsl"
layout(local_size_x = 64) in;
layout(binding = 0) uniform samplerBuffer source;
#if BLOCKED
layout(binding = 1) uniform samplerBuffer faces;  // lpv/geometry_faces.comp
#endif
layout(binding = 2) uniform samplerBuffer sumBefore;
layout(std430, binding = 1) writeonly buffer Next { vec4 next[]; };
// aliased Sums: an invocation reads its own cell before it writes it, and no other one
layout(std430, binding = 2) writeonly buffer Sums { vec4 sums[]; };

#if BLOCKED
#define POTENTIAL(face) texelFetch(faces, face)
#else
#define POTENTIAL(face) vec4(0.0)
#endif
#if FIRST
#define SOURCE(at) (kStoredUnits * texelFetch(source, at))  // the injected light, as coefficients
#else
#define SOURCE(at) texelFetch(source, at)
#endif

#if FACE_KERNEL
// Face by face in world axes, as the deviations need it.
#define GATHER(axis, way, offset, stride, toFrame, fromFrame, face)                                                    \
  if (uint(local.axis - way) < uint(cells)) { /* bounded: an integer */                                                \
    int from = at - way * stride;                                                                                      \
    vec4 light[3] = vec4[3](SOURCE(from), SOURCE(from + channel), SOURCE(from + 2 * channel));                         \
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
// Gathers from the neighbour behind along one axis; `way` is +1 or -1, `stride` that axis' step in the buffer. toFrame
// and fromFrame rotate (c0, x, y, z) into (c0, travel, u, v) and back. `face` is the index of the crossed face.
#define GATHER(axis, way, offset, stride, toFrame, fromFrame, face)                                                    \
  if (uint(local.axis - way) < uint(cells)) { /* bounded: an integer */                                                \
    const vec4 turn = vec4(1.0, way, 1.0, 1.0);                                                                        \
    int from = at - way * stride;                                                                                      \
    FaceValues openings = solidAngles(transmittanceTowardsFaces(POTENTIAL(face).toFrame * turn));                      \
    sum[0] += (carry(SOURCE(from).toFrame * turn, openings) * turn).fromFrame;                                         \
    sum[1] += (carry(SOURCE(from + channel).toFrame * turn, openings) * turn).fromFrame;                               \
    sum[2] += (carry(SOURCE(from + 2 * channel).toFrame * turn, openings) * turn).fromFrame;                           \
  }
#endif

void main() {
  uint group = gl_WorkGroupID.y * kGroupsInRow + gl_WorkGroupID.x;
  if (group >= min(count, uint(brickCount())) || bricks[group] >= uint(brickCount())) return;
  int brick = int(bricks[group]), ofAxis = bricksOfAxis(), row = brick / ofAxis, slice = row / ofAxis,
      cascade = slice / ofAxis;
  int inBrick = int(gl_LocalInvocationID.x);
  ivec3 local = kBrick * ivec3(brick - row * ofAxis, row - slice * ofAxis, slice - cascade * ofAxis) +
                ivec3(inBrick & 3, inBrick >> 2 & 3, inBrick >> 4);
  int cells = grids.shape.x, layers = cells * grids.shape.y;
  if (any(greaterThanEqual(local, ivec3(cells)))) return;
  int layer = cells * cells, at = (cascade * cells + local.z) * layer + local.y * cells + local.x,
      channel = layer * layers;
  // The cell's lower faces, indexed by its lower corner in the geometry volume.
  int corners = cells + 1, corner = ((cascade * corners + local.z) * corners + local.y) * corners + local.x;
  int facesOfAxis = corners * corners * corners * grids.shape.y;
  vec4 sum[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));

  GATHER(x, 1, vec3(1, 0, 0), 1, xyzw, xyzw, corner)
  GATHER(x, -1, vec3(1, 0, 0), 1, xyzw, xyzw, corner + 1)
  GATHER(y, 1, vec3(0, 1, 0), cells, xzwy, xwyz, facesOfAxis + corner)
  GATHER(y, -1, vec3(0, 1, 0), cells, xzwy, xwyz, facesOfAxis + corner + corners)
  GATHER(z, 1, vec3(0, 0, 1), layer, xwyz, xzwy, 2 * facesOfAxis + corner)
  GATHER(z, -1, vec3(0, 0, 1), layer, xwyz, xzwy, 2 * facesOfAxis + corner + corners * corners)

  for (int i = 0; i < 3; ++i) {
    next[at + i * channel] = kNextUnits * sum[i];
    vec4 before = texelFetch(sumBefore, at + i * channel);
#if FIRST && WITH_INJECTED
    before = texelFetch(source, at + i * channel);  // the sum begins with G_0
#endif
    sums[at + i * channel] = kSumUnits * sum[i] + before;
  }
  // Fluxes are never negative, so a zero band 0 means no light.
  if (sum[0].x + sum[1].x + sum[2].x != 0.0) markNeighbours(local, brick);
}
