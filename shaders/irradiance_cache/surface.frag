// Surfaces lit by the records around them too. Records are defined for the mesh's own normal.
#include "lib/frame.glsl"
#include "irradiance_cache/lookup.glsl"
#define INDIRECT 1
vec3 indirectIrradiance(vec3 position, vec3 normal, vec3 meshNormal) {
  bool found;
  return cachedIrradiance(position, meshNormal, found);
}
#if BEHIND_MEDIA
layout(binding = UNIT_REFLECTED) uniform sampler2D reflections;
// Alpha: whether the surface is seen, and not a cloud.
vec4 mediaInFront() {
  vec4 reflected = texelFetch(reflections, ivec2(gl_FragCoord.xy), 0);
  return vec4(reflected.rgb, reflected.a < 0.0 ? 0.0 : 1.0);
}
#elif INDIRECT_SPECULAR
#include "lib/coat.glsl"
layout(binding = UNIT_REFLECTED) uniform sampler2D reflections;
vec3 indirectSpecular(vec3 position, vec3 normal, vec3 toCamera, Coat coat) {
  return texelFetch(reflections, ivec2(gl_FragCoord.xy), 0).rgb;
}
#endif
#include "forward/surface.glsl"
