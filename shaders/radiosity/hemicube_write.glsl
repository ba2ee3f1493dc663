// Writes a form factor found by pixels, negative if a patch's back was seen. One that a closed form gives more
// accurately is listed for hemicube_exact.comp, with the visible share of its pixels.
#if !ITEMS
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
bool isExactSize(Triangle t) {
  vec3 m = (t.a + t.b + t.c) / 3.0;
  float depth = max(m.z, max(abs(m.x), abs(m.y)));
  // Its area over depth^2 as the face sees it; for triangles that cross the horizon, roughly the part above.
  float high = max(t.a.z, max(t.b.z, t.c.z)), low = min(t.a.z, min(t.b.z, t.c.z)),
        above = low < 0.0 ? high / (high - low) : 1.0;
  return exactPixels > 0 && 0.5 * abs(dot(m, cross(t.b - t.a, t.c - t.a))) * above * above * halfSize * halfSize >=
                                float(exactPixels) * depth * depth * depth;
}

bool isFront(Triangle t) { return dot(t.a, cross(t.b, t.c)) < 0.0; }

// place: hemicube * patchCount + patch; ITEMS: index in the list of visible patches.
void write(int place, int hemicube, int index, bool front, bool exactSize, bool source, vec3 sum) {
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
  bool exact = exactSize && 1.25 * sum.z >= float(exactPixels), pixelsTell = exact || (DRAWN == 0 && sum.z > 0.0);
  if (exactPixels > 0 && front && (pixelsTell ? sum.x > 0.0 && (exact || source) : source))
    list[atomicAdd(listed, 1u)] =
        uvec2(uint(place), floatBitsToUint(pixelsTell ? min(sum.x / max(sum.y, 1e-30), 1.0) : -1.0));
}
