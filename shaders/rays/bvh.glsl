// Traces rays against the triangles of a RayScene (engine/rays/ray_scene.hpp): closest hit or any hit.
//
// Space: RayScene's (the world moved by -RayScene::origin()). Flag ALPHA_MASKS: the including file declares, before the
// include, `bool isCutOut(uint triangle, vec2 barycentrics)`, which is called for triangles with a masked material.
// Uses texture units 60 and 61.
// Lamps: a surface whose plane contains a shadow ray's end, within kLampGap, does not shade the lamp there. So a lamp
// in a ceiling's plane lights the room, and a narrow lamp does not shade itself. Where surfaces coincide, rays hit the
// one that emits light.
// Method: nodes of eight quantised boxes and their traversal order after [Ylitie2017], a watertight triangle test after
// [Woop2013], boxes widened by the rounding of their distances after [Ize2013]. Buffer textures are used because
// llvmpipe gathers from them three times as fast as from storage blocks.
#include "shared/bindings.h"
#include "shared/bvh.h"
#include "lib/finite.glsl"
#include "lib/float_pairs.glsl"

layout(binding = UNIT_BVH_NODES) uniform usamplerBuffer bvhNodes;      // BVH_NODE_TEXELS per BvhNode
// one texel with the magnitude, then BVH_TRIANGLE_TEXELS per BvhTriangle
layout(binding = UNIT_BVH_TRIANGLES) uniform usamplerBuffer bvhTriangles;

// no triangle: Hit::triangle of a ray that hit nothing, and skipTriangle if nothing is to be skipped
const uint kNoHit = 0xffffffffu;

struct Ray {
  vec3 origin;
  float tMin;      // hits lie at tMin < t < tMax
  vec3 direction;  // of any length above 0; t is in units of that length
  float tMax;
};

struct Hit {
  float t;
  uint triangle;      // index in the scene's order: its corners are indices[3 * triangle] and the next two
  vec2 barycentrics;  // weights of the second and third corner
};

// A ray prepared for traversal. For boxes: the inverse of the direction over a power of two, which makes its longest
// component 0.5 to 1, with components near zero replaced by 2^-60 of the longest, so that no distance is infinite up to
// coordinates of 2^64; and the direction's octant. For triangles: the ray's own space, in which it runs along z from
// the origin [Woop2013]: axes permuted so that z is the longest, then sheared.
struct BvhRay {
  vec3 origin;
  vec3 inverse;
  bvec3 negative;
  uint octant;  // 7 - octant, since child slots are counted down
  vec3 shear;
  bvec2 turn;
};

vec3 bvhTurn(vec3 v, bvec2 turn) { return turn.x ? v.yzx : turn.y ? v.zxy : v; }

// The power of two: distances to boxes are t times that.
float bvhBoxUnit(BvhRay r) { return inversePowerOfTwo(abs(r.shear.z)); }

BvhRay bvhPrepare(Ray ray) {
  vec3 d = ray.direction, a = abs(d);
  BvhRay r;
  r.origin = ray.origin;
  r.negative = lessThan(d, vec3(0.0));
  r.octant = 7u - ((r.negative.x ? 4u : 0u) | (r.negative.y ? 2u : 0u) | (r.negative.z ? 1u : 0u));
  r.turn = bvec2(a.x > a.y && a.x > a.z, a.y > a.z);
  vec3 p = bvhTurn(d, r.turn);
  r.shear = vec3(p.xy / p.z, 1.0 / p.z);
  d *= inversePowerOfTwo(bvhBoxUnit(r));
  float least = largestOf(d) * 8.67361738e-19;
  r.inverse = 1.0 / mix(d, mix(vec3(least), vec3(-least), r.negative), lessThan(abs(d), vec3(least)));
  return r;
}

