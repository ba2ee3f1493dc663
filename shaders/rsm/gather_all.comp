// The full gather for every pixel, without interpolation.
#include "rsm/gather.glsl"
#include "forward/visible.glsl"
#include "rsm/work.glsl"
// unordered Work: atomic sums commute
layout(std430, binding = 1) buffer Work { GatherWork work; };
layout(local_size_x = 8, local_size_y = 8) in;
// unordered irradianceImage: each dispatch writes its own pixels
layout(rgba32f, binding = 0) uniform image2D irradianceImage;
uniform ivec2 firstPixel;  // of a part of the picture
shared uint groupSurfaces;

void main() {
  if (gl_LocalInvocationIndex == 0u) groupSurfaces = 0u;
  barrier();
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(pixel, imageSize(irradianceImage)))) {
    vec4 result = vec4(0.0);
    if (isVisibleSurface(pixel)) {
      result = vec4(gatherIrradiance(visiblePosition(pixel), visibleUnitNormal(pixel), pixelRotation(pixel)), 1.0);
      if (adds != 0) result.rgb += imageLoad(irradianceImage, pixel).rgb;
      else atomicAdd(groupSurfaces, 1u);
    }
    imageStore(irradianceImage, pixel, result);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && groupSurfaces > 0u) atomicAdd(work.surfaces, groupSurfaces);
}
