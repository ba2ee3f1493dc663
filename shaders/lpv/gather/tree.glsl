// A hierarchy over the texels of a reflective shadow map: level 0 the texels, each further level a node for 2x2 of the
// one before, up to at most TREE_TOP nodes a side. A node stands for what it holds: mean position and normal weighted
// by flux, how far its texels lie from there, area and flux of all, and the texel nearest to the mean.
// TREE_TEXELS texels a node: position, radius (negative: nothing is lit); normal (the mean's length is below 1 where
// surfaces turn), area; flux, texel x | y << 16.
#define TREE_TEXELS 3
uniform int treeSize;    // texels a side
uniform int treeLayers;  // of the map: 1, or the faces of a cube
uniform int treeLevels;  // the coarsest level's number, at least 1

int treeWidth(int level) { return (treeSize + (1 << level) - 1) >> level; }

// Of a level's first node.
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
