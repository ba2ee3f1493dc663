// Hemicubes by raster: each pixel's nearest surface, of patches that hemicube_points.comp has listed.
// LARGE 0: x: groups that share a hemicube's list, y: hemicubes of the batch. LARGE 1: the large triangles listed by
// it, one work group each.
#include "radiosity/hemicube_walk.glsl"
#include "radiosity/hemicube_lists.glsl"
#include "radiosity/hemicube_large.glsl"

layout(std430, binding = 2) buffer Keys { uint keys[]; };

void draw(FaceTriangle f, int face, int firstPixel, int index, float nearness) {
  Walk w = beginWalk(f, face, firstPixel + facePixels(face));
  do {
    vec4 value = valueAt(w);
    if (covers(w, value)) atomicMax(keys[w.rowStart + w.column], keyOf(value.w * nearness, f.front, uint(index)));
    advance(w, f);
  } while (w.row <= f.high.y);  // ends: rows and columns are clamped to the face
}

void main() {
#if LARGE
  uint item = gl_WorkGroupID.x, last = min(uint(large.length()), largeCount);
  if (item >= last) return;
  do {
    int hemicube = int(large[item]) / patchCount, index = int(large[item]) % patchCount;
    Triangle t = triangleOf(frames[hemicube], index);
    int row = int(gl_LocalInvocationID.x);
    do {
      ivec2 place = faceAndRow(row);
      FaceTriangle f = onFace(place.x, t);
      f.low.y = max(f.low.y, place.y);
      f.high.y = min(f.high.y, place.y);
      if (row >= 3 * faceSize) f.high.y = -1;
      draw(f, place.x, hemicube * pixelsPerHemicube(), index, nearnessOf(index));
      row += 64;
    } while (row < 3 * faceSize);  // ends: row grows
    item += gl_NumWorkGroups.x;
  } while (item < last);  // ends: item grows
#else
  int hemicube = int(gl_WorkGroupID.y), slot = int(gl_GlobalInvocationID.x), end = int(listLengths[hemicube + kWalks]);
  if (slot >= end) return;
  Frame frame = frames[hemicube];
  do {
    int index = int(patches[walkEntry(hemicube, slot)]);
    Triangle t = triangleOf(frame, index);
    float nearness = nearnessOf(index);
    uint faces = facesOf(t);
    bool tooLarge = false;
    do {
      int face = lowestFace(faces);
      FaceTriangle f = onFace(face, t);
      bool large = isLarge(f) && faces != 0u;
      tooLarge = tooLarge || large;
      if (large || faces == 0u) f.high.y = -1;
      draw(f, face, hemicube * pixelsPerHemicube(), index, nearness);
      faces &= faces - 1u;
    } while (faces != 0u);  // ends: each iteration clears a bit
    if (tooLarge) listLarge(hemicube * patchCount + index);
    slot += int(gl_NumWorkGroups.x) * 64;
  } while (slot < end);  // ends: slot grows
#endif
}
