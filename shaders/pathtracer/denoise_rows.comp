// Sums the terms along rows of the window.
layout(local_size_x = 8, local_size_y = 8) in;
#include "pathtracer/denoise_window.glsl"
layout(binding = 0) uniform sampler2D terms0;
layout(binding = 1) uniform sampler2D terms1;
layout(binding = 2) uniform sampler2D terms2;
layout(binding = 3) uniform sampler2D terms3;
layout(rgba32f, binding = 0) writeonly restrict uniform image2D rows0;
layout(rgba32f, binding = 1) writeonly restrict uniform image2D rows1;
layout(rgba32f, binding = 2) writeonly restrict uniform image2D rows2;
layout(rgba32f, binding = 3) writeonly restrict uniform image2D rows3;
uniform ivec2 firstPixel, picture;

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, picture))) return;
  vec4 sum0 = vec4(0.0), sum1 = vec4(0.0), sum2 = vec4(0.0), sum3 = vec4(0.0);
  // ends: at most 2 kWindow + 1 steps
  for (int x = max(pixel.x - kWindow, 0); x <= min(pixel.x + kWindow, picture.x - 1); ++x) {
    float weight = windowAt(x - pixel.x);
    ivec2 at = ivec2(x, pixel.y);
    sum0 += weight * texelFetch(terms0, at, 0);
    sum1 += weight * texelFetch(terms1, at, 0);
    sum2 += weight * texelFetch(terms2, at, 0);
    sum3 += weight * texelFetch(terms3, at, 0);
  }
  imageStore(rows0, pixel, sum0);
  imageStore(rows1, pixel, sum1);
  imageStore(rows2, pixel, sum2);
  imageStore(rows3, pixel, sum3);
}
