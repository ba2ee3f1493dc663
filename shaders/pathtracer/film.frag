// Converts the path tracer's film to radiance: the mean of each pixel's samples, 0 without samples. DENOISED: the
// denoiser's result as it is.
#if DENOISED
layout(binding = 0) uniform sampler2D denoised;
#else
layout(binding = 0) uniform usampler2D filmMean;  // bits of three floats, and the number of samples
#endif
layout(location = 0) out vec4 radiance;

void main() {
#if DENOISED
  radiance = texelFetch(denoised, ivec2(gl_FragCoord.xy), 0);
#else
  uvec4 pixel = texelFetch(filmMean, ivec2(gl_FragCoord.xy), 0);
  radiance = vec4(pixel.w > 0u ? uintBitsToFloat(pixel.xyz) : vec3(0.0), 1.0);
#endif
}
