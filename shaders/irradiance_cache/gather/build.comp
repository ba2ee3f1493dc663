// Builds the nodes of one depth of the hierarchy over a reflective shadow map (tree.glsl) from their children.
// FROM_TEXELS: the children are the map's texels, and are written too. MEAN_AREA: a node's area is its texels' mean,
// else their sum.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/bindings.h"
#include "shared/irradiance_cache.h"
#include "irradiance_cache/gather/tree.glsl"
#include "lib/finite.glsl"
#if FROM_TEXELS
layout(binding = UNIT_RSM_POSITION) uniform sampler2DArray rsmPosition;
layout(binding = UNIT_RSM_NORMAL) uniform sampler2DArray rsmNormal;
layout(binding = UNIT_RSM_FLUX) uniform sampler2DArray rsmFlux;
layout(std430, binding = CACHE_NODES_BUFFER) writeonly restrict buffer Nodes { uvec4 nodes[]; };
#else
layout(std430, binding = CACHE_NODES_BUFFER) restrict buffer Nodes { uvec4 nodes[]; };
#endif
uniform int depth;

void write(uint index, LightNode node) {
  uint at = TREE_TEXELS * index;
  packNode(node, nodes[at], nodes[at + 1u], nodes[at + 2u]);
}

// The child with this number in the layer, whose first node is `layerStart`.
LightNode child(uint layerStart, uint number, ivec3 place) {
#if FROM_TEXELS
  LightNode leaf = kUnlit;
  if (place.x < treeSize && place.y < treeSize) {
    vec4 position = texelFetch(rsmPosition, place, 0), flux = texelFetch(rsmFlux, place, 0);
    vec3 normal = texelFetch(rsmNormal, place, 0).xyz;
    if (position.w > 0.5 && flux.r + flux.g + flux.b > 0.0 && allFinite(position.xyz) && allFinite(normal) &&
        allFinite(flux.rgb))
      leaf = LightNode(position.xyz, 0.0, normal, vec3(0.0), vec3(0.0), flux.w, flux.rgb);
  }
  write(layerStart + number, leaf);
  return leaf;
#else
  uint at = TREE_TEXELS * (layerStart + number);
  return unpackNode(nodes[at], nodes[at + 1u], nodes[at + 2u]);
#endif
}

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (at.x >= 1 << depth || at.y >= 1 << depth) return;
  uint layerStart = uint(at.z) * treeNodesOfLayer(), number = treeFirst(depth) + mortonOf(at.xy);
  LightNode sum = kUnlit;
  LightNode children[4];
  float weights = 0.0;
  for (int i = 0; i < 4; ++i) {
    children[i] = child(layerStart, 4u * number + 1u + uint(i), ivec3(2 * at.xy + ivec2(i & 1, i >> 1), at.z));
    if (children[i].radius < 0.0) continue;
    float weight = children[i].flux.r + children[i].flux.g + children[i].flux.b;
    vec3 n = children[i].normal;
    sum.position += weight * children[i].position;
    sum.normal += weight * n;
    // Second moments, for now.
    sum.variances += weight * (children[i].variances + n * n);
    sum.covariances += weight * (children[i].covariances + vec3(n.x * n.y, n.x * n.z, n.y * n.z));
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
    vec3 n = sum.normal;
    sum.variances = sum.variances / weights - n * n;
    sum.covariances = sum.covariances / weights - vec3(n.x * n.y, n.x * n.z, n.y * n.z);
#if MEAN_AREA
    sum.area /= weights;
#endif
    for (int i = 0; i < 4; ++i)
      if (children[i].radius >= 0.0)
        sum.radius = max(sum.radius, distance(children[i].position, sum.position) + children[i].radius);
  }
  write(layerStart + number, sum);
}
