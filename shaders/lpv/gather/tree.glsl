// A hierarchy over the texels of a reflective shadow map. Level 0 is the texels; each further level has one node per
// 2x2 nodes of the level below, up to at most TREE_TOP nodes per side at the top. A node stores a summary of its
// texels: flux-weighted mean position and normal, the radius around that position, total area and flux, and the texel
// nearest to the mean.
// TREE_TEXELS texels per node: position, radius (negative: nothing is lit); normal (shorter than 1 where the normals
// vary), area; flux, texel x | y << 16.
#define TREE_TEXELS 3
uniform int treeSize;    // texels a side
uniform int treeLayers;  // of the map: 1, or the faces of a cube
uniform int treeLevels;  // the coarsest level's number, at least 1

int treeWidth(int level) { return (treeSize + (1 << level) - 1) >> level; }

// Index of a level's first node.
int treeFirst(int level) {
  int first = 0;
  for (int k = 1; k < level; ++k) first += treeLayers * treeWidth(k) * treeWidth(k);
  return first;
}

int treeNode(int level, int layer, ivec2 place) {
  int width = treeWidth(level);
  return TREE_TEXELS * (treeFirst(level) + (layer * width + place.y) * width + place.x);
}

struct LightNode {
  vec3 position;
  float radius;
  vec3 normal;
  float area;
  vec3 flux;
  uint texel;
};
