// Rays against the triangles of a RayScene (engine/pathtracer/ray_scene.hpp): the first hit, or any.
//
// Space: RayScene's (the world moved by -RayScene::origin()). Flag ALPHA_MASKS: the including file declares, before the include,
// `bool isCutOut(uint triangle, vec2 barycentrics)`, asked for triangles whose material is masked. Binds shader storage blocks 0 and 1.
// Watertight: the triangle test is that of [Woop2013], boxes are padded after [Ize2013].
#include "shared/bvh.h"

layout(std430, binding = 0) readonly restrict buffer BvhNodes {
  BvhHeader bvhHeader;
  BvhNode bvhNodes[];
};
layout(std430, binding = 1) readonly restrict buffer BvhTriangles {
  BvhTriangle bvhTriangles[];
};

const uint kNoHit = 0xffffffffu;  // no triangle: Hit::triangle of a ray that hit nothing, and skipTriangle where nothing is to be skipped

struct Ray {
  vec3 origin;
  float tMin;      // hits lie at tMin < t < tMax
  vec3 direction;  // of any length above 0; t counts in lengths of it
  float tMax;
};

struct Hit {
  float t;
  uint triangle;      // in the order of the scene: its corners are indices[3 * triangle] and the next two
  vec2 barycentrics;  // weights of the second and third corner
};

// The ray's own space, in which it runs along z from the origin [Woop2013]: axes permuted so that z is its longest, then sheared.
struct RaySpace {
  vec3 origin;
  vec3 shear;
  int axis;
};

vec3 bvhPermute(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }

RaySpace raySpace(Ray ray) {
  vec3 d = abs(ray.direction);
  RaySpace space;
  space.axis = d.x > d.y && d.x > d.z ? 0 : d.y > d.z ? 1 : 2;
  vec3 p = bvhPermute(ray.direction, space.axis);
  space.shear = vec3(p.x / p.z, p.y / p.z, 1.0 / p.z);
  space.origin = ray.origin;
  return space;
}

// Twice the area of (0, a, b) in the plane. Products of floats are exact in double, so its sign always is right: in float it is wrong only
// where it is zero. Neighbours see a shared edge with the same numbers, so nothing passes between them.
float bvhEdge(precise vec2 a, precise vec2 b) {
  precise float ab = a.x * b.y;
  precise float ba = a.y * b.x;
  precise float area = ab - ba;
  if (area == 0.0) area = float(double(a.x) * double(b.y) - double(a.y) * double(b.x));
  return area;
}

// Whether the ray meets the triangle at tMin < t < tMax; then where.
bool hitTriangle(RaySpace space, vec3 a, vec3 b, vec3 c, float tMin, float tMax, out float t, out vec2 barycentrics) {
  vec3 pa = bvhPermute(a - space.origin, space.axis), pb = bvhPermute(b - space.origin, space.axis), pc = bvhPermute(c - space.origin, space.axis);
  precise vec2 sa = pa.xy - space.shear.xy * pa.z;
  precise vec2 sb = pb.xy - space.shear.xy * pb.z;
  precise vec2 sc = pc.xy - space.shear.xy * pc.z;
  float u = bvhEdge(sc, sb), v = bvhEdge(sa, sc), w = bvhEdge(sb, sa);
  t = 0.0;
  barycentrics = vec2(0.0);
  if (min(u, min(v, w)) < 0.0 && max(u, max(v, w)) > 0.0) return false;
  float area = u + v + w;
  if (area == 0.0) return false;
  barycentrics = vec2(v, w) / area;
  t = (u / area * pa.z + barycentrics.x * pb.z + barycentrics.y * pc.z) * space.shear.z;
  return t > tMin && t < tMax;
}

// One over the direction; components of zero are taken for so small ones that a box's padding outweighs them.
vec3 inverseDirection(vec3 direction) {
  vec3 d = abs(direction);
  return vec3(1.0) / mix(direction, vec3(1e-37), lessThan(d, vec3(1e-37)));
}

