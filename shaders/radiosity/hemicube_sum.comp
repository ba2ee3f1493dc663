// Hemicubes, pass 2: form factors. A triangle's form factor is the sum of the delta form factors of its visible pixels
// from pass 1. Writes the form factor, negative if a patch's back was seen. Form factors that pass 3
// (hemicube_exact.comp) computes more accurately are listed for it, with the visible share of their pixels.
// DRAWN 1: the GPU's rasteriser has drawn the pixels. ITEMS 1: pixels name their patches, hemicube_keep.glsl has
// already summed the visible ones, and sums here are over the covered pixels.
// LARGE 0: x: hemicubes of the batch, y: triangles; ITEMS: x: the list of visible patches. LARGE 1: the listed large
// triangles, one work group each; runs after pass 1, as it overwrites its data.
#include "radiosity/hemicube_walk.glsl"

layout(binding = 57) uniform usamplerBuffer keys;          // from pass 1
layout(binding = 58) uniform samplerBuffer deltaFactors;   // the full face, then one half face
#if ITEMS
#include "radiosity/hemicube_keep.glsl"
uniform int sourceCount;  // small sources
#else
layout(std430, binding = 4) writeonly buffer Factors { float factors[]; };  // hemicube-major
layout(std430, binding = 5) readonly buffer Sources { uint sources[]; };    // 1 where a patch is a small source
#endif
// slot of the form factor; share as bits, negative: no pixel
layout(std430, binding = 6) buffer ExactList { uint listed; uint padding; uvec2 list[]; };
uniform int exactPixels;  // triangles expected to cover this many use the closed form; 0: never

// Whether a triangle is large enough to be expected to cover exactPixels. Its solid angle decides, not the pixels that
// happened to fall into it: with actual counts, triangles that received more than their share would lose the excess
// to the closed form while those with less kept their deficit, and a surface of triangles of about that size came out
// 0.2 % too small.
bool isExact(Triangle t) {
  vec3 m = (t.a + t.b + t.c) / 3.0;
  float depth = max(m.z, max(abs(m.x), abs(m.y)));
  // Its area over depth^2 as the face sees it; for triangles that cross the horizon, roughly the part above.
  float high = max(t.a.z, max(t.b.z, t.c.z)), low = min(t.a.z, min(t.b.z, t.c.z)),
        above = low < 0.0 ? high / (high - low) : 1.0;
  return exactPixels > 0 && 0.5 * abs(dot(m, cross(t.b - t.a, t.c - t.a))) * above * above * halfSize * halfSize >=
                                float(exactPixels) * depth * depth * depth;
}

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

// place: hemicube * patchCount + patch; ITEMS: index in the list of visible patches.
void write(int place, int hemicube, int index, Triangle t, bool above, vec3 sum) {
  bool front = dot(t.a, cross(t.b, t.c)) < 0.0;
#if ITEMS
  int entry = hemicube * patchCount + index;
  sum.x = float(kept[entry]) * (1.0 / KEPT_WHOLE);
  kept[entry] = 0u;
  keptList[place].y = floatBitsToUint(front ? sum.x : -sum.x);
#else
  factors[place] = front ? sum.x : -sum.x;
#endif
  // For a large triangle its pixels give the visible fraction, unless it received far fewer than it should: a sliver,
  // or one cut by the horizon. The same holds for a small source in few pixels, except where the GPU has drawn them:
  // its rasteriser rounds edges differently from this pass, and a source of a pixel or two would lose light.
  bool exact = isExact(t) && 1.25 * sum.z >= float(exactPixels), source = sources[index] != 0u && above,
       pixelsTell = exact || (DRAWN == 0 && sum.z > 0.0);
  if (exactPixels > 0 && front && (pixelsTell ? sum.x > 0.0 && (exact || source) : source))
    list[atomicAdd(listed, 1u)] =
        uvec2(uint(place), floatBitsToUint(pixelsTell ? min(sum.x / max(sum.y, 1e-30), 1.0) : -1.0));
}

#if LARGE
shared vec3 sums[64];
#endif

void main() {
#if LARGE
  for (uint item = gl_WorkGroupID.x; item < uint(large.length()) && item < largeCount; item += gl_NumWorkGroups.x) {
    int place = int(large[item]);
#if ITEMS
    int entry = int(keptList[place].x);
#else
    int entry = place;
#endif
    int hemicube = entry / patchCount, index = entry % patchCount;
    Triangle t = triangleOf(frames[hemicube], index);
    vec3 sum = vec3(0.0);
    for (int row = int(gl_LocalInvocationID.x); row < 3 * faceSize; row += 64) {
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
      write(place, hemicube, index, t, true, sum);
    }
    barrier();
  }
#else
#if ITEMS
  int place = int(gl_GlobalInvocationID.x);
  if (place >= int(keptCount)) return;
  if (place < hemicubes * sourceCount)
    keptList[place].x = uint(place / sourceCount * patchCount) + sources[patchCount + place % sourceCount];
  int entry = int(keptList[place].x), hemicube = entry / patchCount, index = entry % patchCount, end = hemicube + 1;
#else
  int index = int(gl_WorkGroupID.y * 64u + gl_LocalInvocationID.x);
  if (index >= patchCount) return;
  int hemicube = int(gl_WorkGroupID.x) * hemicubesEach, end = min(hemicube + hemicubesEach, hemicubes);
#endif
  Triangle world = worldTriangle(index);
  do {
    Frame frame = frames[hemicube];
    Triangle t = toFrame(frame, world);
    bool above = isAbove(frame, t, index, firstPatch + hemicube), tooLarge = false;
#if ITEMS
    bool wanted = exactPixels > 0 && above;
#else
    int place = hemicube * patchCount + index;
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
    if (!tooLarge) write(place, hemicube, index, t, above, sum);
  } while (++hemicube < end);  // ends: both follow from uniforms
#endif
}
