// Irradiance at records from a map of points that emit, a light's reflective shadow map or the emissive surfaces,
// through a hierarchy over its texels (tree.glsl). One group of lanes gathers for one record.
//
// From a record at x with normal n a node of flux Phi, area A and normals n_p at p gives
//   E = Phi c1 c2 / (pi (r^2 + A c2 / pi)),  c1 = <n, p - x>+ / r,  c2 = mean <n_p, x - p>+ / r:
// a point [Dachsbacher2005] at a distance, a disc near by. Near nodes are opened; nodes behind the record are
// skipped. Near texels use their outline in the sun's map (rsm/transfer.glsl).
// SHARED_WITH_RAYS: rays find the points too (hemisphere.comp), both weighted by the balance heuristic [Veach1997] of
// the densities over solid angle, r^2 / (A c2) of points and n c1 / pi of n rays:
//   E = Phi c1 c2 / (pi r^2 + n A c1 c2),
// bounded next to a point. A is the area that one texel stands for. The bounces' points stand for a cell: beside a
// small lamp, whose light changes within it, they get its mean, without rays.
// Visibility: each lane keeps four of its nodes, drawn in proportion to their contribution (reservoir sampling
// [Chao1982]). One ray per lane, systematically spread over all contributions, goes through the scene's
// hierarchy to a texel of such a node, drawn by its flux.
layout(local_size_x = 64) in;  // CACHE_LANES
#include "lib/clamped_int.glsl"
#include "shared/bindings.h"
#include "shared/path_tracer.h"
#include "rays/random.glsl"
#if VISIBILITY
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
#include "irradiance_cache/common.glsl"
#if VISIBILITY
#include "irradiance_cache/record_surface.glsl"
#endif
#if PERSPECTIVE
const float kPi = 3.14159265358979;
#else
#include "rsm/transfer.glsl"
#endif
#include "irradiance_cache/gather/tree.glsl"
layout(binding = UNIT_CACHE_TREE) uniform usamplerBuffer treeNodes;
// unordered CacheRecords: each dispatch changes the records of its own part of the list
layout(std430, binding = CACHE_RECORDS_BUFFER) restrict buffer CacheRecords { CacheRecord records[]; };
layout(std430, binding = CACHE_LIST_BUFFER) readonly restrict buffer CacheLit { uint lit[]; };
uniform uint last;         // 1: after this dispatch records have all their light
uniform uint firstGroup;  // of `lit`
#if SHARED_WITH_RAYS
uniform float raysAround;  // of a record
uniform float cell;        // of the bounces' points, scene units; 0: these are records
bool standsForCell = false;
#include "irradiance_cache/small_lamps.glsl"
#endif
shared vec3 sums[CACHE_LANES];
#if VISIBILITY
shared float weights[CACHE_LANES];
shared vec3 colours[CACHE_LANES];  // of what a lane found, of which the channels add up to 1
shared uvec2 rays[CACHE_LANES];    // node + 1, or 0: none; the lane that chose it
shared vec3 sent[CACHE_LANES], arrived[CACHE_LANES];
#endif

const float kOpen = 4.0;  // radii

LightNode nodeAt(uint node) {
  int at = TREE_TEXELS * int(node);
  return unpackNode(texelFetch(treeNodes, at), texelFetch(treeNodes, at + 1), texelFetch(treeNodes, at + 2));
}

// Irradiance from a point of that flux, at a distance of root r2.
vec3 ofPoint(vec3 flux, float area, float c1, float c2, float r2) {
#if SHARED_WITH_RAYS
  return flux * (c1 * c2 / (kPi * r2 + raysAround * area * c1 * c2));
#else
  return flux * (c1 * c2 / (kPi * r2 + area * c2));
#endif
}

#if SHARED_WITH_RAYS
// What takes the place of r^2 for the mean over a disc of the squared radius `reach2`. A Lambertian point at the height
// h, in a plane parallel to it, sends the share F = (1 - a / q) / 2 of its flux to the disc [Howell2010, factor B-13],
// with a = r^2 - reach2 and q^2 = a^2 + 4 reach2 h^2: the mean is Phi h^2 / (pi r^2 S), S = reach2 h^2 / (r^2 F).
float spread2(float height, float r2, float reach2) {
  float a = r2 - reach2, b2 = 4.0 * reach2 * height * height, q = sqrt(a * a + b2);
  return q * (a > 0.0 ? q + a : b2 / (q - a)) / (2.0 * r2);  // without cancellation
}