// The greater and the less of two numbers that are not NaN; of two negative ones the other, so that boxes only grow.
// As integers: llvmpipe's max of floats takes three instructions, since it drops NaN.
float bvhGreater(float a, float b) { return intBitsToFloat(max(floatBitsToInt(a), floatBitsToInt(b))); }
float bvhLess(float a, float b) { return intBitsToFloat(min(floatBitsToInt(a), floatBitsToInt(b))); }
float bvhLargest(vec3 v) { return bvhGreater(abs(v.x), bvhGreater(abs(v.y), abs(v.z))); }

// Twice the area of (0, a, b) in the plane. Each product is rounded, but rounding is monotonic, so the sign is right or
// the area is zero. Neighbours see a shared edge with the same numbers, and zero counts as inside for both, so nothing
// passes between them.
float bvhEdge(precise vec2 a, precise vec2 b) {
  precise float ab = a.x * b.y;
  precise float ba = a.y * b.x;
  precise float area = ab - ba;
  return area;
}

// Distances below which a point lies in a plane, over the largest coordinate of the triangle and the ray's origin: 16
// roundings.
const float kLampGap = 9.5367431640625e-7;  // 2^-20

// The normal in the ray's own space; along its longest axis it is 1.
vec3 bvhPlane(uint id, vec2 others, bvec2 turn) {
  uint axis = (id >> BVH_TRIANGLE_AXIS_SHIFT) & 3u;
  vec3 n = vec3(1.0, others);
  return bvhTurn(axis == 1u ? n.zxy : axis == 2u ? n.yzx : n, turn);
}

// Whether the ray hits the triangle at tMin < t < tMax, and where. others: of its plane. t is that of the plane, since
// the ratios of edges are far off in slivers; emissive triangles are moved towards the ray's origin by the gap.
// lampEnd: t of the lamp that the ray goes to, or 3e38; slack: the origin's part of the gap, or negative for no gap.
bool bvhHitTriangle(BvhRay r, vec3 a, vec3 b, vec3 c, uint id, vec2 others, float tMin, float tMax, float lampEnd,
                    float slack, out float t, out vec2 barycentrics) {
  vec3 pa = bvhTurn(a - r.origin, r.turn), pb = bvhTurn(b - r.origin, r.turn), pc = bvhTurn(c - r.origin, r.turn);
  precise vec2 sa = pa.xy - r.shear.xy * pa.z;
  precise vec2 sb = pb.xy - r.shear.xy * pb.z;
  precise vec2 sc = pc.xy - r.shear.xy * pc.z;
  float u = bvhEdge(sc, sb), v = bvhEdge(sa, sc), w = bvhEdge(sb, sa);
  float area = u + v + w;
  float scale = 1.0 / area;
  barycentrics = vec2(v, w) * scale;
  vec3 n = bvhPlane(id, others, r.turn);
  float along = (dot(n.xy, r.shear.xy) + n.z) / r.shear.z, distance = dot(n, pa),
        largest = bvhGreater(bvhLargest(a), bvhGreater(bvhLargest(b), bvhLargest(c))),
        gap = slack < 0.0 ? 0.0 : kLampGap * bvhGreater(slack, largest);
  // a plane seen edge-on: within the corners
  vec3 z = vec3(pa.z, pb.z, pc.z) * r.shear.z;
  t = clamp(distance / along, min(z.x, min(z.y, z.z)), max(z.x, max(z.y, z.z)));
  bool met = !(min(u, min(v, w)) < 0.0 && max(u, max(v, w)) > 0.0) && area != 0.0 && t > tMin;
  if ((id & BVH_TRIANGLE_EMISSIVE) != 0u) t = max(t - gap / abs(along), tMin);
  return met && t < tMax && !(abs(distance - along * lampEnd) <= gap);
}

bool bvhMissesMask(uint id, vec2 barycentrics) {
#if ALPHA_MASKS
  return (id & BVH_TRIANGLE_MASKED) != 0u && isCutOut(id & BVH_TRIANGLE_ID_MASK, barycentrics);
#else
  return false;
#endif
}

