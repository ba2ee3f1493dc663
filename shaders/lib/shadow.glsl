// The visible fraction of a light, from four bilinear depth comparisons that form a 3x3 tent filter. The receiver is
// first moved along its normal by a distance that grows with the texel size; the maps themselves are rendered with
// slope-scaled depth bias.

float shadowTent(sampler2DShadow map, vec3 uvz, float texelUv) {
  float d = 0.5 * texelUv;
  float sum = texture(map, uvz + vec3(-d, -d, 0.0)) + texture(map, uvz + vec3(d, -d, 0.0)) +
              texture(map, uvz + vec3(-d, d, 0.0)) + texture(map, uvz + vec3(d, d, 0.0));
  return 0.25 * sum;
}

float shadowTent(sampler2DArrayShadow map, float layer, vec3 uvz) {
  float d = 0.5 / float(textureSize(map, 0).x);
  float sum =
      texture(map, vec4(uvz.xy + vec2(-d, -d), layer, uvz.z)) + texture(map, vec4(uvz.xy + vec2(d, -d), layer, uvz.z)) +
      texture(map, vec4(uvz.xy + vec2(-d, d), layer, uvz.z)) + texture(map, vec4(uvz.xy + vec2(d, d), layer, uvz.z));
  return 0.25 * sum;
}
