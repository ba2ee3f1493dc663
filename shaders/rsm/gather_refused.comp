// The full gather for the pixels that interpolation rejected and listed. Dispatched indirectly; if the list exceeds the
// dispatch limit, each group takes several pixels.
#include "rsm/gather.glsl"
#include "forward/visible.glsl"
#include "rsm/work.glsl"
layout(std430, binding = 1) readonly buffer Work { GatherWork work; };
layout(local_size_x = WORK_GROUP) in;
// unordered irradianceImage: each dispatch writes its own pixels
layout(rgba32f, binding = 0) uniform image2D irradianceImage;
layout(binding = 5) uniform usampler2D refusedPixels;
uniform ivec2 listPart;  // of a submission: from, to

void main() {
  uint first = uint(listPart.x) + gl_GlobalInvocationID.x;
  for (uint i = first; i < uint(listPart.y) && i < work.refused; i += gl_NumWorkGroups.x * WORK_GROUP) {
    int width = textureSize(refusedPixels, 0).x;
    uint refused = texelFetch(refusedPixels, ivec2(int(i) % width, int(i) / width), 0).x;
    ivec2 pixel = ivec2(refused & 0xffffu, refused >> 16);
    vec3 irradiance = gatherIrradiance(visiblePosition(pixel), visibleUnitNormal(pixel), pixelRotation(pixel));
    if (adds != 0) irradiance += imageLoad(irradianceImage, pixel).rgb;
    imageStore(irradianceImage, pixel, vec4(irradiance, 2.0));
  }
}
