// Irradiance at receivers from a map of points that emit, a light's reflective shadow map or the emissive surfaces,
// through a hierarchy over its texels (tree.glsl). One group of lanes gathers for one receiver.
//
// From a receiver at x with normal n a node of flux Phi, area A and mean normal n_p at p gives
//   E = Phi c1 c2 / (pi (r^2 + A c2 / pi)),  c1 = <n, p - x>+ / r,  c2 = <n_p, x - p>+ / r:
// a point [Dachsbacher2005] at a distance, a disc near by. Near nodes are opened; nodes behind the receiver are
// skipped. Near texels use their outline in the sun's map (rsm/transfer.glsl).
// SHARED_WITH_RAYS: rays find the points too (around.comp), both weighted by the balance heuristic [Veach1997] of the
// densities over solid angle, r^2 / (A c2) of points and n c1 / pi of n rays:
//   E = Phi c1 c2 / (pi r^2 + n A c1 c2),
// bounded next to a point. A is the area that one texel stands for.
// Visibility: each lane keeps up to eight of its nodes, drawn in proportion to their contribution (reservoir sampling
// [Chao1982]). Lanes with larger contributions trace more rays, so that some 200 rays represent all nodes, through
// voxels or through the scene's hierarchy.
layout(local_size_x = 64) in;  // LPV_LANES
#include "shared/bindings.h"
#define VISIBILITY_VOXELS 1
#define VISIBILITY_RAYS 2
#include "shared/path_tracer.h"
#include "rays/random.glsl"
#if VISIBILITY == VISIBILITY_RAYS
// The texture atlas has the map's usual unit.
#undef UNIT_RSM_POSITION
#undef UNIT_RSM_NORMAL
#undef UNIT_RSM_FLUX
#define UNIT_RSM_POSITION 10
#define UNIT_RSM_NORMAL 11
#define UNIT_RSM_FLUX 12
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
uniform float rayEnd;  // by which a ray ends before its point, along the point's normal
#endif
#include "lpv/receivers/common.glsl"
#if VISIBILITY == VISIBILITY_VOXELS
#include "lpv/gather/voxels.glsl"
#endif
#include "rsm/transfer.glsl"
#include "lpv/gather/tree.glsl"
layout(binding = 7) uniform usamplerBuffer treeNodes;
layout(std430, binding = 0) restrict buffer LpvReceivers { LpvReceiver receivers[]; };
layout(std430, binding = 1) readonly restrict buffer LpvLit { uint lit[]; };
uniform uint last;         // 1: after this dispatch receivers have all their light
uniform uint firstListed;  // of `lit`
#if SHARED_WITH_RAYS
uniform float raysAround;  // of a receiver
#endif
shared vec3 sums[LPV_LANES];
shared float weights[LPV_LANES];

const float kOff = 2.0;  // voxels by which both ends of a ray are moved off their surfaces
const float kOpen = 3.0;          // radii
const float kOpenTurning = 32.0;  // for nodes with varying normals: their mean gives less light than they do
const float kFlat = 0.98;        // normals count as varying below this squared length of the mean normal
const int kReservoirs = 8;     // and at most as many rays of a lane
const float kRays = 192.0;     // of a receiver, about
const int kStack = 40;       // up to three siblings wait per level, and there are at most nine levels

struct Candidate {
  vec3 position, normal;
};

Candidate candidateOf(int layer, uint texel) {
  ivec3 at = ivec3(int(texel & 0xffffu), int(texel >> 16u), layer);
  return Candidate(texelFetch(rsmPosition, at, 0).xyz, texelFetch(rsmNormal, at, 0).xyz);
}

// Irradiance from a point of that flux, at a distance of root r2.
vec3 ofPoint(vec3 flux, float area, float c1, float c2, float r2) {
#if SHARED_WITH_RAYS
  return flux * (c1 * c2 / (kPi * r2 + raysAround * area * c1 * c2));
#else
  return flux * (c1 * c2 / (kPi * r2 + area * c2));
#endif
}

#if VISIBILITY == VISIBILITY_RAYS
bool isHidden(LpvReceiver receiver, Candidate target) {
  uint first = receiver.triangle * TRIANGLE_WORDS;
  vec3 normal =
      uintBitsToFloat(uvec3(triangleData[first + 1u].w, triangleData[first + 2u].w, triangleData[first + 3u].x));
  Surface surface = surfaceAt(receiver.triangle, vec2(receiver.second, receiver.third),
                              (receiver.state & LPV_FRONT) != 0u ? -normal : normal);
  vec3 from = offsetRay(surface.position, surface.geometricNormal, surface.magnitude);
  vec3 direction = target.position + rayEnd * target.normal - receiving.rayOrigin - from;
  return !(dot(direction, surface.geometricNormal) > 0.0) ||
         anyHit(Ray(from, 0.0, direction, 1.0), receiver.triangle);
}
#elif VISIBILITY == VISIBILITY_VOXELS
bool isHidden(LpvReceiver receiver, Candidate target) {
  return isBlocked(receiver.position + kOff * voxelSize * receiver.normal,
                   target.position + kOff * voxelSize * target.normal, false);
}
#endif

