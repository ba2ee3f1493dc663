// Emissive surfaces that are small beside the cells of records. Needs irradiance_cache/common.glsl.

// Whether one is so close that its light changes within a cell, so that records do not represent it. On a plane at a
// distance d it is I d / r^3, whose curvature within a cell is a share of about (cell / d)^2.
bool isNearSmallLamp(vec3 position, float cell) {
  // ends: at most CACHE_MOST_SMALL_LAMPS
  for (uint i = 0u; i < min(cache.smallLamps, uint(CACHE_MOST_SMALL_LAMPS)); ++i) {
    vec4 lamp = cache.smallLamp[i];
    if (lamp.w < cell && distance(position, lamp.xyz) - lamp.w < CACHE_CELLS_NEAR_LAMP * cell) return true;
  }
  return false;
}
