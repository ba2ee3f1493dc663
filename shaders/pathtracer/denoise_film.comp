// Writes the mean of each half of a pixel and, in w, its variance, for the fits, which read every pixel many times.
layout(local_size_x = 8, local_size_y = 8) in;
#include "pathtracer/denoise.glsl"
layout(binding = 1) uniform usampler2D filmSquares;  // sums of squared deviations
layout(rgba32f, binding = 0) writeonly restrict uniform image2D film;

// Variance of a half's mean, summed over the channels; 0 for a single sample.
float varianceAt(ivec2 pixel, int which, float samples) {
  vec3 squares = max(uintBitsToFloat(texelFetch(filmSquares, inHalf(pixel, which), 0).xyz), vec3(0.0));
  return samples < 2.0 ? 0.0 : (squares.x + squares.y + squares.z) / (samples * (samples - 1.0));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  int which = int(gl_GlobalInvocationID.z);
  if (!isInPicture(pixel)) return;
  Half own = halfAt(pixel, which);
  imageStore(film, inHalf(pixel, which), vec4(own.mean, varianceAt(pixel, which, own.samples)));
}
