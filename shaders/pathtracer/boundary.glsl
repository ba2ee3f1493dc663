// Which closed boundaries a path is inside of, and what that makes of the place: its medium and its index of
// refraction.
//
// Where closed dielectrics overlap the one of the highest priority is there [SchmidtBudge2002]. Materials that bound
// something are ranked by priority; a path counts its entries by rank, 4 bits each. Counts need no order, hold any
// nesting and never overflow: a boundary crossed below a higher one changes nothing but its count. A boundary of
// Bsdf::none holds a medium, but no index of its own: the dielectric around it keeps its own.
#include "shared/media.h"

layout(std430, binding = 7) restrict readonly buffer InteriorBlock { InteriorRecord interiors[]; };  // by rank
uniform int outerMedium;         // where the path is inside of nothing
uniform uvec4 dielectricRanks;   // 15 in the counts of dielectrics

// The highest rank with a count, -1 without.
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

// After crossing the boundary of a rank. False where it is left without having been entered (an open or turned mesh),
// or entered for the sixteenth time: the counts stay as they are then.
bool crossBoundary(inout uvec4 inside, int rank, bool entering) {
  int word = rank >> 3, shift = 4 * (rank & 7);
  uint count = (inside[word] >> shift) & 15u;
  if (count == (entering ? 15u : 0u)) return false;
  inside[word] += (entering ? 1u : 0xffffffffu) << shift;
  return true;
}