// Where the ray enters a box: to be compared with tMax; 3e38 where it misses it.
float enterBox(vec3 minimum, vec3 maximum, Ray ray, vec3 inverse) {
  const float kFar = 1.0 + 2.0 * 1.8e-7;  // 1 + 2 gamma(3) [Ize2013 section 4]
  vec3 a = (minimum - ray.origin) * inverse, b = (maximum - ray.origin) * inverse;
  vec3 near = min(a, b), far = max(a, b);
  float enter = max(max(near.x, near.y), max(near.z, ray.tMin));
  float leave = min(min(far.x, far.y), far.z) * kFar;
  return enter <= leave ? enter : 3e38;
}

bool bvhMissesMask(uint id, vec2 barycentrics) {
#if ALPHA_MASKS
  return (id & BVH_TRIANGLE_MASKED) != 0u && isCutOut(id & BVH_TRIANGLE_ID_MASK, barycentrics);
#else
  return false;
#endif
}

Hit bvhTrace(Ray ray, uint skipTriangle, bool any) {
  Hit hit = Hit(ray.tMax, kNoHit, vec2(0.0));
  RaySpace space = raySpace(ray);
  vec3 inverse = inverseDirection(ray.direction);
  uint stack[BVH_MAX_DEPTH];
  int top = 0;
  uint node = 0u;
  while (true) {
    if ((node & BVH_LEAF) == 0u) {
      BvhNode n = bvhNodes[node];
      float enter0 = enterBox(n.minimum0, n.maximum0, ray, inverse), enter1 = enterBox(n.minimum1, n.maximum1, ray, inverse);
      bool in0 = enter0 < hit.t, in1 = enter1 < hit.t;
      if (in0 && in1) {
        bool firstIs0 = enter0 <= enter1;
        stack[top++] = firstIs0 ? n.child1 : n.child0;
        node = firstIs0 ? n.child0 : n.child1;
        continue;
      }
      if (in0 || in1) {
        node = in0 ? n.child0 : n.child1;
        continue;
      }
    } else {
      uint first = node & BVH_LEAF_FIRST_MASK, count = ((node & ~BVH_LEAF) >> BVH_LEAF_COUNT_SHIFT) + 1u;
      for (uint i = first; i < first + count; ++i) {
        BvhTriangle triangle = bvhTriangles[i];
        float t;
        vec2 barycentrics;
        uint id = triangle.id & BVH_TRIANGLE_ID_MASK;
        if (id == skipTriangle || !hitTriangle(space, triangle.a, triangle.b, triangle.c, ray.tMin, hit.t, t, barycentrics)) continue;
        if (bvhMissesMask(triangle.id, barycentrics)) continue;
        hit = Hit(t, id, barycentrics);
        if (any) return hit;
      }
    }
    if (top == 0) break;
    node = stack[--top];
  }
  return hit;
}

// The nearest hit; its triangle is kNoHit where there is none. skipTriangle: the one the ray starts on, or kNoHit.
Hit closestHit(Ray ray, uint skipTriangle) { return bvhTrace(ray, skipTriangle, false); }

// Whether anything is hit at all.
bool anyHit(Ray ray, uint skipTriangle) { return bvhTrace(ray, skipTriangle, true).triangle != kNoHit; }

// A point just off a surface, on the side that the GEOMETRIC normal (unit) points to, beyond the rounding of a point computed from a
// triangle's barycentrics and of the test of its neighbours. As in [WaechterBinder2019] a number of units in the last place, so that no scale
// is assumed; theirs are each component's own, with a floor near zero, these are of the triangle's largest coordinate, which is what the
// rounding depends on: `magnitude` = the largest absolute coordinate of its corners.
vec3 offsetRay(vec3 p, vec3 geometricNormal, float magnitude) { return p + geometricNormal * (magnitude * 3.814697265625e-6); }  // 2^-18

// The same for a point whose triangle is not at hand.
vec3 offsetRay(vec3 p, vec3 geometricNormal) {
  vec3 a = abs(p);
  return offsetRay(p, geometricNormal, max(max(a.x, a.y), max(a.z, bvhHeader.magnitude * 9.765625e-4)));
}