// Index of the highest set bit of a number from 1 to 2^24 - 1.
int bvhHighest(uint bits) { return (floatBitsToInt(float(int(bits))) >> 23) - 127; }

ivec3 bvhChoose(ivec3 a, ivec3 b, bvec3 second) {
  return ivec3(second.x ? b.x : a.x, second.y ? b.y : a.y, second.z ? b.z : a.z);
}

// Tests the four children in one word of a node's data: sets their bits if the ray enters their boxes before it leaves
// them. near, far: grid steps, four bytes per axis; scale, nearBase, farBase: convert steps to distances.
uint bvhHitFour(ivec3 near, ivec3 far, vec3 scale, vec3 nearBase, vec3 farBase, float tMin, float tMax, uint meta,
                uint octant) {
  uint nodes = (meta & (meta << 1)) & 0x10101010u;                   // meta >= 24: an inner node
  uint turned = meta ^ ((octant * 0x01010101u) & (((nodes >> 4) * 0xffu)));  // slot permuted by the octant
  uint hits = 0u;
  for (int k = 0; k < 4; ++k) {
    int shift = 8 * k;
    vec3 a = vec3((near >> shift) & 255) * scale + nearBase, b = vec3((far >> shift) & 255) * scale + farBase;
    float enter = bvhGreater(bvhGreater(a.x, a.y), bvhGreater(a.z, tMin)),
          leave = bvhLess(bvhLess(b.x, b.y), bvhLess(b.z, tMax));
    uint bits = ((meta >> (shift + 5)) & 7u) << ((turned >> shift) & 31u);
    hits |= enter <= leave ? bits : 0u;
  }
  return hits;
}

// A traversal in progress, for kernels whose lanes start new rays while others are still tracing: beginRay, then
// advanceRay until it is done, then finishRay. An invocation has one at a time, since they share one stack.
struct BvhTraversal {
  BvhRay ray;
  float tMin;
  float lampEnd;   // t of the lamp that a shadow ray goes to, 3e38 for other rays
  float slack;     // largest coordinate of the origin; negative: surfaces that coincide are told apart
  uint skipTriangle;
  Hit hit;         // the nearest so far; its triangle is a texel of bvhTriangles
  // children to visit: x the first child of their parent; y bits 24..31 the remaining ones, in octant order, bits 0..7
  // those that are nodes
  uvec2 siblings;
  int top;         // of the stack
  uint leaves, firstTriangle;  // triangles of the node to test, a bit each, counted from its first
#if !SHARED_STACK
  uint later, firstLater;      // the same of the next node, to test after those
#endif
  int visited, tested;         // nodes and triangles, for statistics
};

// Flag SHARED_STACK: number of entries of a stack in shared memory, the hierarchy's depth (compute programs only, after
// their local_size). On GPUs a local array takes 64 registers per lane or spills to memory. 0: a local array, which is
// faster on software renderers.
#if SHARED_STACK
const uint kBvhLanes = gl_WorkGroupSize.x * gl_WorkGroupSize.y;
shared uint bvhStackX[SHARED_STACK * kBvhLanes], bvhStackY[SHARED_STACK * kBvhLanes];
uint bvhStackPlace(int entry) { return uint(entry) * kBvhLanes + gl_LocalInvocationIndex; }
#else
uint bvhStackX[BVH_MAX_DEPTH], bvhStackY[BVH_MAX_DEPTH];
#endif

// Loop iterations of this invocation so far, for kernels that must stop before a driver leaves all loops (llvmpipe does
// after 65,535 iterations of a vector of lanes).
uint loopIterations = 0u;

// A traversal visits no node twice and tests the triangles of no leaf twice, so this bounds its steps whatever the
// nodes hold.
int bvhStepCount() {
  return textureSize(bvhNodes) / BVH_NODE_TEXELS + textureSize(bvhTriangles) / BVH_TRIANGLE_TEXELS;
}