// Mean irradiance over the cell around a point in the plane of `normal`: of discs in its four quarters.
vec3 overCell(LightNode here, vec3 away, vec3 normal) {
  vec3 lean = abs(normal);
  int axis = lean.x > max(lean.y, lean.z) ? 0 : lean.y > lean.z ? 1 : 2;
  vec3 u = vec3(0.0), v = vec3(0.0);
  u[(axis + 1) % 3] = v[(axis + 2) % 3] = 0.25 * cell;
  u -= dot(u, normal) * normal;
  v -= dot(v, normal) * normal;
  float reach2 = cell * cell / (4.0 * kPi), height = dot(normal, away), sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec3 d = away + ((i & 1) != 0 ? u : -u) + ((i & 2) != 0 ? v : -v);
    float r2 = dot(d, d), c1 = height * inversesqrt(r2), c2 = meanCosine(here, -d * inversesqrt(r2));
    if (c1 > 0.0 && c2 > 0.0)  // at most all of it on the disc
      sum += c1 * c2 / (kPi * max(spread2(height, r2, reach2), reach2 * c1 * c2));
  }
  return 0.25 * sum * here.flux;
}
#endif

// What a lane has found: its sum, and four nodes drawn in proportion to their contribution, by random numbers that are
// a quarter apart.
struct Found {
  vec3 sum;
  float weight;  // the sum's channels, added up
  uvec4 chosen;
  uint random;
};

// A linear congruential generator: [0, 1), from the upper bits.
float nextFloat(inout uint state) {
  state = state * 747796405u + 2891336453u;
  return unitFloat(state);
}

void add(inout Found found, vec3 given, uint node) {
  float w = given.r + given.g + given.b;
  if (!(w > 0.0)) return;
  found.sum += given;
  found.weight += w;
  vec4 xi = fract(nextFloat(found.random) + vec4(0.0, 0.25, 0.5, 0.75));
  for (int i = 0; i < 4; ++i)
    if (xi[i] * found.weight < w) found.chosen[i] = node;
}

// Goes down the light tree, depth first, its coarsest nodes divided among the lanes.
Found gatherAt(vec3 position, vec3 normal, uint lane, uint seed) {
  Found found = Found(vec3(0.0), 0.0, uvec4(0u), seed);
#if !PERSPECTIVE
  uint near[CACHE_MOST_NEAR];
  int nears = 0;
  vec3 edge1, edge2;
  rsmTexelEdges(edge1, edge2);
  float edges2 = dot(edge1, edge1) + dot(edge2, edge2), across = length(cross(edge1, edge2));
#endif
  uint ofLayer = treeNodesOfLayer(), leaves = treeFirst(treeDepth), firstTop = treeFirst(treeTop);
  uint topBits = uint(2 * treeTop), tops = uint(treeLayers) << topBits, top = lane;
  uint root = firstTop + (top & ((1u << topBits) - 1u)), layerStart = (top >> topBits) * ofLayer, node = root;
  // Turns that may open nodes; then what is left: three siblings on each level, and the lane's coarsest nodes.
  int most = CACHE_MOST_OPENING + 3 * (treeDepth - treeTop) + 1 + int(tops) / CACHE_LANES + 1;
  for (int i = 0; i < most && top < tops; ++i) {  // ends: most follows from uniforms
    LightNode here = nodeAt(layerStart + node);
    vec3 away = here.position - position;
    float r2 = dot(away, away), height = dot(normal, away);
    bool counts = here.radius >= 0.0 && height >= -here.radius, isLeaf = node >= leaves;
#if !PERSPECTIVE
    float slope = here.area / across;
    if (isLeaf && counts && r2 < edges2 * (1.0 + slope * slope) && nears < CACHE_MOST_NEAR) {
      near[nears++] = node;
      counts = false;
    }
#endif
    if (counts && !isLeaf && i < CACHE_MOST_OPENING && r2 < kOpen * kOpen * here.radius * here.radius) {
      node = 4u * node + 1u;
      continue;
    }
    float c1 = height * inversesqrt(r2), c2 = meanCosine(here, -away * inversesqrt(r2));
#if SHARED_WITH_RAYS
    if (standsForCell) {
      if (counts) add(found, overCell(here, away, normal), layerStart + node);
    } else
#endif
    if (counts && c1 > 0.0 && c2 > 0.0)
      add(found, ofPoint(here.flux, here.area, c1, c2, r2), layerStart + node);
    // The next node that is not below this one.
    for (int up = treeDepth; up > 0 && node != root && (node & 3u) == 0u; --up) node = (node - 1u) >> 2u;
    if (node != root) {
      ++node;
      continue;
    }
    top += uint(CACHE_LANES);
    node = root = firstTop + (top & ((1u << topBits) - 1u));
    layerStart = (top >> topBits) * ofLayer;
  }
#if !PERSPECTIVE
  for (int i = 0; i < CACHE_MOST_NEAR && i < nears; ++i)
    add(found, surfelIrradiance(rsmSurfel(ivec3(texelOf(near[i]), 0)), position, normal), near[i]);
#endif
  return found;
}

