// Converts the path tracer's film to radiance: the mean of each pixel's samples, 0 without samples.
layout(binding = 0) uniform usampler2D filmMean;  // bits of three floats, and the number of samples
layout(location = 0) out vec4 radiance;

void main() {
  uvec4 pixel = texelFetch(filmMean, ivec2(gl_FragCoord.xy), 0);
  radiance = vec4(pixel.w > 0u ? uintBitsToFloat(pixel.xyz) : vec3(0.0), 1.0);
}
