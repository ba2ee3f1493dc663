// The ray caster's node as written by C++ and read by GLSL. See engine/pathtracer/README.md, section "Ray casting".
#pragma once
#include "shared/types.h"

SHARED_BEGIN

#define BVH_WIDTH 8
#define BVH_NODE_TEXELS 5                // of 16 bytes each
#define BVH_TRIANGLE_TEXELS 3
#define BVH_MAX_DEPTH 32                 // depth of the deepest node: the size of a traversal stack
#define BVH_MAX_LEAF 3                   // triangles
#define BVH_TRIANGLE_MASKED 0x80000000u    // in BvhTriangle::id: the material has an alpha mask
#define BVH_TRIANGLE_EMISSIVE 0x40000000u  // it emits light
#define BVH_TRIANGLE_AXIS_SHIFT 28         // two bits: the longest axis of the normal
#define BVH_TRIANGLE_ID_MASK 0x0fffffffu

// Eight boxes on a grid of 256 steps per axis, in 80 bytes [Ylitie2017]. Byte k of a pair of words belongs to child k.
struct BvhNode {
  vec3 origin;          // of the grid
  // bytes 0..2: the biased exponents of the grid steps along x, y, z; byte 3: bit k is set if child k is a node
  uint exponents;
  uint firstChild;      // child nodes are contiguous, in the order of k
  uint firstTriangle;   // so are the triangles of the children that are leaves
  // one byte per child. Node: 1 << 5 | 24 + k. Leaf: one bit per triangle << 5 | its first triangle, counted from
  // firstTriangle. None: 0
  uint meta[2];
  uint low[6];          // in grid steps: x 0..3, x 4..7, y ..., z ...
  uint high[6];
};

struct BvhTriangle {
  vec3 a;
  uint id;       // the scene's triangle, the flags and the axis
  vec3 b;
  float normal1;  // the normal's components along the next two axes, over that along the longest
  vec3 c;
  float normal2;
};

SHARED_END
