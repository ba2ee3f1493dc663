// Hemicubes, last pass: replaces pixel sums by the closed form where it is more accurate; pixels then supply only
// visibility. That applies to triangles that cover many pixels (exact except at the border), near ones (averaged over
// the receiving patch too [BaumRushmeierWinget1989]) and small sources. Each invocation takes entries of their list
// with the whole dispatch as stride.
#include "lib/clamped_int.glsl"
#include "radiosity/hemicube.glsl"
#include "radiosity/polygon.glsl"
#include "radiosity/triangle_parts.glsl"
layout(local_size_x = 64) in;
#if SOURCES
#include "rays/bvh.glsl"
uniform vec3 raysOrigin;  // in the hierarchy's space
#endif

#if ITEMS
layout(std430, binding = 7) readonly buffer KeptList { uvec4 keptHead; uvec2 keptList[]; };  // hemicube_keep.glsl
#endif
// the slot of the share receives the form factor
layout(std430, binding = 6) buffer ExactList { uint listed; uint padding; uvec2 list[]; };
uniform float nearDistance;  // a receiver is subdivided until (distance / size of a part) reaches this; 0: never
uniform int mostParts;       // per side, at most

// The mean over a triangle's points of the irradiance from a small, distant one, relative to that at its centroid, to
// second order. With the kernel N.v / |v|^4 (v from a point to the other's centroid, N its normal; the receiver's own
// cosine cancels) and the triangle's second moments M, the sum of c c^T / 12 over its corners c from its centroid, it
// is 1 + tr(M f'') / (2 f). At a distance of ten sizes the centroid alone is off by 0.3 %.
float meanOverCentroid(vec3 v, vec3 n, mat3 c) {
  // scale n, whose length cancels; in a scene of 1e6 units its square would overflow
  n /= max(max(abs(n.x), max(abs(n.y), abs(n.z))), 1e-30);
  vec3 alongV = v * c, alongN = n * c;
  float squares = dot(c[0], c[0]) + dot(c[1], c[1]) + dot(c[2], c[2]), r2 = dot(v, v), nv = dot(n, v),
        least = 1e-2 * sqrt(dot(n, n) * r2);
  nv = abs(nv) < least ? (nv < 0.0 ? -least : least) : nv;
  return 1.0 +
         (12.0 * dot(alongV, alongV) / (r2 * r2) - 2.0 * squares / r2 - 4.0 * dot(alongN, alongV) / (nv * r2)) / 12.0;
}

// Mean of the closed form over the receiver's visible area, sampled at the centroids of parts x parts equal triangles.
float meanOfParts(vec3 r0, vec3 r1, vec3 r2, int parts, uint hidden, Triangle t) {
  float sum = 0.0, open = 0.0;
  float side = 1.0 / float(parts);
  int i = 0, j = 0;  // strip and position in it: a strip has 2 (parts - i) - 1 parts, every second one upside down
  for (int k = 0; k < parts * parts || (k == parts * parts && open == 0.0); ++k) {  // ends: parts is clamped
    // use the hemicube's own position; also if every centroid lies in the hidden area
    bool own = parts == 1 && hidden != 0u || k == parts * parts;
    float third = (j & 1) == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
    float u = (float(i) + third) * side, v = (float(j / 2) + third) * side;
    vec3 at = own ? vec3(0.0) : r0 + u * (r1 - r0) + v * (r2 - r0);
    float counts = !own && ((hidden >> partAt(vec2(u, v))) & 1u) != 0u ? 0.0 : 1.0;
    sum += counts * pointToTriangle(t.a - at, t.b - at, t.c - at);
    open += counts;
    ++j;
    if (j >= 2 * (parts - i) - 1) ++i, j = 0;
  }
  return sum / open;
}

float receivedFrom(Frame frame, int self, Triangle t) {
  vec3 r0 = toFrame(frame, patchCorner(self, 0)), r1 = toFrame(frame, patchCorner(self, 1)),
       r2 = toFrame(frame, patchCorner(self, 2));
  float size = sqrt(0.5 * length(cross(r1 - r0, r2 - r0)));
  float away = max(
      length((t.a + t.b + t.c) / 3.0) - 0.5 * max(length(t.b - t.a), max(length(t.c - t.b), length(t.a - t.c))), 0.0);
  float wanted = nearDistance * size / max(away, 1e-3 * size);
  int parts = clampedInt(ceil(wanted), 1, mostParts);
  if (nearDistance <= 0.0) return pointToTriangle(t.a, t.b, t.c);
  uint hidden = uint(frame.u.w);  // bounded: one bit for each of kPatchParts
  if (parts == 1 && hidden == 0u) {
    vec3 middle = (r0 + r1 + r2) / 3.0;
    return pointToTriangle(t.a, t.b, t.c) * clamp(meanOverCentroid((t.a + t.b + t.c) / 3.0, cross(t.b - t.a, t.c - t.a),
                                                                   mat3(r0 - middle, r1 - middle, r2 - middle)),
                                                  0.8, 1.2);
  }
  if (parts < mostParts) parts += parts & 1;
  float fine = meanOfParts(r0, r1, r2, parts, hidden, t);
  if (hidden != 0u || (parts & 1) != 0) return fine;
  // The centroids' error falls with the square of the number of parts: Richardson extrapolation from half as many
  // [Richardson1911].
  return max(fine + (fine - meanOfParts(r0, r1, r2, parts / 2, hidden, t)) / 3.0, 0.0);
}

#if SOURCES
// Whether nothing blocks the line from the hemicube's centre to the centroid of a source that no pixel's centre hit.
// Pixels beside it cannot tell: on a concave surface its plane runs behind theirs, on a convex one theirs before it.
// Surfaces in the patch's own plane and on the source are ignored.
bool isSeen(Frame frame, int self, Triangle t) {
  vec3 m = (t.a + t.b + t.c) / 3.0;
  if (m.z * frame.origin.w < 1.0) return false;
  Ray ray = Ray(frame.origin.xyz - raysOrigin, 1.0 / (frame.origin.w * m.z),
                m.x * frame.u.xyz + m.y * frame.v.xyz + m.z * frame.n.xyz, 1.0);
  return !anyHitToLamp(ray, uint(self));
}
#endif

void main() {
  uint stride = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  uint i = gl_GlobalInvocationID.x, last = min(uint(list.length()), listed);
  if (i >= last) return;
  do {
#if ITEMS
    int entry = int(keptList[list[i].x].x);
#else
    int entry = int(list[i].x);
#endif
    int hemicube = entry / patchCount, index = entry % patchCount;
    float share = uintBitsToFloat(list[i].y);
    Frame frame = frames[hemicube];
    Triangle t = triangleOf(frame, index);
#if SOURCES
    if (share < 0.0) share = isSeen(frame, firstPatch + hemicube, t) ? 1.0 : 0.0;
#endif
    list[i].y = floatBitsToUint(share * receivedFrom(frame, firstPatch + hemicube, t));
    i += stride;
  } while (i < last);  // ends: stride is above 0
}