// Whether a ray is one: all finite, and with a direction. Others hit nothing, but their comparisons would not say so:
// min and max drop NaN on GPUs, and a ray of NaN would visit the whole hierarchy.
bool isRay(Ray ray) {
  bvec2 range = lessThanEqual(floatBitsToUint(vec2(ray.tMin, ray.tMax)) & 0x7fffffffu, uvec2(0x7f800000u));
  return allFinite(ray.origin) && allFinite(ray.direction) && ray.direction != vec3(0.0) && all(range);
}

BvhTraversal beginRay(Ray ray, uint skipTriangle) {
  // The root is treated as the only child of a virtual parent, in the slot that is visited first.
  return BvhTraversal(bvhPrepare(ray), ray.tMin, 3e38, largestOf(ray.origin), skipTriangle,
                      Hit(ray.tMax, kNoHit, vec2(0.0)), uvec2(0u, isRay(ray) ? 0x80000000u : 0u), 0, 0u, 0u,
#if !SHARED_STACK
                      0u, 0u,
#endif
                      0, 0);
}

// A shadow ray, which ends on a lamp at tMax.
BvhTraversal beginRayToLamp(Ray ray, uint skipTriangle) {
  BvhTraversal s = beginRay(ray, skipTriangle);
  s.lampEnd = ray.tMax;
  return s;
}

bool isDone(BvhTraversal s) { return s.leaves == 0u && s.siblings.y <= 0x00ffffffu; }

// The sibling to visit next, as the first of its texels. rest: those that remain.
int bvhNextNode(BvhTraversal s, out uint rest) {
  int place = bvhHighest(s.siblings.y >> 24);
  rest = s.siblings.y & ~(0x01000000u << place);
  return BVH_NODE_TEXELS *
         int(s.siblings.x + uint(bitCount(rest & ~(0xffffffffu << (uint(place) ^ s.ray.octant)) & 255u)));
}

// The children of a node whose boxes the ray enters: bits 24..31 nodes in octant order, 0..23 triangles.
uint bvhHitBoxes(BvhTraversal s, uvec4 n0, uvec4 n1, uvec4 n2, uvec4 n3, uvec4 n4) {
  vec3 scale = uintBitsToFloat(uvec3(n0.w << 23, n0.w << 15, n0.w << 7) & 0x7f800000u) * s.ray.inverse;
  vec3 base = (uintBitsToFloat(n0.xyz) - s.ray.origin) * s.ray.inverse;
  // 2^-21: the rounding of this, of the next lines and of the triangle test
  vec3 error = (abs(base) + abs(scale) * 256.0) * 4.76837158e-7;
  float unit = bvhBoxUnit(s.ray), tMin = s.tMin * unit, tMax = s.hit.t * unit;
  ivec3 low03 = ivec3(n2.x, n2.z, n3.x), low47 = ivec3(n2.y, n2.w, n3.y), high03 = ivec3(n3.z, n4.x, n4.z),
        high47 = ivec3(n3.w, n4.y, n4.w);
  uint hits = bvhHitFour(bvhChoose(low03, high03, s.ray.negative), bvhChoose(high03, low03, s.ray.negative), scale,
                         base - error, base + error, tMin, tMax, n1.z, s.ray.octant);
#if SHARED_STACK
  // Adds 0: eight inner nodes leave no child for triangles. It keeps compilers from unpacking all 48 bytes at once.
  int none = hits == 0xffffffffu ? 1 : 0;
  low47 += none;
  high47 += none;
#endif
  return hits | bvhHitFour(bvhChoose(low47, high47, s.ray.negative), bvhChoose(high47, low47, s.ray.negative), scale,
                           base - error, base + error, tMin, tMax, n1.w, s.ray.octant);
}

