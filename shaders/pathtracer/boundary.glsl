// Tracks which closed boundaries contain the path, and derives the medium and refractive index at its position.
//
// Where closed dielectrics overlap, the one with the highest priority applies [SchmidtBudge2002]. Materials that bound
// something are ranked by priority; a path counts its entries by rank, 4 bits each. Counts need no order, hold any
// nesting and never overflow: a boundary crossed below a higher one changes nothing but its count. A boundary with
// Bsdf::none holds a medium but has no index of its own: the index of the surrounding dielectric applies.
#include "shared/media.h"

layout(std430, binding = 7) restrict readonly buffer InteriorBlock { InteriorRecord interiors[]; };  // by rank
uniform int outerMedium;         // where the path is outside all boundaries
uniform uvec4 dielectricRanks;   // 15 in the counts of ranks that are dielectrics

// The highest rank with a nonzero count, or -1.
int topRank(uvec4 inside) {
  ivec4 bit = findMSB(inside);
  if (bit.w >= 0) return 24 + (bit.w >> 2);
  if (bit.z >= 0) return 16 + (bit.z >> 2);
  if (bit.y >= 0) return 8 + (bit.y >> 2);
  return bit.x >= 0 ? bit.x >> 2 : -1;
}

int mediumInside(uvec4 inside) {
  int rank = topRank(inside);
  return rank < 0 ? outerMedium : interiors[rank].medium;
}

float iorInside(uvec4 inside) {
  int rank = topRank(inside & dielectricRanks);
  return rank < 0 ? 1.0 : interiors[rank].ior;
}

bool isInsideOf(uvec4 inside, int rank) { return ((inside[rank >> 3] >> (4 * (rank & 7))) & 15u) != 0u; }

// The counts after crossing the boundary of a rank. False if it is left without having been entered (an open or flipped
// mesh) or entered for the sixteenth time; the counts then stay unchanged.
bool crossBoundary(inout uvec4 inside, int rank, bool entering) {
  int word = rank >> 3, shift = 4 * (rank & 7);
  uint count = (inside[word] >> shift) & 15u;
  if (count == (entering ? 15u : 0u)) return false;
  inside[word] += (entering ? 1u : 0xffffffffu) << shift;
  return true;
}
