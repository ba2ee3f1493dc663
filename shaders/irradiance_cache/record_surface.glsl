// A record's surface, on the side that the record is on. Needs rays/materials.glsl and irradiance_cache/common.glsl.
Surface surfaceOf(CacheRecord record) {
  vec3 normal = normalOf(record.triangle);
  return surfaceAt(record.triangle, vec2(record.second, record.third),
                   (record.state & CACHE_FRONT) != 0u ? -normal : normal);
}
