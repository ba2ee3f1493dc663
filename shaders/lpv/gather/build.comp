// Builds one level of the hierarchy over a reflective shadow map (tree.glsl) from the level below. FROM_TEXELS: the
// first level, from the map itself. MEAN_AREA: a node's area is its texels' mean, else their sum.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/bindings.h"
#include "lpv/gather/tree.glsl"
#include "lib/finite.glsl"
#if FROM_TEXELS
layout(binding = UNIT_RSM_POSITION) uniform sampler2DArray rsmPosition;
layout(binding = UNIT_RSM_NORMAL) uniform sampler2DArray rsmNormal;
layout(binding = UNIT_RSM_FLUX) uniform sampler2DArray rsmFlux;
layout(std430, binding = 0) writeonly restrict buffer Nodes { uvec4 nodes[]; };
#else
layout(std430, binding = 0) restrict buffer Nodes { uvec4 nodes[]; };
#endif
uniform int level;

LightNode child(int layer, ivec2 place) {
#if FROM_TEXELS
  vec4 position = texelFetch(rsmPosition, ivec3(place, layer), 0), flux = texelFetch(rsmFlux, ivec3(place, layer), 0);
  vec3 normal = texelFetch(rsmNormal, ivec3(place, layer), 0).xyz;
  bool lit = position.w > 0.5 && flux.r + flux.g + flux.b > 0.0 && allFinite(position.xyz) && allFinite(normal) &&
             allFinite(flux.rgb);
  return LightNode(position.xyz, lit ? 0.0 : -1.0, normal, flux.w, flux.rgb, uint(place.x) | uint(place.y) << 16u);
#else
  int at = treeNode(level - 1, layer, place);
  uvec4 a = nodes[at], b = nodes[at + 1], c = nodes[at + 2];
  return LightNode(uintBitsToFloat(a.xyz), uintBitsToFloat(a.w), uintBitsToFloat(b.xyz), uintBitsToFloat(b.w),
                   uintBitsToFloat(c.xyz), c.w);
#endif
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  int width = treeWidth(level), below = treeWidth(level - 1);
  if (at.x >= width || at.y >= width) return;
  LightNode sum = LightNode(vec3(0.0), -1.0, vec3(0.0), 0.0, vec3(0.0), 0u);
  LightNode children[4];
  float weights = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 place = 2 * at.xy + ivec2(i & 1, i >> 1);
    children[i].radius = -1.0;
    if (place.x >= below || place.y >= below) continue;
    children[i] = child(at.z, place);
    if (children[i].radius < 0.0) continue;
    float weight = children[i].flux.r + children[i].flux.g + children[i].flux.b;
    sum.position += weight * children[i].position;
    sum.normal += weight * children[i].normal;
#if MEAN_AREA
    sum.area += weight * children[i].area;
#else
    sum.area += children[i].area;
#endif
    sum.flux += children[i].flux;
    weights += weight;
  }
  if (weights > 0.0) {
    sum.position /= weights;
    sum.normal /= weights;
#if MEAN_AREA
    sum.area /= weights;
#endif
    float nearest = 3.0e38;
    for (int i = 0; i < 4; ++i) {
      if (children[i].radius < 0.0) continue;
      float away = distance(children[i].position, sum.position);
      sum.radius = max(sum.radius, away + children[i].radius);
      if (away < nearest) {
        nearest = away;
        sum.texel = children[i].texel;
      }
    }
  }
  int node = treeNode(level, at.z, at.xy);
  nodes[node] = uvec4(floatBitsToUint(sum.position), floatBitsToUint(sum.radius));
  nodes[node + 1] = uvec4(floatBitsToUint(sum.normal), floatBitsToUint(sum.area));
  nodes[node + 2] = uvec4(floatBitsToUint(sum.flux), sum.texel);
}
