// One bounce more at the points that keep light of further bounces: their own irradiance, and that of the points that
// their rays have met, times the albedo there (hemisphere.comp). One invocation per point.
layout(local_size_x = 64) in;
#include "shared/irradiance_cache.h"
layout(std430, binding = CACHE_RECORDS_BUFFER) readonly restrict buffer CacheRecords { CacheRecord records[]; };
layout(std430, binding = CACHE_LINKS_BUFFER) readonly restrict buffer BounceLinks { uint links[]; };
layout(std430, binding = CACHE_BOUNCED_BUFFER) writeonly restrict buffer BouncedLight { vec4 bounced[]; };
layout(binding = UNIT_CACHE_BOUNCED) uniform samplerBuffer bouncedLight;
uniform uint points;
uniform bool first;  // only their own

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= points) return;
  vec3 sum = vec3(0.0);
  if (!first)
    for (uint i = 0u; i < uint(CACHE_LANES); ++i) {
      uint link = 3u * (index * uint(CACHE_LANES) + i), point = links[link];
      if (point == 0u) continue;
      uint redGreen = links[link + 1u];
      vec3 albedo = vec3(float(redGreen & 0xffffu), float(redGreen >> 16u), float(links[link + 2u])) / 65535.0;
      sum += albedo * texelFetch(bouncedLight, int(point) - 1).rgb;
    }
  bounced[index] = vec4(records[index].irradiance + sum / float(CACHE_LANES), 0.0);
}
