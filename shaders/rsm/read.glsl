// The sun's reflective shadow map as the gathering passes read it: everything that depends on how it is stored is in here. Edges and
// projection are those of parallel light; a perspective light's map cannot be read with this.
#include "lib/frame.glsl"
layout(binding = 0) uniform sampler2DArray rsmPosition;
layout(binding = 1) uniform sampler2DArray rsmNormal;
layout(binding = 2) uniform sampler2DArray rsmFlux;

// A texel: a virtual point light, and the surfel that it stands for.
struct RsmSurfel {
  vec3 position;
  vec3 normal;  // unit, on the side that the light sees
  vec3 flux;    // reflected, W
  float area;   // of the surface, scene units squared; cut off at 20 times the texel's
  float near2;  // squared distance below which the surfel is no point: twice the sum of its outline's squared edges
  bool lit;     // false: background, or nothing is reflected
};

ivec2 rsmSize() { return textureSize(rsmPosition, 0).xy; }

// Edges of a texel across the rays: the rows of an orthographic light's matrix are its axes, over half its extent.
void rsmTexelEdges(out vec3 u, out vec3 v) {
  mat4 clip = frame.sunClipFromWorld;
  vec3 right = vec3(clip[0][0], clip[1][0], clip[2][0]), up = vec3(clip[0][1], clip[1][1], clip[2][1]);
  u = right * (2.0 / (float(rsmSize().x) * dot(right, right)));
  v = up * (2.0 / (float(rsmSize().y) * dot(up, up)));
}

RsmSurfel rsmSurfel(ivec2 texel) {
  vec4 position = texelFetch(rsmPosition, ivec3(texel, 0), 0);
  vec4 normal = texelFetch(rsmNormal, ivec3(texel, 0), 0);
  vec4 flux = texelFetch(rsmFlux, ivec3(texel, 0), 0);  // w: area
  float cosine = max(normal.w, 0.05);
  vec3 u, v;
  rsmTexelEdges(u, v);
  return RsmSurfel(position.xyz, normal.xyz, flux.rgb, flux.w, (dot(u, u) + dot(v, v)) * (1.0 + 1.0 / (cosine * cosine)),
                   position.w > 0.5 && flux.r + flux.g + flux.b > 0.0);
}

// Where a point lies in the map: 0..1 inside.
vec2 rsmProject(vec3 position) { return 0.5 * (frame.sunClipFromWorld * vec4(position, 1.0)).xy + 0.5; }

// The surfel's outline: the texel's, projected along the light onto the surfel's plane, so that the surfels of neighbouring texels
// tile a flat surface without gap or overlap. `u` and `v` are its edges: a parallelogram of the area texelArea / cosine.
void rsmSurfelEdges(RsmSurfel surfel, out vec3 u, out vec3 v) {
  rsmTexelEdges(u, v);
  vec3 slope = surfel.normal / max(-dot(surfel.normal, frame.sunDirection), 0.05);
  u += frame.sunDirection * dot(slope, u);
  v += frame.sunDirection * dot(slope, v);
}
