// A hierarchy over the texels of a reflective shadow map: per layer of the map a complete quadtree, its nodes numbered
// like a heap. The root is 0, the children of i are 4 i + 1 to 4 i + 4, so nodes of one depth follow a Morton curve.
// The texels are the leaves; maps whose side is not a power of two have leaves without light. A node stores a summary
// of its texels: flux-weighted mean position and normal, the normals' covariance, the radius around that position, area
// and flux.
// TREE_TEXELS texels per node, 16-bit numbers in pairs:
//   position, radius (negative: nothing is lit; of a leaf 0);
//   mean normal x y, z and covariance xx, yy xy, xz yz (zz follows, since normals are of unit length);
//   area, sum of the flux's channels, red and green share of it, nothing.
#define TREE_TEXELS 3
#include "lib/morton.glsl"
uniform int treeSize;    // texels a side of the map
uniform int treeLayers;  // of the map: 1, or the faces of a cube
uniform int treeDepth;   // of the leaves: 2^treeDepth is at least treeSize
uniform int treeTop;     // depth of the coarsest nodes that are built

// The first node of a depth, in its layer.
uint treeFirst(int depth) { return ((1u << uint(2 * depth)) - 1u) / 3u; }
// Nodes of a layer.
uint treeNodesOfLayer() { return treeFirst(treeDepth + 1); }

// The texel of a leaf of its layer.
ivec2 texelOf(uint leaf) {
  uint code = leaf - treeFirst(treeDepth);
  return ivec2(int(gatherBits(code)), int(gatherBits(code >> 1u)));
}

struct LightNode {
  vec3 position;
  float radius;
  vec3 normal;  // mean, at most 1 long
  vec3 variances, covariances;  // xx yy zz; xy xz yz
  float area;
  vec3 flux;
};

const LightNode kUnlit = LightNode(vec3(0.0), -1.0, vec3(0.0), vec3(0.0), vec3(0.0), 0.0, vec3(0.0));

void packNode(LightNode node, out uvec4 a, out uvec4 b, out uvec4 c) {
  float sum = node.flux.r + node.flux.g + node.flux.b;
  a = uvec4(floatBitsToUint(node.position), floatBitsToUint(node.radius));
  b = uvec4(packSnorm2x16(node.normal.xy), packSnorm2x16(vec2(node.normal.z, node.variances.x)),
            packSnorm2x16(vec2(node.variances.y, node.covariances.x)), packSnorm2x16(node.covariances.yz));
  c = uvec4(floatBitsToUint(node.area), floatBitsToUint(sum),
            packUnorm2x16(sum > 0.0 ? node.flux.rg / sum : vec2(0.0)), 0u);
}

LightNode unpackNode(uvec4 a, uvec4 b, uvec4 c) {
  vec2 first = unpackSnorm2x16(b.x), second = unpackSnorm2x16(b.y), third = unpackSnorm2x16(b.z),
       share = unpackUnorm2x16(c.z);
  vec3 normal = vec3(first, second.x);
  float rest = max(1.0 - dot(normal, normal) - second.y - third.x, 0.0);
  return LightNode(uintBitsToFloat(a.xyz), uintBitsToFloat(a.w), normal, vec3(second.y, third.x, rest),
                   vec3(third.y, unpackSnorm2x16(b.w)), uintBitsToFloat(c.x),
                   uintBitsToFloat(c.y) * vec3(share, max(1.0 - share.x - share.y, 0.0)));
}

// The mean of max(0, <n, d>) over a node's normals n for a unit direction d:
//   (<m, d> + mean |<n, d>|) / 2, and mean |<n, d>| is at most sqrt(<m, d>^2 + d^T C d),
// m being the mean and C the covariance. Exact for one normal, and for two whose cosines are equal or opposite.
float meanCosine(LightNode node, vec3 d) {
  float mean = dot(node.normal, d), variance = dot(node.variances, d * d) +
                                               2.0 * dot(node.covariances, vec3(d.x * d.y, d.x * d.z, d.y * d.z));
  // Covariances are known to some 1e-4: below, a flat node's.
  return variance > 1e-3 ? 0.5 * (mean + sqrt(mean * mean + variance)) : max(mean, 0.0);
}
