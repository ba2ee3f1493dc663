// One propagation step of one cascade as published [LPV2015, 5.3]: drawn slice by slice, with six neighbours of five
// faces each and the blocking potential read at each crossed face's centre. Three targets take the new wavefront, three
// add to the sum.
#include "cascades/block.glsl"
#include "lpv/kernel_faces.glsl"
flat in int fSlice;
layout(binding = 0) uniform sampler3D sourceRed;
layout(binding = 1) uniform sampler3D sourceGreen;
layout(binding = 2) uniform sampler3D sourceBlue;
#if BLOCKED
layout(binding = 3) uniform sampler3D geometryVolume;  // linear
#endif
layout(location = 0) out vec4 nextRed;
layout(location = 1) out vec4 nextGreen;
layout(location = 2) out vec4 nextBlue;
layout(location = 3) out vec4 sumRed;
layout(location = 4) out vec4 sumGreen;
layout(location = 5) out vec4 sumBlue;
uniform int cascade;

float passes(ivec3 cell, vec3 travel, vec3 towards) {
#if BLOCKED
  // The crossed face's centre in cells of the geometry volume, whose cell centres are the grid's corners.
  float corners = float(grids.shape.x + 1);
  vec3 texel = vec3(cell) + 0.5 - 0.5 * travel + 0.5;
  texel.z += float(cascade) * corners;
  return facePasses(textureLod(geometryVolume, texel / vec3(corners, corners, corners * float(grids.shape.y)), 0.0),
                    towards);
#else
  return 1.0;
#endif
}

void main() {
  ivec3 cell = ivec3(gl_FragCoord.xy, fSlice);
  int cells = grids.shape.x;
  int layers = cascade * cells;
  vec4 sum[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
  for (int d = 0; d < 6; ++d) {
    vec3 travel = vec3(0.0);
    travel[d >> 1] = (d & 1) == 0 ? 1.0 : -1.0;
    ivec3 neighbour = cell - ivec3(travel);  // bounded: -1, 0 or 1
    if (any(lessThan(neighbour, ivec3(0))) || any(greaterThanEqual(neighbour, ivec3(cells)))) continue;
    ivec3 at = neighbour + ivec3(0, 0, layers);
    vec4 source[3] =
        vec4[3](texelFetch(sourceRed, at, 0), texelFetch(sourceGreen, at, 0), texelFetch(sourceBlue, at, 0));
    addFace(source, shBasis(travel), kFaceFront, passes(cell, travel, travel), reprojected(travel), sum);
    for (int i = 0; i < 4; ++i) {
      vec3 towards, normal;
      sideFace(i, travel, towards, normal);
      addFace(source, shBasis(towards), kFaceSide, passes(cell, travel, towards), reprojected(normal), sum);
    }
  }
  nextRed = sum[0];
  nextGreen = sum[1];
  nextBlue = sum[2];
#if BEGINS_WITH_INJECTED
  // The first step also adds the injected grid: the sum begins with G_0.
  ivec3 here = cell + ivec3(0, 0, layers);
  sum = vec4[3](sum[0] + texelFetch(sourceRed, here, 0), sum[1] + texelFetch(sourceGreen, here, 0),
                sum[2] + texelFetch(sourceBlue, here, 0));
#endif
  sumRed = sum[0];
  sumGreen = sum[1];
  sumBlue = sum[2];
}
