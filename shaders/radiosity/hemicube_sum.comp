// Hemicubes, pass 2: form factors. A triangle's form factor is the sum of the delta form factors of the pixels that it kept in pass 1. Written:
// the form factor, negative where a patch's back was seen. What pass 3 (hemicube_exact.comp) knows better is listed for it, with the share of
// its pixels that was seen.
// ITEMS 1: pixels name their patches, and hemicube_keep.glsl has summed already what each kept; sums here are of what it covers.
// LARGE 0: x: triangles, y: hemicubes of the batch. LARGE 1: what pass 1 listed, a work group each; after it, as it writes over it.
#include "radiosity/hemicube_walk.glsl"
#include "radiosity/hemicube_keep.glsl"

layout(binding = 57) uniform usamplerBuffer keys;          // of pass 1
layout(binding = 58) uniform samplerBuffer deltaFactors;   // the full face, then one half face
layout(std430, binding = 4) buffer Factors { uint factors[]; };  // bits of floats, hemicube-major; ITEMS: first whole numbers
layout(std430, binding = 5) readonly buffer Sources { uint sources[]; };             // 1 where a patch is a small source
layout(std430, binding = 6) buffer ExactList { uint listed; uint padding; uvec2 list[]; };  // hemicube * patchCount + patch; share as bits, negative: no pixel
uniform int exactPixels;  // as many covered pixels, and the closed form is taken; 0: never

// The delta form factors: x of the pixels that the triangle kept, y of all that it covers, z their count.
vec3 sumOf(FaceTriangle f, int face, int firstPixel, int index) {
  vec3 sum = vec3(0.0);
  int start = firstPixel + facePixels(face), toDelta = (face == 0 ? 0 : 2 * halfFacePixels) - start;
  Walk w = beginWalk(f, face, start);
  do {
    vec4 value = valueAt(w);
    int pixel = w.rowStart + w.column;
    float delta = covers(w, value) ? texelFetch(deltaFactors, toDelta + pixel).x : 0.0;
#if ITEMS
    sum.yz += vec2(delta, delta > 0.0 ? 1.0 : 0.0);
#else
    sum += vec3(texelFetch(keys, pixel).x == keyOf(value.w, f.front, uint(index)) ? delta : 0.0, delta, delta > 0.0 ? 1.0 : 0.0);
#endif
    advance(w, f);
  } while (w.row <= f.high.y);
  return sum;
}

void write(int hemicube, int index, Triangle t, bool above, vec3 sum) {
  int entry = hemicube * patchCount + index;
#if ITEMS
  sum.x = float(factors[entry]) * (1.0 / KEPT_WHOLE);
#endif
  bool front = dot(t.a, cross(t.b, t.c)) < 0.0;
  factors[entry] = floatBitsToUint(front ? sum.x : -sum.x);
  bool source = sources[index] != 0u && above && (sum.z == 0.0 || sum.x > 0.0);
  if (exactPixels > 0 && front && (source || (sum.z >= float(exactPixels) && sum.x > 0.0)))
    list[atomicAdd(listed, 1u)] = uvec2(uint(entry), floatBitsToUint(sum.z > 0.0 ? min(sum.x / sum.y, 1.0) : -1.0));
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
      f.low.y = max(f.low.y, place.y);
      f.high.y = min(f.high.y, place.y);
      sum += sumOf(f, place.x, hemicube * pixelsPerHemicube(), index);
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
  int index = int(gl_WorkGroupID.y * 64u + gl_LocalInvocationID.x);
  if (index >= patchCount) return;
  Triangle world = worldTriangle(index);
  int hemicube = int(gl_WorkGroupID.x) * hemicubesEach, end = min(hemicube + hemicubesEach, hemicubes);
  do {
    Frame frame = frames[hemicube];
    Triangle t = toFrame(frame, world);
    bool above = isAbove(frame, t, index, firstPatch + hemicube), tooLarge = false;
#if ITEMS
    int entry = hemicube * patchCount + index;
    bool wanted = exactPixels > 0 && above && (sources[index] != 0u || factors[entry] != 0u);
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
    } while (faces != 0u);
#if ITEMS
    if (tooLarge) listLarge(entry);  // else pass 1 has done so
#endif
    if (!tooLarge) write(hemicube, index, t, above, sum);
  } while (++hemicube < end);
#endif
}
