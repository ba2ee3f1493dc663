// Hemicubes, pass 2: form factors. A triangle's form factor is the sum of the delta form factors of the pixels that it
// kept in pass 1. Written: the form factor, negative where a patch's back was seen. What pass 3 (hemicube_exact.comp)
// knows better is listed for it, with the share of its pixels that was seen.
// DRAWN 1: the GPU's rasteriser has drawn the pixels. ITEMS 1: pixels name their patches, and hemicube_keep.glsl has
// summed already what each kept; sums here are of what it covers.
// LARGE 0: x: hemicubes of the batch, y: triangles; ITEMS: x: what was listed as kept. LARGE 1: what is listed as
// large, a work group each; after pass 1, as it writes over it.
#include "radiosity/hemicube_walk.glsl"

layout(binding = 57) uniform usamplerBuffer keys;          // of pass 1
layout(binding = 58) uniform samplerBuffer deltaFactors;   // the full face, then one half face
#if ITEMS
#include "radiosity/hemicube_keep.glsl"
uniform int sourceCount;  // small sources
#else
layout(std430, binding = 4) writeonly buffer Factors { float factors[]; };  // hemicube-major
layout(std430, binding = 5) readonly buffer Sources { uint sources[]; };    // 1 where a patch is a small source
#endif
// place of the form factor; share as bits, negative: no pixel
layout(std430, binding = 6) buffer ExactList { uint listed; uint padding; uvec2 list[]; };
uniform int exactPixels;  // what should cover as many takes the closed form; 0: never

// Whether a triangle is so large that it should cover as many pixels as take the closed form: by its solid angle, not
// by the pixels that happened to fall into it. Were those counted, what is there by chance would decide: pieces that
// met more than their share would lose it to the closed form, those that met less would stay, and a surface cut into
// pieces about that size came out 0.2 % too small.
bool isExact(Triangle t) {
  vec3 m = (t.a + t.b + t.c) / 3.0;
  float depth = max(m.z, max(abs(m.x), abs(m.y)));
  // Its area over depth^2 as the face sees it; of what lies below the horizon the part above counts, roughly.
  float high = max(t.a.z, max(t.b.z, t.c.z)), low = min(t.a.z, min(t.b.z, t.c.z)),
        above = low < 0.0 ? high / (high - low) : 1.0;
  return exactPixels > 0 && 0.5 * abs(dot(m, cross(t.b - t.a, t.c - t.a))) * above * above * halfSize * halfSize >=
                                float(exactPixels) * depth * depth * depth;
}

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
    sum += vec3(texelFetch(keys, pixel).x == keyOf(value.w, f.front, uint(index)) ? delta : 0.0, delta,
                delta > 0.0 ? 1.0 : 0.0);
#endif
    advance(w, f);
  } while (w.row <= f.high.y);
  return sum;
}

// place: hemicube * patchCount + patch; ITEMS: in the list of what was kept.
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
  // Of what is large the pixels met tell how much is seen, unless it met far fewer than it should: a sliver, or what
  // the horizon cuts. So they do of a small source in few pixels, but where the GPU has drawn them: its rasteriser
  // rounds edges otherwise than this pass does, and a source of a pixel or two would lose by it.
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
  for (uint item = gl_WorkGroupID.x; item < largeCount; item += gl_NumWorkGroups.x) {
    int place = int(large[item]);
#if ITEMS
    int entry = int(keptList[place].x);
#else
    int entry = place;
#endif
    int hemicube = entry / patchCount, index = entry % patchCount;
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
    } while (faces != 0u);
#if ITEMS
    if (tooLarge) listLarge(place);  // else pass 1 has done so
#endif
    if (!tooLarge) write(place, hemicube, index, t, above, sum);
  } while (++hemicube < end);
#endif
}