#if VISIBILITY
// A leaf below a node, drawn in proportion to what its branches would give: not behind the record, nor turned away
// from it, since the node's own contribution leaves that out already. Those would count as hidden.
uint leafOf(uint node, vec3 position, vec3 normal, float xi) {
  uint ofLayer = treeNodesOfLayer(), layerStart = node / ofLayer * ofLayer, leaves = layerStart + treeFirst(treeDepth);
  for (int level = treeDepth; level > 0 && node < leaves; --level) {
    uint child = layerStart + 4u * (node - layerStart) + 1u;
    vec4 given;
    for (int i = 0; i < 4; ++i) {
      LightNode here = nodeAt(child + uint(i));
      vec3 away = here.position - position;
      float r2 = max(dot(away, away), 1e-30);
      given[i] = here.radius < 0.0 ? 0.0
                                   : (here.flux.r + here.flux.g + here.flux.b) * max(dot(normal, away), 0.0) *
                                         meanCosine(here, -away * inversesqrt(r2)) * inversesqrt(r2) / r2;
    }
    float sum = given.x + given.y + given.z + given.w;
    if (!(sum > 0.0)) break;
    xi *= sum;
    int pick = 0;
    for (; pick < 3 && !(xi < given[pick]); ++pick) xi -= given[pick];
    // By rounding beyond the last of them.
    for (int i = 3; i > 0 && !(given[pick] > 0.0); --i) pick = max(pick - 1, 0);
    xi = clamp(xi / given[pick], 0.0, 0.9999999);
    node = child + uint(pick);
  }
  return node;
}

// Whether light from a node's place arrives.
bool arrives(CacheRecord record, uint node) {
  LightNode end = nodeAt(node);
  Surface surface = surfaceOf(record);
  vec3 from = offsetRay(surface.position, surface.geometricNormal, surface.magnitude),
       direction = end.position + rayEnd * end.normal - cache.rayOrigin - from;
  return dot(direction, surface.geometricNormal) > 0.0 && !anyHit(Ray(from, 0.0, direction, 1.0), record.triangle);
}
#endif

void main() {
  uint lane = gl_LocalInvocationID.x, place = firstGroup + gl_WorkGroupID.x;
  if (place >= uint(lit.length())) return;
  uint index = lit[place];
  if (index >= uint(records.length())) return;
  CacheRecord record = records[index];
  if ((record.state & CACHE_ALONE) != 0u) return;  // what sees no surface lights none
#if SHARED_WITH_RAYS
  standsForCell = cell > 0.0 && isNearSmallLamp(record.position - cache.rayOrigin, cell);
#endif
  uint seed = pcg4d(uvec4(record.cell)).x;
  Found found = gatherAt(record.position, record.normal, lane, pcg4d(uvec4(seed, lane, 0u, 0u)).x);
#if VISIBILITY
  // One ray per lane, to nodes that the lanes chose: as many of each lane as its share of all weights tells.
  weights[lane] = found.weight;
  colours[lane] = found.weight > 0.0 ? found.sum / found.weight : vec3(0.0);
  barrier();
  float before = 0.0, all = 0.0;
  for (uint i = 0u; i < uint(CACHE_LANES); ++i) {
    if (i == lane) before = all;
    all += weights[i];
  }
  rays[lane] = uvec2(0u);
  barrier();
  if (all > 0.0) {
    float raysPerWeight = float(CACHE_LANES) / all, offset = unitFloat(seed);
    int first = clampedInt(ceil(before * raysPerWeight - offset), 0, CACHE_LANES),
        end = clampedInt(ceil((before + found.weight) * raysPerWeight - offset), 0, CACHE_LANES);
    for (int i = first; i < CACHE_LANES && i < end; ++i) rays[i] = uvec2(1u + found.chosen[(i - first) & 3], lane);
  }
  barrier();
  bool open = false;
  sent[lane] = vec3(0.0);
  if (rays[lane].x != 0u) {
    sent[lane] = colours[rays[lane].y];
    open = arrives(record,
                   leafOf(rays[lane].x - 1u, record.position, record.normal, nextFloat(found.random)));
  }
  arrived[lane] = open ? sent[lane] : vec3(0.0);
#endif
  sums[lane] = found.sum;
  barrier();
  if (lane != 0u) return;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < CACHE_LANES; ++i) sum += sums[i];
#if VISIBILITY
  // A ratio of sums, exact where all rays arrive or none.
  vec3 ofAll = vec3(0.0), ofOpen = vec3(0.0);
  for (int i = 0; i < CACHE_LANES; ++i) {
    ofAll += sent[i];
    ofOpen += arrived[i];
  }
  sum *= ofOpen / max(ofAll, vec3(1e-30));
#endif
  records[index].irradiance = record.irradiance + sum;
  if (last != 0u) records[index].paths = CACHE_GATHERED;
}
