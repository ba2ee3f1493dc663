// One propagation step of all cascades, as a gather: each cell reads its six neighbours once, in three colour channels.
#include "lpv/common.glsl"
#if FACE_KERNEL
#include "lpv/kernel_faces.glsl"
#else
#include "lpv/kernel.glsl"
#endif
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D sourceRed;
layout(binding = 1) uniform sampler3D sourceGreen;
layout(binding = 2) uniform sampler3D sourceBlue;
#if BLOCKED
layout(binding = 3) uniform sampler3D facesX;
layout(binding = 4) uniform sampler3D facesY;
layout(binding = 5) uniform sampler3D facesZ;
#endif
layout(binding = 0, LPV_FORMAT) writeonly uniform image3D nextRed;
layout(binding = 1, LPV_FORMAT) writeonly uniform image3D nextGreen;
layout(binding = 2, LPV_FORMAT) writeonly uniform image3D nextBlue;
// The sum of fronts that this step belongs to: that of the first steps or, with several cascades, that of the later ones.
// The step that begins a sum writes it: with the injected grid if it is the first of all.
layout(binding = 3, LPV_FORMAT) uniform image3D sumRed;
layout(binding = 4, LPV_FORMAT) uniform image3D sumGreen;
layout(binding = 5, LPV_FORMAT) uniform image3D sumBlue;

#if BLOCKED
#define POTENTIAL(faces, faceOffset) texelFetch(faces, corner + faceOffset, 0)
#else
#define POTENTIAL(faces, faceOffset) vec4(0.0)
#endif

#if FACE_KERNEL
// Face by face in world axes: what the deviations need.
#define GATHER(axis, way, offset, toFrame, fromFrame, faces, faceOffset)                                                \
  if (uint(local.axis - int(way)) < uint(cells)) {                                                                     \
    vec4 source[3] = vec4[3](texelFetch(sourceRed, cell - offset, 0), texelFetch(sourceGreen, cell - offset, 0),      \
                             texelFetch(sourceBlue, cell - offset, 0));                                                \
    gatherFaces(source, vec3(offset), POTENTIAL(faces, faceOffset), sum);                                              \
  }

void gatherFaces(vec4 source[3], vec3 travel, vec4 potential, inout vec4 sum[3]) {
  addFace(source, shBasis(travel), kFaceFront, facePasses(potential, travel), reprojected(travel), sum);
  for (int i = 0; i < 4; ++i) {
    vec3 towards, normal;
    sideFace(i, travel, towards, normal);
    addFace(source, shBasis(towards), kFaceSide, facePasses(potential, towards), reprojected(normal), sum);
  }
}
#else
// From the neighbour at `cell - offset` along one axis. toFrame and fromFrame rotate (c0, x, y, z) into (c0, travel, u, v) and back; `way`
// is +1 or -1 along the axis. `faceOffset` leads from the cell's lower corner to the crossed face.
#define GATHER(axis, way, offset, toFrame, fromFrame, faces, faceOffset)                                                       \
  if (uint(local.axis - int(way)) < uint(cells)) {                                                                            \
    const vec4 turn = vec4(1.0, way, 1.0, 1.0);                                                                               \
    FaceValues transmittance = transmittanceTowardsFaces(POTENTIAL(faces, faceOffset).toFrame * turn);                        \
    sum[0] += (carry(texelFetch(sourceRed, cell - offset, 0).toFrame * turn, transmittance) * turn).fromFrame;                \
    sum[1] += (carry(texelFetch(sourceGreen, cell - offset, 0).toFrame * turn, transmittance) * turn).fromFrame;              \
    sum[2] += (carry(texelFetch(sourceBlue, cell - offset, 0).toFrame * turn, transmittance) * turn).fromFrame;               \
  }
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = lpv.shape.x;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, cells * lpv.shape.y)))) return;
  ivec3 local = ivec3(cell.xy, cell.z % cells);
  ivec3 corner = ivec3(cell.xy, cell.z / cells * (cells + 1) + local.z);  // the cell's lower corner in the geometry volume
  vec4 sum[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));

  GATHER(x, 1.0, ivec3(1, 0, 0), xyzw, xyzw, facesX, ivec3(0, 0, 0))
  GATHER(x, -1.0, ivec3(-1, 0, 0), xyzw, xyzw, facesX, ivec3(1, 0, 0))
  GATHER(y, 1.0, ivec3(0, 1, 0), xzwy, xwyz, facesY, ivec3(0, 0, 0))
  GATHER(y, -1.0, ivec3(0, -1, 0), xzwy, xwyz, facesY, ivec3(0, 1, 0))
  GATHER(z, 1.0, ivec3(0, 0, 1), xwyz, xzwy, facesZ, ivec3(0, 0, 0))
  GATHER(z, -1.0, ivec3(0, 0, -1), xwyz, xzwy, facesZ, ivec3(0, 0, 1))

  vec4 red = sum[0], green = sum[1], blue = sum[2];
  imageStore(nextRed, cell, red);
  imageStore(nextGreen, cell, green);
  imageStore(nextBlue, cell, blue);
#if BEGINS_WITH_INJECTED
  imageStore(sumRed, cell, texelFetch(sourceRed, cell, 0) + red);
  imageStore(sumGreen, cell, texelFetch(sourceGreen, cell, 0) + green);
  imageStore(sumBlue, cell, texelFetch(sourceBlue, cell, 0) + blue);
#elif BEGINS_SUM
  imageStore(sumRed, cell, red);
  imageStore(sumGreen, cell, green);
  imageStore(sumBlue, cell, blue);
#else
  imageStore(sumRed, cell, imageLoad(sumRed, cell) + red);
  imageStore(sumGreen, cell, imageLoad(sumGreen, cell) + green);
  imageStore(sumBlue, cell, imageLoad(sumBlue, cell) + blue);
#endif
}