// Tests a triangle, the texels a, b and c.
void bvhTestTriangle(inout BvhTraversal s, int triangle, uvec4 a, vec4 b, vec4 c) {
  ++s.tested;
  float t;
  vec2 barycentrics;
  uint id = a.w & BVH_TRIANGLE_ID_MASK;
  if (bvhHitTriangle(s.ray, uintBitsToFloat(a.xyz), b.xyz, c.xyz, a.w, vec2(b.w, c.w), s.tMin, s.hit.t, s.lampEnd,
                     s.slack, t, barycentrics) &&
      id != s.skipTriangle && !bvhMissesMask(a.w, barycentrics))
    s.hit = Hit(t, uint(triangle), barycentrics);
}

#if SHARED_STACK
// One step: visits a node and tests its triangles. any: stop at the first hit.
void advanceRay(inout BvhTraversal s, bool any) {
  ++loopIterations;
  ++s.visited;
  uint rest;
  int node = bvhNextNode(s, rest);
  if (rest > 0x00ffffffu) {
    bvhStackX[bvhStackPlace(s.top)] = s.siblings.x;
    bvhStackY[bvhStackPlace(s.top)] = rest;
    ++s.top;
  }
  uvec4 n0 = texelFetch(bvhNodes, node), n1 = texelFetch(bvhNodes, node + 1), n2 = texelFetch(bvhNodes, node + 2),
        n3 = texelFetch(bvhNodes, node + 3), n4 = texelFetch(bvhNodes, node + 4);
  uint hits = bvhHitBoxes(s, n0, n1, n2, n3, n4);
  s.siblings = uvec2(n1.x, (hits & 0xff000000u) | (n0.w >> 24));
  s.leaves = hits & 0x00ffffffu;
  s.firstTriangle = n1.y;
  while (s.leaves != 0u) {  // ends: each iteration clears the highest of 24 bits
    ++loopIterations;
    int k = bvhHighest(s.leaves), triangle = 1 + BVH_TRIANGLE_TEXELS * (int(s.firstTriangle) + k);
    s.leaves &= ~(1u << k);
    bvhTestTriangle(s, triangle, texelFetch(bvhTriangles, triangle),
                    uintBitsToFloat(texelFetch(bvhTriangles, triangle + 1)),
                    uintBitsToFloat(texelFetch(bvhTriangles, triangle + 2)));
    if (any && s.hit.triangle != kNoHit) s.leaves = 0u;
  }
  if (any && s.hit.triangle != kNoHit) {
    s.siblings.y = 0u;
  } else if (s.siblings.y <= 0x00ffffffu && s.top > 0) {
    --s.top;
    s.siblings = uvec2(bvhStackX[bvhStackPlace(s.top)], bvhStackY[bvhStackPlace(s.top)]);
  }
}
#else
// The same for software renderers, where all lanes do what one of them does: a step visits a node and tests a triangle
// of an earlier one. Both are read first, so that the processor waits for memory once. Lanes that wait read too: the
// first texel, which is in the caches.
void advanceRay(inout BvhTraversal s, bool any) {
  ++loopIterations;
  bool tests = s.leaves != 0u, isMore = s.siblings.y > 0x00ffffffu, visits = isMore && s.later == 0u;
  int k = bvhHighest(s.leaves), triangle = tests ? 1 + BVH_TRIANGLE_TEXELS * (int(s.firstTriangle) + k) : 0;
  uint rest;
  int next = bvhNextNode(s, rest), node = isMore ? next : 0;
  uvec4 a = texelFetch(bvhTriangles, triangle);
  vec4 b = uintBitsToFloat(texelFetch(bvhTriangles, triangle + 1)),
       c = uintBitsToFloat(texelFetch(bvhTriangles, triangle + 2));
  uvec4 n0 = texelFetch(bvhNodes, node), n1 = texelFetch(bvhNodes, node + 1), n2 = texelFetch(bvhNodes, node + 2),
        n3 = texelFetch(bvhNodes, node + 3), n4 = texelFetch(bvhNodes, node + 4);

  // The node: its children that are nodes are the next siblings, else those that remain, else those on the stack.
  if (visits) {
    ++s.visited;
    uint hits = bvhHitBoxes(s, n0, n1, n2, n3, n4);
    bool descends = hits > 0x00ffffffu, remain = rest > 0x00ffffffu;
    if (descends && remain) {
      bvhStackX[s.top] = s.siblings.x;
      bvhStackY[s.top] = rest;
      ++s.top;
    }
    s.siblings.y = rest;
    if (descends) {
      s.siblings = uvec2(n1.x, (hits & 0xff000000u) | (n0.w >> 24));
    } else if (!remain && s.top > 0) {
      --s.top;
      s.siblings = uvec2(bvhStackX[s.top], bvhStackY[s.top]);
    }
    s.later = hits & 0x00ffffffu;
    s.firstLater = n1.y;
  }

  // The triangle, and which is the next.
  if (tests) {
    s.leaves &= ~(1u << k);
    bvhTestTriangle(s, triangle, a, b, c);
  }
  if (s.leaves == 0u) {
    s.leaves = s.later;
    s.firstTriangle = s.firstLater;
    s.later = 0u;
  }
  if (any && s.hit.triangle != kNoHit) s.leaves = s.siblings.y = 0u;
}
#endif

