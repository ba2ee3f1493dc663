// Where a sample of a pixel meets the film, by the picture's filter. Needs the path constants and rays/random.glsl.
#if PIXEL_FILTER > 1
float filterQuantile(int node) { return tracer.filterQuantiles[node >> 2][node & 3]; }

// In pixels from the pixel's centre; share: of the filter below it.
float filterOffset(float share) {
  float place = acos(1.0 - 2.0 * share) * (63.0 / kPi);
  int node = clampedInt(place, 0, 62);
  return mix(filterQuantile(node), filterQuantile(node + 1), place - float(node));
}
#endif

// In pixels from the picture's lower left corner.
vec2 filmPlace(ivec2 pixel, PathNumbers numbers) {
  vec2 place = vec2(pixel);  // PIXEL_FILTER: 0 through centres, 1 box, 2 by quantiles
#if PIXEL_FILTER == 0
  place += 0.5;
#else
  vec2 share = randomPair(numbers, 0u, kPurposeFilm);
#if PIXEL_FILTER == 1
  place += share;
#else
  place += 0.5 + vec2(filterOffset(share.x), filterOffset(share.y));
#endif
#endif
  return place;
}
