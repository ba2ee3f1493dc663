// Hemicubes, pass 3: where the closed form tells more than pixels can, it replaces their sum, and pixels tell visibility alone: for what covers
// many pixels (exact but for its border), what is near (averaged over the receiving patch too [BaumRushmeierWinget1989]), and small sources.
// Each invocation takes entries of pass 2's list, a stride of the whole dispatch apart.
#include "radiosity/hemicube.glsl"
#include "radiosity/polygon.glsl"
#include "radiosity/triangle_parts.glsl"
layout(local_size_x = 64) in;

layout(binding = 57) uniform usamplerBuffer keys;  // of pass 1
#if ITEMS
#include "radiosity/hemicube_keep.glsl"
#endif
layout(std430, binding = 6) buffer ExactList { uint listed; uint padding; uvec2 list[]; };  // the share's place takes the form factor
uniform float nearDistance;  // a receiver is divided so that (distance / size of a part) reaches this; 0: never
uniform int mostParts;       // a side, at most

// Mean over what is not hidden of the receiver, of the closed form, from the centroids of parts x parts equal triangles.
float receivedFrom(Frame frame, int self, Triangle t) {
  vec3 r0 = toFrame(frame, patchCorner(self, 0)), r1 = toFrame(frame, patchCorner(self, 1)), r2 = toFrame(frame, patchCorner(self, 2));
  float size = sqrt(0.5 * length(cross(r1 - r0, r2 - r0)));
  float away = max(length((t.a + t.b + t.c) / 3.0) - 0.5 * max(length(t.b - t.a), max(length(t.c - t.b), length(t.a - t.c))), 0.0);
  float wanted = nearDistance * size / max(away, 1e-3 * size);
  int parts = clamp(int(ceil(wanted)), 1, mostParts);
  if (nearDistance <= 0.0) parts = 1;
  uint hidden = uint(frame.u.w);
  float sum = 0.0, open = 0.0;
  float side = 1.0 / float(parts);
  int i = 0, j = 0;  // strip and place in it: 2 (parts - i) - 1 parts, every second upside down
  for (int k = 0; k < parts * parts || open == 0.0; ++k) {
    bool own = parts == 1 || k == parts * parts;  // where the hemicube stands; also where each centroid lies in what is hidden
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

// Whether a source that no pixel's centre met is the nearest at the pixel that its centroid falls in, were it to fill that pixel.
bool nearestAtCentroid(Frame frame, Triangle t, int firstPixel) {
  vec3 m = (t.a + t.b + t.c) / 3.0;
  vec2 side = abs(m.xy);
  int face = m.z >= max(side.x, side.y) ? 0 : side.x >= side.y ? (m.x > 0.0 ? 1 : 3) : (m.y > 0.0 ? 2 : 4);
  vec3 p = toFace(face, m);
  vec2 low = vec2(-1.0, face == 0 ? -1.0 : 0.0);
  ivec2 pixel = clamp(ivec2((p.xy / p.z - low) * halfSize), ivec2(0), ivec2(faceSize - 1, face == 0 ? faceSize - 1 : faceSize / 2 - 1));
  vec3 direction = pixelDirection(face, pixel);
  uint seen = texelFetch(keys, firstPixel + facePixels(face) + pixel.y * faceSize + pixel.x).x;
#if ITEMS
  float nearest = seen == 0u ? 0.0 : inverseAlong(triangleOf(frame, int(seen) - 1), direction);
#else
  float nearest = uintBitsToFloat(seen & ~15u);
#endif
  return m.z > 0.0 && inverseAlong(t, direction) * 1.001 >= nearest;
}

void main() {
  for (uint i = gl_GlobalInvocationID.x; i < listed; i += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
#if ITEMS
    int entry = int(keptList[list[i].x].x);
#else
    int entry = int(list[i].x);
#endif
    int hemicube = entry / patchCount, index = entry % patchCount;
    float share = uintBitsToFloat(list[i].y);
    Frame frame = frames[hemicube];
    Triangle t = triangleOf(frame, index);
    if (share < 0.0) share = nearestAtCentroid(frame, t, hemicube * pixelsPerHemicube()) ? 1.0 : 0.0;
    list[i].y = floatBitsToUint(share * receivedFrom(frame, firstPatch + hemicube, t));
  }
}