vec3 gatherAt(LpvReceiver receiver, uint lane, out float share) {
  vec3 position = receiver.position, normal = receiver.normal;
  vec3 sum = vec3(0.0);
  share = 1.0;
  // The map's texels: traverse the light tree, with its top levels divided among the lanes. Texels for rays are kept in
  // weighted reservoirs of size one [Chao1982].
  uint chosen[kReservoirs];
  int chosenLayer[kReservoirs];
  for (int i = 0; i < kReservoirs; ++i) {
    chosen[i] = 0u;
    chosenLayer[i] = 0;
  }
  float weight = 0.0;
  uvec4 numbers = pcg4d(uvec4(receiver.cell) ^ uvec4(0u, 0u, lane << 8u, 0x9e3779b9u));
  ivec2 stack[kStack];  // x | y << 16, level | layer << 8
  int width = treeWidth(treeLevels), top = treeLayers * width * width;
  for (int first = int(lane); first < top; first += LPV_LANES) {
    int inLayer = first % (width * width);
    int depth = 0;
    stack[depth++] = ivec2(inLayer % width | (inLayer / width) << 16, treeLevels | (first / (width * width)) << 8);
    while (depth > 0) {
      ivec2 entry = stack[--depth];
      ivec2 place = ivec2(entry.x & 0xffff, entry.x >> 16);
      int level = entry.y & 0xff, layer = entry.y >> 8;
      vec3 given = vec3(0.0);
      uint texel;
      if (level == 0) {
        // A single texel.
        texel = uint(place.x) | uint(place.y) << 16u;
#if PERSPECTIVE
        vec4 p = texelFetch(rsmPosition, ivec3(place, layer), 0), flux = texelFetch(rsmFlux, ivec3(place, layer), 0);
        if (!(p.w > 0.5)) continue;
        vec3 away = p.xyz - position;
        float r2 = dot(away, away), r = sqrt(r2);
        float c1 = dot(normal, away) / r, c2 = -dot(texelFetch(rsmNormal, ivec3(place, layer), 0).xyz, away) / r;
        if (!(c1 > 0.0 && c2 > 0.0)) continue;
        given = ofPoint(flux.rgb, flux.w, c1, c2, r2);
#else
        RsmSurfel surfel = rsmSurfel(ivec3(place, 0));
        if (!surfel.lit) continue;
        given = surfelIrradiance(surfel, position, normal);
#endif
      } else {
        // A node: treated as one texel from afar, otherwise opened.
        int at = treeNode(level, layer, place);
        uvec4 a = texelFetch(treeNodes, at);
        float radius = uintBitsToFloat(a.w);
        if (radius < 0.0) continue;
        vec3 away = uintBitsToFloat(a.xyz) - position;
        if (dot(normal, away) < -radius) continue;
        float r2 = dot(away, away);
        uvec4 b = texelFetch(treeNodes, at + 1);
        vec3 facing = uintBitsToFloat(b.xyz);
        float open = dot(facing, facing) < kFlat ? kOpenTurning : kOpen;
        if (r2 < open * open * radius * radius) {
          ivec2 below = ivec2(treeWidth(level - 1));
          for (int i = 0; i < 4; ++i) {
            ivec2 childPlace = 2 * place + ivec2(i & 1, i >> 1);
            if (all(lessThan(childPlace, below)) && depth < kStack)
              stack[depth++] = ivec2(childPlace.x | childPlace.y << 16, level - 1 | layer << 8);
          }
          continue;
        }
        uvec4 c = texelFetch(treeNodes, at + 2);
        float r = sqrt(r2), c1 = dot(normal, away) / r, c2 = -dot(facing, away) / r;
        if (!(c1 > 0.0 && c2 > 0.0)) continue;
        given = ofPoint(uintBitsToFloat(c.xyz), uintBitsToFloat(b.w), c1, c2, r2);
        texel = c.w;
      }
      // Add its contribution, and offer it to a reservoir.
      float w = given.r + given.g + given.b;
      if (!(w > 0.0)) continue;
      sum += given;
      weight += w;
      for (int i = 0; i < kReservoirs; ++i) {
        if ((i & 3) == 0) numbers = pcg4d(numbers);
        if (unitFloat(numbers[i & 3]) * weight < w) {
          chosen[i] = texel;
          chosenLayer[i] = layer;
        }
      }
    }
  }
  // Trace rays to the chosen texels for the visible share. The number of rays is the lane's share of the total weight.
  weights[lane] = weight;
  barrier();
  float all = 0.0;
  for (int i = 0; i < LPV_LANES; ++i) all += weights[i];
#if VISIBILITY
  if (weight > 0.0) {
    int rays = clamp(int(round(kRays * weight / all)), 1, kReservoirs);
    float open = 0.0;
    for (int i = 0; i < rays; ++i)
      if (!isHidden(receiver, candidateOf(chosenLayer[i], chosen[i]))) open += 1.0;
    share = open / float(rays);
  }
#endif
  return sum;
}

void main() {
  uint lane = gl_LocalInvocationID.x, index = lit[firstListed + gl_WorkGroupID.x];
  LpvReceiver receiver = receivers[index];
  if ((receiver.state & LPV_ALONE) != 0u) return;  // what sees no surface lights none
  float share;
  vec3 sum = gatherAt(receiver, lane, share);
  sums[lane] = share * sum;
  barrier();
  if (lane != 0u) return;
  vec3 all = vec3(0.0);
  for (int i = 0; i < LPV_LANES; ++i) all += sums[i];
  receivers[index].irradiance = receiver.irradiance + all;
  if (last != 0u) receivers[index].paths = LPV_GATHERED;
}
