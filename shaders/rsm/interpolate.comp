// Interpolates a pixel's irradiance from the 4 nearest low-resolution samples if at least 3 of them fit it: a similar
// normal, near its tangent plane, not far away [Dachsbacher2005]. Weights are bilinear among those that fit. Every
// other pixel is appended to the list for the full gather, those of a group at once.
#include "rsm/fit.glsl"
#include "rsm/work.glsl"
// unordered Work: atomic sums commute
layout(std430, binding = 1) buffer Work { GatherWork work; };
layout(local_size_x = 8, local_size_y = 8) in;
// unordered irradianceImage: each dispatch writes its own pixels
layout(rgba32f, binding = 0) writeonly uniform image2D irradianceImage;  // w: 0 no surface, 1 interpolated, 2 gathered
// unordered refusedPixels: each dispatch appends, at places that an atomic gives it
layout(r32ui, binding = 1) writeonly uniform uimage2D refusedPixels;  // x | y << 16, row by row
layout(binding = 5) uniform sampler2D lowIrradiance;
uniform ivec2 firstPixel;  // of a part of the picture
shared uint groupSurfaces, groupRefused, firstRefused;

void main() {
  if (gl_LocalInvocationIndex == 0u) groupSurfaces = groupRefused = 0u;
  barrier();
  bool isRefused = false;
  uint inGroup = 0u;  // its place among those that the group refuses
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(pixel, imageSize(irradianceImage)))) {
    if (isVisibleSurface(pixel)) {
      atomicAdd(groupSurfaces, 1u);
      vec4 sum = vec4(0.0);
      int fits = 0;
      for (int i = 0; i < 4; ++i) {
        LowSample near = lowSample(pixel, i);
        if (!near.fits) continue;
        ++fits;
        sum += near.weight * vec4(texelFetch(lowIrradiance, near.low, 0).rgb, 1.0);
      }
      if (fits >= 3 && sum.w > 1e-3) {
        imageStore(irradianceImage, pixel, vec4(sum.rgb / sum.w, 1.0));
      } else {
        isRefused = true;
        inGroup = atomicAdd(groupRefused, 1u);
      }
    } else {
      imageStore(irradianceImage, pixel, vec4(0.0));
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && groupSurfaces > 0u) atomicAdd(work.surfaces, groupSurfaces);
  if (gl_LocalInvocationIndex == 0u && groupRefused > 0u) {
    firstRefused = atomicAdd(work.refused, groupRefused);
    atomicMax(work.groupsX, min((firstRefused + groupRefused + WORK_GROUP - 1u) / WORK_GROUP, 65535u));
  }
  barrier();
  if (!isRefused) return;
  int index = int(firstRefused + inGroup), width = imageSize(refusedPixels).x;
  imageStore(refusedPixels, ivec2(index % width, index / width), uvec4(uint(pixel.x) | uint(pixel.y) << 16));
}
