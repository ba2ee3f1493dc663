// The ray caster's buffers: a header and nodes in one, triangles in the other. See engine/pathtracer/README.md, section "Ray casting".
#pragma once
#include "shared/types.h"

SHARED_BEGIN

#define BVH_MAX_DEPTH 48                 // of the deepest leaf; what a traversal stack holds
#define BVH_LEAF 0x80000000u             // a child that is a leaf: this, (count - 1) << 27, and its first triangle
#define BVH_LEAF_COUNT_SHIFT 27
#define BVH_LEAF_FIRST_MASK 0x07ffffffu
#define BVH_TRIANGLE_MASKED 0x80000000u  // in BvhTriangle::id: cut out by an alpha mask
#define BVH_TRIANGLE_ID_MASK 0x7fffffffu

// Two boxes and what is in them. A child that is missing has an empty box.
struct BvhNode {
  vec3 minimum0;
  uint child0;  // index of a node, or a leaf
  vec3 maximum0;
  uint child1;
  vec3 minimum1;
  float padding0;
  vec3 maximum1;
  float padding1;
};

struct BvhTriangle {
  vec3 a;
  uint id;  // the scene's triangle, and whether it is masked
  vec3 b;
  float padding0;
  vec3 c;
  float padding1;
};

struct BvhHeader {
  float magnitude;  // of the largest coordinate
  float padding0;
  float padding1;
  float padding2;
};

SHARED_END
