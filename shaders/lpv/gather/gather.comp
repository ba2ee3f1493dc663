// Irradiance at receivers from a reflective shadow map, through a hierarchy over its texels (tree.glsl). One group of
// lanes gathers for one receiver.
//
// From a receiver at x with normal n a node of flux Phi, area A and mean normal n_p at p gives
//   E = Phi c1 c2 / (pi (r^2 + A c2 / pi)),  c1 = <n, p - x>+ / r,  c2 = <n_p, x - p>+ / r:
// a point [Dachsbacher2005] at a distance, a disc near by. Near nodes are opened; nodes behind the receiver are
// skipped. Near texels use their outline in the sun's map (rsm/transfer.glsl).
// Visibility: each lane keeps up to four of its nodes, drawn in proportion to their contribution (reservoir sampling
// [Chao1982]). Lanes with larger contributions trace more rays, so that 64 to 100 rays through voxels represent all
// nodes. SKY: no map; each lane tests the sky in one cosine-weighted direction.
layout(local_size_x = 64) in;  // LPV_LANES
#include "shared/bindings.h"
#include "shared/path_tracer.h"
layout(std140, binding = BLOCK_RECEIVER_PATHS) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "lpv/receivers/common.glsl"
#include "lpv/receivers/work.glsl"
#if VOXELS
#include "lpv/gather/voxels.glsl"
#endif
#if SKY
#include "rays/bsdf.glsl"
#include "rays/environment.glsl"
#else
#include "rsm/transfer.glsl"
#include "lpv/gather/tree.glsl"
layout(binding = 7) uniform usamplerBuffer treeNodes;
#endif
layout(std430, binding = 0) restrict buffer LpvReceivers { LpvReceiver receivers[]; };
layout(std430, binding = 1) readonly restrict buffer LpvLit { uint lit[]; };
uniform uint last;  // 1: after this dispatch receivers have all their light
shared vec3 sums[LPV_LANES];
shared float weights[LPV_LANES];

const float kOff = 2.0;  // voxels by which both ends of a ray are moved off their surfaces

#if !SKY
const float kOpen = 2.0;         // radii
const float kOpenTurning = 8.0;  // for nodes with varying normals: the mean normal is a poor estimate
const float kFlat = 0.98;        // normals count as varying below this squared length of the mean normal
const int kReservoirs = 4;
const int kStack = 40;       // up to three siblings wait per level, and there are at most nine levels

struct Candidate {
  vec3 position, normal;
};

Candidate candidateOf(int layer, uint texel) {
  ivec3 at = ivec3(int(texel & 0xffffu), int(texel >> 16u), layer);
  return Candidate(texelFetch(rsmPosition, at, 0).xyz, texelFetch(rsmNormal, at, 0).xyz);
}
#endif

vec3 gatherAt(vec3 position, vec3 normal, uvec4 cell, uint lane, out float share) {
  vec3 sum = vec3(0.0);
  share = 1.0;
#if SKY
  // The sky: one cosine-weighted ray per lane, and the radiance it finds if nothing blocks it.
  PathNumbers numbers = PathNumbers(pcg4d(cell).x, lane, tracer.seed);
  vec3 direction = cosineSample(normal, randomPair(numbers, 1u, kPurposeScatter));
#if VOXELS
  vec3 from = position + kOff * voxelSize * normal;
  if (isBlocked(from, from + direction * voxelSize, true)) direction = vec3(0.0);
#endif
  if (direction != vec3(0.0)) sum = environmentRadiance(direction) * (kPi / float(LPV_LANES));
  weights[lane] = 0.0;
  barrier();
#else
  // The map's texels: traverse the light tree, with its top levels divided among the lanes. Texels for rays are kept in
  // weighted reservoirs of size one [Chao1982].
  uint chosen[kReservoirs];
  int chosenLayer[kReservoirs];
  for (int i = 0; i < kReservoirs; ++i) {
    chosen[i] = 0u;
    chosenLayer[i] = 0;
  }
  float weight = 0.0;
  uvec4 numbers = pcg4d(cell ^ uvec4(0u, 0u, lane << 8u, 0x9e3779b9u));
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
        given = flux.rgb * (c1 * c2 / (kPi * r2 + flux.w * c2));
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
        given = uintBitsToFloat(c.xyz) * (c1 * c2 / (kPi * r2 + uintBitsToFloat(b.w) * c2));
        texel = c.w;
      }
      // Add its contribution, and offer it to a reservoir.
      float w = given.r + given.g + given.b;
      if (!(w > 0.0)) continue;
      sum += given;
      weight += w;
      numbers = pcg4d(numbers);
      for (int i = 0; i < kReservoirs; ++i)
        if (unitFloat(numbers[i]) * weight < w) {
          chosen[i] = texel;
          chosenLayer[i] = layer;
        }
    }
  }
  // Trace rays to the chosen texels for the visible share. The number of rays is the lane's share of the total weight.
  weights[lane] = weight;
  barrier();
  float all = 0.0;
  for (int i = 0; i < LPV_LANES; ++i) all += weights[i];
#if VOXELS
  if (weight > 0.0) {
    int rays = clamp(int(round(float(LPV_LANES) * weight / all)), 1, kReservoirs);
    vec3 from = position + kOff * voxelSize * normal;
    float open = 0.0;
    for (int i = 0; i < rays; ++i) {
      Candidate target = candidateOf(chosenLayer[i], chosen[i]);
      if (!isBlocked(from, target.position + kOff * voxelSize * target.normal, false)) open += 1.0;
    }
    share = open / float(rays);
  }
#endif
#endif
  return sum;
}

void main() {
  uint lane = gl_LocalInvocationID.x, index = lit[gl_WorkGroupID.x];
  LpvReceiver receiver = receivers[index];
  float share;
  vec3 sum = gatherAt(receiver.position, receiver.normal, uvec4(receiver.cell), lane, share);
  sums[lane] = share * sum;
  barrier();
  if (lane != 0u) return;
  vec3 all = vec3(0.0);
  for (int i = 0; i < LPV_LANES; ++i) all += sums[i];
  receivers[index].irradiance = receiver.irradiance + all;
  if (last != 0u) receivers[index].paths = LPV_GATHERED;
}
