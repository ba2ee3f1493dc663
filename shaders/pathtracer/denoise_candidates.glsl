// The candidates of a pixel in both halves, and what they change in the mean of both. Needs denoise.glsl.
layout(binding = 4) uniform sampler2D narrow;
layout(binding = 5) uniform sampler2D wide;
layout(binding = 6) uniform sampler2D coloured;
layout(binding = 7) uniform sampler2D far;

const int kCandidates = 4;  // far, wide, coloured, despeckled

struct Candidates {
  vec3 raw, half0, half1;   // means of both and of each
  float share, product;     // of the first half in the whole; that times the second's
  vec3 change[kCandidates];      // of the mean of both
  vec3 difference[kCandidates];  // between the halves
};

Candidates candidatesAt(ivec2 pixel) {
  Half a = halfAt(pixel, 0), b = halfAt(pixel, 1);
  Candidates c;
  c.half0 = a.mean, c.half1 = b.mean;
  c.share = shareOf(a.samples, b.samples);
  c.product = c.share * (1.0 - c.share);
  c.raw = mix(b.mean, a.mean, c.share);
  vec4 wide0 = texelFetch(wide, inHalf(pixel, 0), 0), wide1 = texelFetch(wide, inHalf(pixel, 1), 0);
  vec3 narrow0 = texelFetch(narrow, inHalf(pixel, 0), 0).xyz, narrow1 = texelFetch(narrow, inHalf(pixel, 1), 0).xyz;
  vec3 first[kCandidates], second[kCandidates];
  first[0] = texelFetch(far, inHalf(pixel, 0), 0).xyz;
  second[0] = texelFetch(far, inHalf(pixel, 1), 0).xyz;
  first[1] = wide0.xyz, second[1] = wide1.xyz;
  first[2] = texelFetch(coloured, inHalf(pixel, 0), 0).xyz;
  second[2] = texelFetch(coloured, inHalf(pixel, 1), 0).xyz;
  // The values of a pixel's half whose variance stands out become the narrow ones.
  first[3] = mix(a.mean, narrow0, wide0.w), second[3] = mix(b.mean, narrow1, wide1.w);
  for (int i = 0; i < kCandidates; ++i) {
    c.change[i] = mix(second[i], first[i], c.share) - c.raw;
    c.difference[i] = first[i] - second[i];
  }
  return c;
}

// A pixel's terms of the squared error of raw + sum l_i change_i, which is
//   variance + 2 sum l_i c_i + sum l_i l_j G_ij,
// each without bias whatever the noise, as the halves are independent: with s the share, D the difference of the halves
// and D_i that of candidate i in them, variance = s (1 - s) D^2, c_i = -s (1 - s) D (D - D_i), and G_ij is change_i
// times change_j.
struct Terms {
  float variance;
  vec4 c;
  mat4 g;
};

Terms termsOf(Candidates candidates, vec3 weights) {
  Terms t;
  vec3 between = candidates.half0 - candidates.half1, weighted = candidates.product * weights * between;
  t.variance = dot(weighted, between);
  for (int i = 0; i < kCandidates; ++i) {
    t.c[i] = -dot(weighted, between - candidates.difference[i]);
    for (int j = 0; j < kCandidates; ++j) t.g[i][j] = dot(weights * candidates.change[i], candidates.change[j]);
  }
  return t;
}
