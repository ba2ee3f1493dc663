// The patches that later passes of raster visit, by hemicube. Each hemicube has as many entries as there are patches:
// from the front those of one pixel (hemicube_points.comp), from the back those to walk over (hemicube_depth.comp).
layout(std430, binding = 0) buffer PatchLists {
  uint listLengths[512];  // of kPoints, of kWalks
  uint patches[];
};
const int kPoints = 0, kWalks = 256;

int pointEntry(int hemicube, int slot) { return hemicube * patchCount + slot; }
int walkEntry(int hemicube, int slot) { return (hemicube + 1) * patchCount - 1 - slot; }
