// Indirect irradiance at every Nth pixel each way [Dachsbacher2005, screen-space interpolation].
#include "rsm/gather.glsl"
#include "forward/visible.glsl"
#include "rsm/low.glsl"
#include "rsm/work.glsl"
// unordered Work: atomic sums commute
layout(std430, binding = 1) buffer Work { GatherWork work; };
layout(local_size_x = 8, local_size_y = 8) in;
// unordered lowIrradiance: each dispatch writes its own pixels
layout(rgba32f, binding = 0) uniform image2D lowIrradiance;  // W/m^2; w = 1 on a surface
uniform ivec2 firstPixel;  // of a part of the picture
shared uint groupSamples;

void main() {
  if (gl_LocalInvocationIndex == 0u) groupSamples = 0u;
  barrier();
  ivec2 low = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(low, imageSize(lowIrradiance)))) {
    ivec2 pixel = lowPixel(low);
    vec4 result = vec4(0.0);
    if (isVisibleSurface(pixel)) {
      result = vec4(gatherIrradiance(visiblePosition(pixel), visibleUnitNormal(pixel), pixelRotation(pixel)), 1.0);
      if (adds != 0) result.rgb += imageLoad(lowIrradiance, low).rgb;
      else atomicAdd(groupSamples, 1u);
    }
    imageStore(lowIrradiance, low, result);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && groupSamples > 0u) atomicAdd(work.lowSamples, groupSamples);
}
