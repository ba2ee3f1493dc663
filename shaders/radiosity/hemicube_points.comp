// Hemicubes: patches whose bounding box on a face holds at most one pixel's centre. In a fine mesh most are such, and
// need no walk over pixels.
// SUM 0, pass 1: draws those that cover this pixel and lists them, lists patches of several pixels or faces for the
// walk (hemicube_depth.comp). x: blocks of 64 triangles, y: kHemicubesEach of the batch.
// SUM 1, after all passes that draw: their form factors. x: groups that share a hemicube's list, y: hemicubes.
#include "radiosity/hemicube_walk.glsl"
#include "radiosity/hemicube_lists.glsl"

#if SUM
layout(binding = 57) uniform usamplerBuffer keys;
layout(binding = 58) uniform samplerBuffer deltaFactors;  // the full face, then one half face
#include "radiosity/hemicube_write.glsl"
#else
layout(std430, binding = 2) buffer Keys { uint keys[]; };
layout(std430, binding = 5) readonly buffer Sources { uint sources[]; };  // 1 where a patch is a small source
// By kHemicubesEach: the blocks that are not below the horizon of all of them; ~0 after the last.
layout(std430, binding = 1) readonly buffer Blocks { uint blocks[]; };
const int kHemicubesEach = 4;
#endif

struct Point {
  bool within;   // all corners in one face, whose pixels may hold one centre at most
  bool covered;  // this centre
  bool front;
  int pixel;     // in the hemicube
  uint key;
};

float least(vec3 v) { return min(v.x, min(v.y, v.z)); }
float most(vec3 v) { return max(v.x, max(v.y, v.z)); }

// As onFace() and valueAt() of hemicube_walk.glsl, for the same bits, but for one face and one pixel.
Point pointOf(Triangle t, int index, float nearness) {
  // The face that sees the first corner, and all corners in it (toFace()). x, y, z: of the three corners.
  vec2 size = abs(t.a.xy);
  bool alongX = size.x >= size.y, top = t.a.z >= max(size.x, size.y), back = (alongX ? t.a.x : t.a.y) < 0.0;
  vec3 x = vec3(t.a.x, t.b.x, t.c.x), y = vec3(t.a.y, t.b.y, t.c.y), z = vec3(t.a.z, t.b.z, t.c.z);
  vec3 across = alongX ? y : -x, along = alongX ? x : y;
  if (back) across = -across, along = -along;
  x = top ? x : across;
  y = top ? y : z;
  z = top ? z : along;
  vec3 inverseZ = 1.0 / z, px = x * inverseZ, py = y * inverseZ;
  float bottom = top ? -1.0 : 0.0;
  vec2 low = vec2(least(px), least(py)), high = vec2(most(px), most(py)),
       first = ceil((low + vec2(1.0, -bottom)) * halfSize - 0.501),
       last = floor((high + vec2(1.0, -bottom)) * halfSize - 0.499);
  bool beside = first.x > last.x || first.y > last.y;
  Point p;
  p.within = least(z) > 0.0 && low.x >= -1.0 && low.y >= bottom && max(high.x, high.y) <= 1.0 &&
             (beside || first == last);
  vec2 at = (first + 0.5) * pixelSize + vec2(-1.0, bottom);
  vec3 a = vec3(x.x, y.x, z.x), b = vec3(x.y, y.y, z.y), c = vec3(x.z, y.z, z.z), e0 = edge(b, c), e1 = edge(c, a),
       e2 = edge(a, b);
  float det = dot(a, e0);
  p.front = det < 0.0;
  vec3 inverse = (e0 + e1 + e2) / det;
  vec4 value = vec4(e0.y, e1.y, e2.y, inverse.y) * at.y + vec4(e0.z, e1.z, e2.z, inverse.z);
  value += vec4(e0.x, e1.x, e2.x, inverse.x) * at.x;
  p.covered = p.within && !beside && (p.front ? most(value.xyz) <= 0.0 : det > 0.0 && least(value.xyz) >= 0.0) &&
              value.w > 0.0;
  int face = top ? 0 : (alongX ? 1 : 2) + (back ? 2 : 0);
  p.pixel = facePixels(face) + int(p.covered ? first.y * float(faceSize) + first.x : 0.0);  // bounded: in the face
  p.key = keyOf(value.w * nearness, p.front, uint(index));
  return p;
}

#if !SUM
void visit(int hemicube, int index, Triangle world, float nearness, bool source) {
  Frame frame = frames[hemicube];
  Triangle t = toFrame(frame, world);
  Point p = pointOf(t, index, nearness);
  bool above = isAbove(frame, t, index, firstPatch + hemicube), draws = above && p.covered, walks = above && !p.within;
  if (draws) atomicMax(keys[hemicube * pixelsPerHemicube() + p.pixel], p.key);
  if (draws || walks || above && source) {
    uint slot = atomicAdd(listLengths[hemicube + (walks ? kWalks : kPoints)], 1u);
    patches[walks ? walkEntry(hemicube, int(slot)) : pointEntry(hemicube, int(slot))] = uint(index);
  }
}

void main() {
  uint at = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (at >= uint(blocks.length()) || blocks[at] == 0xffffffffu) return;
  uint lane = blocks[at] * 64u + gl_LocalInvocationID.x;
  if (lane >= uint(patchCount)) return;
  int index = int(lane), first = int(gl_WorkGroupID.y) * kHemicubesEach;
  Triangle world = worldTriangle(index);
  float nearness = nearnessOf(index);
  bool source = sources[index] != 0u;
  // Not a loop: so every frame is the same for all lanes, and software renderers read it once.
  visit(first, index, world, nearness, source);
  if (first + 1 < hemicubes) visit(first + 1, index, world, nearness, source);
  if (first + 2 < hemicubes) visit(first + 2, index, world, nearness, source);
  if (first + 3 < hemicubes) visit(first + 3, index, world, nearness, source);
}
#else
void main() {
  int hemicube = int(gl_WorkGroupID.y), slot = int(gl_GlobalInvocationID.x), end = int(listLengths[hemicube + kPoints]);
  if (slot >= end) return;
  Frame frame = frames[hemicube];
  do {
    int index = int(patches[pointEntry(hemicube, slot)]);
    Triangle t = triangleOf(frame, index);
    Point p = pointOf(t, index, nearnessOf(index));
    float delta = 0.0;
    if (p.covered)
      delta = texelFetch(deltaFactors, p.pixel < 2 * halfFacePixels
                                           ? p.pixel
                                           : 2 * halfFacePixels + p.pixel % halfFacePixels).x;
    bool nearest = texelFetch(keys, hemicube * pixelsPerHemicube() + p.pixel).x == p.key;
    write(hemicube * patchCount + index, hemicube, index, p.front, isExactSize(t), sources[index] != 0u,
          vec3(nearest ? delta : 0.0, delta, p.covered ? 1.0 : 0.0));
    slot += int(gl_NumWorkGroups.x) * 64;
  } while (slot < end);  // ends: slot grows
}
#endif
