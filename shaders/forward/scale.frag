// A picture times a factor: to add frames up, and for their mean.
layout(binding = 0) uniform sampler2D radianceTexture;
uniform float factor;
layout(location = 0) out vec4 radiance;

void main() { radiance = vec4(factor * texelFetch(radianceTexture, ivec2(gl_FragCoord.xy), 0).rgb, 1.0); }
