// Hemicubes: form factors of patches by a walk over their pixels: the sum of the delta form factors of those in which
// they are visible.
// DRAWN 1: the GPU's rasteriser has drawn the pixels. ITEMS 1: pixels name their patches, hemicube_keep.glsl has
// already summed the visible ones, and sums here are over the covered pixels.
// LARGE 0: x: groups that share a hemicube's list, y: hemicubes of the batch; ITEMS: x: the list of visible patches.
// LARGE 1: the listed large triangles, one work group each.
#include "radiosity/hemicube_walk.glsl"
#include "radiosity/hemicube_large.glsl"
#if !ITEMS
#include "radiosity/hemicube_lists.glsl"
#endif

layout(binding = 57) uniform usamplerBuffer keys;          // raster: nearest; others: patches
layout(binding = 58) uniform samplerBuffer deltaFactors;   // the full face, then one half face
#if ITEMS
#include "radiosity/hemicube_keep.glsl"
uniform int sourceCount;  // small sources
#endif
#include "radiosity/hemicube_write.glsl"

// Sums of delta form factors: x over the triangle's visible pixels, y over all that it covers, z their count.
vec3 sumOf(FaceTriangle f, int face, int firstPixel, int index) {
  vec3 sum = vec3(0.0);
  int start = firstPixel + facePixels(face), toDelta = (face == 0 ? 0 : 2 * halfFacePixels) - start;
  Walk w = beginWalk(f, face, start);
#if !ITEMS
  float nearness = nearnessOf(index);
#endif
  do {
    vec4 value = valueAt(w);
    int pixel = w.rowStart + w.column;
    float delta = covers(w, value) ? texelFetch(deltaFactors, toDelta + pixel).x : 0.0;
#if ITEMS
    sum.yz += vec2(delta, delta > 0.0 ? 1.0 : 0.0);
#else
    bool nearest = texelFetch(keys, pixel).x == keyOf(value.w * nearness, f.front, uint(index));
    sum += vec3(nearest ? delta : 0.0, delta, delta > 0.0 ? 1.0 : 0.0);
#endif
    advance(w, f);
  } while (w.row <= f.high.y);  // ends: rows and columns are clamped to the face
  return sum;
}

#if LARGE
shared vec3 sums[64];
#else
// place: as in write()
void visit(int place, int hemicube, int index, Frame frame) {
  Triangle t = triangleOf(frame, index);
  bool above = isAbove(frame, t, index, firstPatch + hemicube), tooLarge = false;
#if ITEMS
  bool wanted = exactPixels > 0 && above;
#else
  bool wanted = above;
#endif
  uint faces = wanted ? facesOf(t) : 0u;
  vec3 sum = vec3(0.0);
  do {
    int face = lowestFace(faces);
    FaceTriangle f = onFace(face, t);
    bool large = isLarge(f) && faces != 0u;
    tooLarge = tooLarge || large;
    if (large || faces == 0u) f.high.y = -1;
    sum += sumOf(f, face, hemicube * pixelsPerHemicube(), index);
    faces &= faces - 1u;
  } while (faces != 0u);  // ends: each iteration clears a bit
#if ITEMS
  if (tooLarge) listLarge(place);  // otherwise pass 1 has done so
#endif
  if (!tooLarge) write(place, hemicube, index, isFront(t), isExactSize(t), sources[index] != 0u && above, sum);
}
#endif

void main() {
#if LARGE
  uint item = gl_WorkGroupID.x, last = min(uint(large.length()), largeCount);
  if (item >= last) return;
  do {
    int place = int(large[item]);
#if ITEMS
    int entry = int(keptList[place].x);
#else
    int entry = place;
#endif
    int hemicube = entry / patchCount, index = entry % patchCount;
    Triangle t = triangleOf(frames[hemicube], index);
    vec3 sum = vec3(0.0);
    int row = int(gl_LocalInvocationID.x);
    do {
      ivec2 place = faceAndRow(row);
      FaceTriangle f = onFace(place.x, t);
      f.low.y = max(f.low.y, place.y);
      f.high.y = min(f.high.y, place.y);
      if (row >= 3 * faceSize) f.high.y = -1;
      sum += sumOf(f, place.x, hemicube * pixelsPerHemicube(), index);
      row += 64;
    } while (row < 3 * faceSize);  // ends: row grows
    sums[gl_LocalInvocationID.x] = sum;
    barrier();
    if (gl_LocalInvocationID.x == 0u) {
      for (int k = 1; k < 64; ++k) sum += sums[k];
      write(place, hemicube, index, isFront(t), isExactSize(t), sources[index] != 0u, sum);
    }
    barrier();
    item += gl_NumWorkGroups.x;
  } while (item < last);  // ends: item grows
#else
#if ITEMS
  int place = int(gl_GlobalInvocationID.x);
  if (place >= int(keptCount)) return;
  if (place < hemicubes * sourceCount)
    keptList[place].x = uint(place / sourceCount * patchCount) + sources[patchCount + place % sourceCount];
  int entry = int(keptList[place].x);
  visit(place, entry / patchCount, entry % patchCount, frames[entry / patchCount]);
#else
  int hemicube = int(gl_WorkGroupID.y), slot = int(gl_GlobalInvocationID.x), end = int(listLengths[hemicube + kWalks]);
  if (slot >= end) return;
  Frame frame = frames[hemicube];
  do {
    int index = int(patches[walkEntry(hemicube, slot)]);
    visit(hemicube * patchCount + index, hemicube, index, frame);
    slot += int(gl_NumWorkGroups.x) * 64;
  } while (slot < end);  // ends: slot grows
#endif
#endif
}
