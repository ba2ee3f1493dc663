// One point per texel of the reflective shadow map, no vertex buffer: the texel follows from gl_VertexID.
layout(binding = 0) uniform sampler2D rsmPosition;
layout(binding = 1) uniform sampler2D rsmNormal;
layout(binding = 2) uniform sampler2D rsmFlux;
out vec4 gPosition;  // world; w = 0: background
out vec4 gNormal;    // unit; w = cosine to the light
out vec3 gFlux;      // reflected flux of the texel

void main() {
  int width = textureSize(rsmPosition, 0).x;
  ivec2 texel = ivec2(gl_VertexID % width, gl_VertexID / width);
  gPosition = texelFetch(rsmPosition, texel, 0);
  gNormal = texelFetch(rsmNormal, texel, 0);
  gFlux = texelFetch(rsmFlux, texel, 0).rgb;
}
