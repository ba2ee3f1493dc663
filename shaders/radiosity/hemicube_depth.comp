// Hemicubes, pass 1: each pixel's nearest surface.
// LARGE 0: x: triangles, y: hemicubes of the batch. LARGE 1: the large triangles listed by it, one work group each.
#include "radiosity/hemicube_walk.glsl"

layout(std430, binding = 2) buffer Keys { uint keys[]; };

void draw(FaceTriangle f, int face, int firstPixel, int index) {
  Walk w = beginWalk(f, face, firstPixel + facePixels(face));
  float nearness = nearnessOf(index);
  do {
    vec4 value = valueAt(w);
    if (covers(w, value)) atomicMax(keys[w.rowStart + w.column], keyOf(value.w * nearness, f.front, uint(index)));
    advance(w, f);
  } while (w.row <= f.high.y);  // ends: rows and columns are clamped to the face
}

void main() {
#if LARGE
  for (uint item = gl_WorkGroupID.x; item < uint(large.length()) && item < largeCount; item += gl_NumWorkGroups.x) {
    int hemicube = int(large[item]) / patchCount, index = int(large[item]) % patchCount;
    Triangle t = triangleOf(frames[hemicube], index);
    for (int row = int(gl_LocalInvocationID.x); row < 3 * faceSize; row += 64) {
      ivec2 place = faceAndRow(row);
      FaceTriangle f = onFace(place.x, t);
      f.low.y = max(f.low.y, place.y);
      f.high.y = min(f.high.y, place.y);
      draw(f, place.x, hemicube * pixelsPerHemicube(), index);
    }
  }
#else
  int index = int(gl_WorkGroupID.y * 64u + gl_LocalInvocationID.x);
  if (index >= patchCount) return;
  Triangle world = worldTriangle(index);
  int hemicube = int(gl_WorkGroupID.x) * hemicubesEach, end = min(hemicube + hemicubesEach, hemicubes);
  do {
    Frame frame = frames[hemicube];
    Triangle t = toFrame(frame, world);
    uint faces = isAbove(frame, t, index, firstPatch + hemicube) ? facesOf(t) : 0u;
    bool tooLarge = false;
    do {
      int face = lowestFace(faces);
      FaceTriangle f = onFace(face, t);
      bool large = isLarge(f) && faces != 0u;
      tooLarge = tooLarge || large;
      if (large || faces == 0u) f.high.y = -1;
      draw(f, face, hemicube * pixelsPerHemicube(), index);
      faces &= faces - 1u;
    } while (faces != 0u);  // ends: each iteration clears a bit
    if (tooLarge) listLarge(hemicube * patchCount + index);
  } while (++hemicube < end);  // ends: both follow from uniforms
#endif
}