// The hit of a finished ray. Float edge functions decide exactly whether a triangle is hit, but in a sliver their
// ratios locate the hit poorly. So distance and barycentrics are recomputed from the plane and the areas in it, in
// pairs of floats (not double, which many GPUs lack or emulate). With the edges e1 and e2 from the corner a (relative
// to the origin), n = e1 x e2 and m = d x a: t = n.a / n.d, the second corner's weight is -e2.m / n.d, the third's e1.m
// / n.d.
Hit finishRay(BvhTraversal s, vec3 direction) {
  bool met = s.hit.triangle != kNoHit;
  int triangle = met ? int(s.hit.triangle) : 0;
  uvec4 first = texelFetch(bvhTriangles, triangle);
  vec3 a = uintBitsToFloat(first.xyz), b = uintBitsToFloat(texelFetch(bvhTriangles, triangle + 1).xyz),
       c = uintBitsToFloat(texelFetch(bvhTriangles, triangle + 2).xyz);
  // Edges and direction are scaled by powers of two to lengths near 1, so that no product overflows or underflows.
  float scale = inversePowerOfTwo(max(largestOf(b - a), largestOf(c - a))),
        directionScale = inversePowerOfTwo(largestOf(direction));
  a *= scale, b *= scale, c *= scale;
  Pairs e1 = pairsDifference(b, a), e2 = pairsDifference(c, a), corner = pairsDifference(a, s.ray.origin * scale);
  vec3 d = direction * directionScale;
#if SHARED_STACK
  // Component after component: a third fewer registers than all at once.
  vec4 sum = vec4(0.0), error = vec4(0.0), low = vec4(0.0);
  for (int axis = met ? 0 : 3; axis < 3; ++axis) {
    PairOfPairs p = pairsProduct(PairOfPairs(vec2(e1.hi.y, d.y), vec2(e1.lo.y, 0.0)),
                                 PairOfPairs(vec2(e2.hi.z, corner.hi.z), vec2(e2.lo.z, corner.lo.z))),
                q = pairsProduct(PairOfPairs(vec2(e1.hi.z, d.z), vec2(e1.lo.z, 0.0)),
                                 PairOfPairs(vec2(e2.hi.y, corner.hi.y), vec2(e2.lo.y, corner.lo.y))),
                nm = pairsDifference(p, q);
    p = pairsProduct(PairOfPairs(nm.hi.xx, nm.lo.xx), PairOfPairs(vec2(d.x, corner.hi.x), vec2(0.0, corner.lo.x)));
    q = pairsProduct(PairOfPairs(nm.hi.yy, nm.lo.yy), PairOfPairs(vec2(e2.hi.x, e1.hi.x), vec2(e2.lo.x, e1.lo.x)));
    vec4 term = vec4(p.hi, q.hi);
    precise vec4 next = sum + term;
    precise vec4 back = next - sum;
    precise vec4 lost = error + ((sum - (next - back)) + (term - back));
    precise vec4 lows = low + vec4(p.lo, q.lo);
    sum = next;
    error = lost;
    low = lows;
    e1 = Pairs(e1.hi.yzx, e1.lo.yzx);
    e2 = Pairs(e2.hi.yzx, e2.lo.yzx);
    corner = Pairs(corner.hi.yzx, corner.lo.yzx);
    d = d.yzx;
  }
  precise vec4 rest = error + low;
  precise vec4 hi = sum + rest;
  precise vec4 lo = rest - (hi - sum);
  vec2 along = vec2(hi.x, lo.x), distance = vec2(hi.y, lo.y), v = vec2(hi.z, lo.z), w = vec2(hi.w, lo.w);
#else
  Pairs n = pairsCross(e1, e2), m = pairsCross(Pairs(d, vec3(0.0)), corner);
  vec2 along = pairsDot(n, Pairs(d, vec3(0.0))), distance = pairsDot(n, corner), v = pairsDot(e2, m),
       w = pairsDot(e1, m);
#endif
  Hit hit = s.hit;
  if (along.x != 0.0) {
    vec3 ratios = pairsOver(Pairs(vec3(distance.x, -v.x, w.x), vec3(distance.y, -v.y, w.y)), along);
    hit.t = ratios.x * directionScale * inversePowerOfTwo(scale);
    hit.barycentrics = clamp(ratios.yz, vec2(0.0), vec2(1.0));
  }
  hit.triangle = met ? first.w & BVH_TRIANGLE_ID_MASK : kNoHit;
  hit.t = met ? hit.t : s.hit.t;
  hit.barycentrics = met ? hit.barycentrics : vec2(0.0);
  return hit;
}

