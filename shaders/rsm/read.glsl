// A light's reflective shadow map as the gathering passes read it. Everything that depends on its storage format is
// here.
// MAP_LIGHT tells the kind of light, which determines the texels' edges and solid angles and the mapping of directions.
#include "shared/bindings.h"
#include "lib/clamped_int.glsl"
#include "lib/frame.glsl"
#define MAP_SUN 0
#define MAP_SPOT 1
#define MAP_POINT 2
layout(binding = UNIT_RSM_POSITION) uniform sampler2DArray rsmPosition;
layout(binding = UNIT_RSM_NORMAL) uniform sampler2DArray rsmNormal;
layout(binding = UNIT_RSM_FLUX) uniform sampler2DArray rsmFlux;
#if MAP_LIGHT != MAP_SUN
uniform vec3 lightPlace;
uniform mat4 clipFromPlace[MAP_LIGHT == MAP_POINT ? 6 : 1];  // of positions relative to lightPlace
uniform float texelWidth;                                    // at depth 1
#endif

// A texel: a virtual point light, and the surfel that it represents.
struct RsmSurfel {
  vec3 position;
  vec3 normal;  // unit, on the side that the light sees
  vec3 flux;    // reflected, W
  float area;   // of the surface, scene units squared; at most 20 times the texel's area
  float across; // the texel's area across the rays; sun: 1, since it is the same for all
  float near2;  // below this squared distance it is no point: twice the sum of its outline's squared edges
  bool lit;     // false: background, or nothing is reflected
  int layer;
};

ivec2 rsmSize() { return textureSize(rsmPosition, 0).xy; }

#if MAP_LIGHT == MAP_SUN
// Edges of a texel across the rays. The rows of an orthographic light's matrix are its axes divided by half its extent.
void rsmTexelEdges(out vec3 u, out vec3 v) {
  mat4 clip = frame.sunClipFromWorld;
  vec3 right = vec3(clip[0][0], clip[1][0], clip[2][0]), up = vec3(clip[0][1], clip[1][1], clip[2][1]);
  u = right * (2.0 / (float(rsmSize().x) * dot(right, right)));
  v = up * (2.0 / (float(rsmSize().y) * dot(up, up)));
}
vec3 rsmRay(vec3 position) { return frame.sunDirection; }
#else
// Edges of a texel at a point's depth in a view's frustum: parallel to the view's axes; their length grows with depth.
void rsmTexelEdges(int layer, vec3 position, out vec3 u, out vec3 v) {
  mat4 clip = clipFromPlace[layer];
  vec3 right = vec3(clip[0][0], clip[1][0], clip[2][0]), up = vec3(clip[0][1], clip[1][1], clip[2][1]),
       forward = vec3(clip[0][3], clip[1][3], clip[2][3]);
  float width = texelWidth * max(dot(position - lightPlace, normalize(forward)), 0.0);
  u = normalize(right) * width;
  v = normalize(up) * width;
}
vec3 rsmRay(vec3 position) { return normalize(position - lightPlace); }
#endif

// The surfel's outline: the texel's, projected along the light onto the surfel's plane, so that the surfels of
// neighbouring texels tile a flat surface without gap or overlap. `u` and `v` are its edges; for the sun it is a
// parallelogram of the area texelArea / cosine.
void rsmSurfelEdges(RsmSurfel surfel, out vec3 u, out vec3 v) {
#if MAP_LIGHT == MAP_SUN
  rsmTexelEdges(u, v);
#else
  rsmTexelEdges(surfel.layer, surfel.position, u, v);
#endif
  vec3 ray = rsmRay(surfel.position);
  vec3 slope = surfel.normal / max(-dot(surfel.normal, ray), 0.05);
  u += ray * dot(slope, u);
  v += ray * dot(slope, v);
}

RsmSurfel rsmSurfel(ivec3 texel) {
  vec4 position = texelFetch(rsmPosition, texel, 0);
  vec4 normal = texelFetch(rsmNormal, texel, 0);
  vec4 flux = texelFetch(rsmFlux, texel, 0);  // w: area
  float cosine = max(normal.w, 0.05);
  RsmSurfel surfel = RsmSurfel(position.xyz, normal.xyz, flux.rgb, flux.w, 1.0, 0.0, false, texel.z);
  surfel.lit = (position.w > 0.5 && flux.r + flux.g + flux.b > 0.0);
  vec3 u, v;
#if MAP_LIGHT == MAP_SUN
  rsmTexelEdges(u, v);
  surfel.near2 = (dot(u, u) + dot(v, v)) * (1.0 + 1.0 / (cosine * cosine));
#else
  surfel.across = flux.w * cosine;
  rsmSurfelEdges(surfel, u, v);
  surfel.near2 = 2.0 * (dot(u, u) + dot(v, v));
#endif
  return surfel;
}

#if MAP_LIGHT == MAP_SUN
// Projects a point into the map: 0..1 inside.
vec2 rsmProject(vec3 position) { return 0.5 * (frame.sunClipFromWorld * vec4(position, 1.0)).xy + 0.5; }
#elif MAP_LIGHT == MAP_SPOT
// The same, clamped to the nearest position in the map; the middle for points behind the lamp.
vec2 rsmProject(vec3 position) {
  vec4 clip = clipFromPlace[0] * vec4(position - lightPlace, 1.0);
  return clip.w > 0.0 ? clamp(0.5 * clip.xy / clip.w + 0.5, 0.0, 1.0) : vec2(0.5);
}
#else
// The texel that contains a direction from the lamp, and its solid angle (rsm.frag).
ivec3 rsmTexel(vec3 direction, out float solidAngle) {
  vec4 clip = vec4(0.0);
  int layer = 0;
  for (int face = 0; face < 6; ++face) {
    vec4 c = clipFromPlace[face] * vec4(direction, 0.0);
    if (c.w > clip.w) {
      clip = c;
      layer = face;
    }
  }
  ivec2 size = rsmSize(), texel = clampedInt(floor((0.5 * clip.xy / clip.w + 0.5) * vec2(size)), ivec2(0), size - 1);
  vec2 atDepth1 = (vec2(texel) + 0.5 - 0.5 * vec2(size)) * texelWidth;
  float cosAxis = inversesqrt(1.0 + dot(atDepth1, atDepth1));
  solidAngle = texelWidth * texelWidth * cosAxis * cosAxis * cosAxis;
  return ivec3(texel, layer);
}
#endif
