// Fraction of a light that is seen: four bilinear depth comparisons, which make a 3x3 tent. A receiver is moved along
// its normal first by a length that grows with the shadow map's texels; in the maps themselves depth is offset by
// slope.

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
