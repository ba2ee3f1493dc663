// One point per texel of the reflective shadow map, without a vertex buffer: gl_VertexID gives the texel.
#include "shared/bindings.h"
layout(binding = UNIT_RSM_POSITION) uniform sampler2DArray rsmPosition;
layout(binding = UNIT_RSM_NORMAL) uniform sampler2DArray rsmNormal;
layout(binding = UNIT_RSM_FLUX) uniform sampler2DArray rsmFlux;
out vec4 gPosition;  // world; w = 0: background
out vec4 gNormal;    // unit; w = cosine to the light
out vec4 gFlux;      // reflected flux of the texel; w = surface area in it
#if REFLECTS
layout(binding = UNIT_RSM_ALBEDO) uniform sampler2DArray rsmAlbedo;
out vec3 gAlbedo;
#endif

void main() {
  ivec2 size = textureSize(rsmPosition, 0).xy;
  int row = gl_VertexID / size.x;
  ivec3 texel = ivec3(gl_VertexID % size.x, row % size.y, row / size.y);
  gPosition = texelFetch(rsmPosition, texel, 0);
  gNormal = texelFetch(rsmNormal, texel, 0);
  gFlux = texelFetch(rsmFlux, texel, 0);
#if REFLECTS
  gAlbedo = texelFetch(rsmAlbedo, texel, 0).rgb;
#endif
}
