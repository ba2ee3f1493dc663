// The visible fraction of a light, from four bilinear depth comparisons that form a 3x3 tent filter. The receiver is
// first moved along its normal by a distance that grows with the texel size. Each comparison takes the depth of the
// receiver's plane at its own place: `slope` is that plane's d(depth)/d(u, v). Without it (0) the map itself must be
// rendered with slope-scaled depth bias.

float shadowTent(sampler2DShadow map, vec3 uvz, vec2 slope, float texelUv) {
  float d = 0.5 * texelUv, along = d * (slope.x + slope.y), across = d * (slope.x - slope.y);
  float sum = texture(map, uvz - vec3(d, d, along)) + texture(map, uvz + vec3(d, -d, across)) +
              texture(map, uvz - vec3(d, -d, across)) + texture(map, uvz + vec3(d, d, along));
  return 0.25 * sum;
}

float shadowTent(sampler2DArrayShadow map, float layer, vec3 uvz, vec2 slope) {
  float d = 0.5 / float(textureSize(map, 0).x), along = d * (slope.x + slope.y), across = d * (slope.x - slope.y);
  float sum = texture(map, vec4(uvz.xy + vec2(-d, -d), layer, uvz.z - along)) +
              texture(map, vec4(uvz.xy + vec2(d, -d), layer, uvz.z + across)) +
              texture(map, vec4(uvz.xy + vec2(-d, d), layer, uvz.z - across)) +
              texture(map, vec4(uvz.xy + vec2(d, d), layer, uvz.z + along));
  return 0.25 * sum;
}