// The nearest hit; its triangle is kNoHit if there is none. skipTriangle: the triangle the ray starts on, or kNoHit.
Hit closestHit(Ray ray, uint skipTriangle) {
  BvhTraversal s = beginRay(ray, skipTriangle);
  for (int left = bvhStepCount(); left > 0 && !isDone(s); --left) advanceRay(s, false);
  return finishRay(s, ray.direction);
}

// Whether anything is hit at all.
bool anyHit(BvhTraversal s) {
  for (int left = bvhStepCount(); left > 0 && !isDone(s); --left) advanceRay(s, true);
  return s.hit.triangle != kNoHit;
}
bool anyHit(Ray ray, uint skipTriangle) { return anyHit(beginRay(ray, skipTriangle)); }
bool anyHitToLamp(Ray ray, uint skipTriangle) { return anyHit(beginRayToLamp(ray, skipTriangle)); }

// A point just off a surface, on the side that the GEOMETRIC normal (unit) points to. The offset exceeds the rounding
// error of a point computed from a triangle's barycentrics and that of testing its neighbours. As in
// [WaechterBinder2019] it is a number of units in the last place, so no scale is assumed. Theirs are per component,
// with a floor near zero; here they are those of the triangle's largest coordinate, which determines the rounding
// error: `magnitude` = the largest absolute coordinate of its corners.
vec3 offsetRay(vec3 p, vec3 geometricNormal, float magnitude) {
  return p + geometricNormal * (magnitude * 3.814697265625e-6);
}  // 2^-18

// The same for a point whose triangle is not available.
vec3 offsetRay(vec3 p, vec3 geometricNormal) {
  vec3 a = abs(p);
  return offsetRay(p, geometricNormal,
                   max(max(a.x, a.y), max(a.z, uintBitsToFloat(texelFetch(bvhTriangles, 0).x) * 9.765625e-4)));
}
