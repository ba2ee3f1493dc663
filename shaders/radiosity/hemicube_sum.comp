// Hemicubes, pass 2: form factors. A triangle's form factor is the sum of the delta form factors of the pixels that it kept in pass 1. Written:
// the form factor, negative where a patch's back was seen. What pass 3 (hemicube_exact.comp) knows better is listed for it, with the share of
// its pixels that was seen.
// LARGE 0: x: triangles, y: hemicubes of the batch. LARGE 1: what pass 1 listed, a work group each; after it, as it writes over it.
#include "radiosity/hemicube.glsl"

layout(std430, binding = 3) readonly buffer DeltaFactors { float deltaFactors[]; };  // the full face, then one half face
layout(std430, binding = 4) writeonly buffer Factors { float factors[]; };           // hemicube-major
layout(std430, binding = 5) readonly buffer Sources { uint sources[]; };             // 1 where a patch is a small source
layout(std430, binding = 6) buffer ExactList { uint listed; uint padding; uvec2 list[]; };  // hemicube * patchCount + patch; share as bits, negative: no pixel
layout(std430, binding = 7) buffer Shares { uvec2 shares[]; };  // of a hemicube that fronts and backs fill by pixels, in parts of 2^28
uniform int exactPixels;  // as many covered pixels, and the closed form is taken; 0: never

// Adds a row's delta form factors: x of the pixels that the triangle kept, y of all that it covers, z their count.
vec3 sumRow(FaceTriangle f, int face, int y, int firstPixel, int index) {
  vec3 sum = vec3(0.0);
  Row r = rowOf(f, pixelCentre(face, ivec2(0, y)).y);
  int inFace = y * faceSize;
  int at = firstPixel + facePixels(face) + inFace;
  int weightAt = inFace + (face == 0 ? 0 : faceSize * faceSize);
  for (int x = r.columns.x; x <= r.columns.y; ++x) {
    vec4 value = r.atZero + r.slope * pixelCentre(face, ivec2(x, y)).x;
    if (all(greaterThanEqual(value.xyz, vec3(0.0))) && value.w > 0.0) {
      float delta = deltaFactors[weightAt + x];
      sum += vec3(keys[at + x] == keyOf(value.w, f.front, uint(index)) ? delta : 0.0, delta, 1.0);
    }
  }
  return sum;
}

void write(int hemicube, int index, Triangle t, bool above, vec3 sum) {
  int entry = hemicube * patchCount + index;
  bool front = dot(t.a, cross(t.b, t.c)) < 0.0;
  factors[entry] = front ? sum.x : -sum.x;
  uint share = uint(sum.x * 268435456.0 + 0.5);  // whole numbers: their sum does not depend on the order
  if (share > 0u) {
    if (front) atomicAdd(shares[hemicube].x, share);
    else atomicAdd(shares[hemicube].y, share);
  }
  bool source = sources[index] != 0u && above && (sum.z == 0.0 || sum.x > 0.0);
  if (exactPixels > 0 && front && (source || (sum.z >= float(exactPixels) && sum.x > 0.0)))
    list[atomicAdd(listed, 1u)] = uvec2(uint(entry), floatBitsToUint(sum.z > 0.0 ? sum.x / sum.y : -1.0));
}

#if LARGE
shared vec3 sums[64];
#endif

void main() {
#if LARGE
  for (uint item = gl_WorkGroupID.x; item < largeCount; item += gl_NumWorkGroups.x) {
    int hemicube = int(large[item]) / patchCount, index = int(large[item]) % patchCount;
    Triangle t = triangleOf(frames[hemicube], index);
    vec3 sum = vec3(0.0);
    for (int row = int(gl_LocalInvocationID.x); row < rowsPerHemicube(); row += 64) {
      ivec2 place = faceAndRow(row);
      FaceTriangle f = onFace(place.x, t);
      if (place.y >= f.low.y && place.y <= f.high.y) sum += sumRow(f, place.x, place.y, hemicube * pixelsPerHemicube(), index);
    }
    sums[gl_LocalInvocationID.x] = sum;
    barrier();
    if (gl_LocalInvocationID.x == 0u) {
      for (int k = 1; k < 64; ++k) sum += sums[k];
      write(hemicube, index, t, true, sum);
    }
    barrier();
  }
#else
  int hemicube = int(gl_WorkGroupID.y);
  Frame frame = frames[hemicube];
  int first = int(gl_WorkGroupID.x) * 64 * trianglesEach + int(gl_LocalInvocationID.x);
  for (int i = 0; i < trianglesEach; ++i) {
    int index = first + 64 * i;
    if (index >= patchCount) break;
    Triangle t = triangleOf(frame, index);
    bool above = isAbove(frame, t, index, firstPatch + hemicube), tooLarge = false;
    vec3 sum = vec3(0.0);
    for (uint faces = above ? facesOf(t) : 0u; faces != 0u; faces &= faces - 1u) {
      int face = findLSB(faces);
      FaceTriangle f = onFace(face, t);
      if (isLarge(f)) {
        tooLarge = true;
        f.high.y = f.low.y - 1;
      }
      for (int y = f.low.y; y <= f.high.y; ++y) sum += sumRow(f, face, y, hemicube * pixelsPerHemicube(), index);
    }
    if (!tooLarge) write(hemicube, index, t, above, sum);
  }
#endif
}
