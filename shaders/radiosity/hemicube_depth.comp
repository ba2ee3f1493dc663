// Hemicubes, pass 1: each pixel's nearest surface.
// LARGE 0: x: triangles, y: hemicubes of the batch. LARGE 1: what that listed, a work group each.
#include "radiosity/hemicube.glsl"

void drawRow(FaceTriangle f, int face, int y, int firstPixel, int index) {
  Row r = rowOf(f, pixelCentre(face, ivec2(0, y)).y);
  int at = firstPixel + facePixels(face) + y * faceSize;
  for (int x = r.columns.x; x <= r.columns.y; ++x) {
    vec4 value = r.atZero + r.slope * pixelCentre(face, ivec2(x, y)).x;
    if (all(greaterThanEqual(value.xyz, vec3(0.0))) && value.w > 0.0) atomicMax(keys[at + x], keyOf(value.w, f.front, uint(index)));
  }
}

void main() {
#if LARGE
  for (uint item = gl_WorkGroupID.x; item < largeCount; item += gl_NumWorkGroups.x) {
    int hemicube = int(large[item]) / patchCount, index = int(large[item]) % patchCount;
    Triangle t = triangleOf(frames[hemicube], index);
    for (int row = int(gl_LocalInvocationID.x); row < rowsPerHemicube(); row += 64) {
      ivec2 place = faceAndRow(row);
      FaceTriangle f = onFace(place.x, t);
      if (place.y >= f.low.y && place.y <= f.high.y) drawRow(f, place.x, place.y, hemicube * pixelsPerHemicube(), index);
    }
  }
#else
  int hemicube = int(gl_WorkGroupID.y);
  Frame frame = frames[hemicube];
  int first = int(gl_WorkGroupID.x) * 64 * trianglesEach + int(gl_LocalInvocationID.x);
  for (int i = 0; i < trianglesEach; ++i) {
    int index = first + 64 * i;
    if (index >= patchCount) break;
    Triangle t = triangleOf(frame, index);
    bool tooLarge = false;
    for (uint faces = isAbove(frame, t, index, firstPatch + hemicube) ? facesOf(t) : 0u; faces != 0u; faces &= faces - 1u) {
      int face = findLSB(faces);
      FaceTriangle f = onFace(face, t);
      if (isLarge(f)) {
        tooLarge = true;
        f.high.y = f.low.y - 1;
      }
      for (int y = f.low.y; y <= f.high.y; ++y) drawRow(f, face, y, hemicube * pixelsPerHemicube(), index);
    }
    if (tooLarge) listLarge(hemicube * patchCount + index);
  }
#endif
}
