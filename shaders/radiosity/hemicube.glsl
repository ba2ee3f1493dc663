// Hemicubes [CohenGreenberg1985] without a projection matrix: a pixel's direction d = (x, y, 1) in a face's frame meets a triangle of corners
// a, b, c (seen from the hemicube's centre) where d . (a x b), d . (b x c) and d . (c x a) have the sign of det = a . (b x c), at the inverse
// distance (their sum) / det along d [Olano1997]. So nothing is clipped, there is no near plane, and what touches the centre still blocks.
//
// One invocation takes one triangle and one hemicube. Pass 1 keeps each pixel's nearest surface (hemicube_depth.comp), pass 2 sums the delta
// form factors of the pixels that a triangle kept (hemicube_sum.comp): no sorting, no histogram, and a sum's order never changes.
// What spans more than kMostPixels of a face is listed for a pass of its own, a work group a triangle, a lane a row: lanes stay busy, and no
// loop comes near the 65,535 turns after which Mesa's software renderer leaves any shader's loops.
// Layout of a hemicube's pixels: the full face N x N, then four half faces N x N/2, rows upwards from the horizon.
#include "radiosity/patch.glsl"

layout(local_size_x = 64) in;

struct Frame {
  vec4 origin;   // w: 1 / (distance below which a corner lies in the patch's plane)
  vec4 u, v, n;  // unit; n the patch's normal
};
layout(std430, binding = 1) readonly buffer Frames { Frame frames[]; };
layout(std430, binding = 2) buffer Keys { uint keys[]; };
layout(std430, binding = 8) buffer LargeList { uint largeGroups, one0, one1, largeCount; uint large[]; };  // hemicube * patchCount + patch; begins with an indirect dispatch
const int kMostPixels = 1024;
const uint kMostGroups = 65535u;

uniform int faceSize;       // N, even
uniform int firstPatch;     // of this batch
uniform int trianglesEach;  // an invocation's share of them, a stride of gl_WorkGroupSize.x apart

// The nearest surface has the largest key: inverse distance, its last bits taken for the front (which wins over a back at the same
// place: sheets of two fronts) and for the patch, so that a tie is settled alike in every run. Sheets that are cut along other diagonals
// differ by their rounding: a front counts as nearer by 64 units in the last place (4e-6 to 8e-6).
uint keyOf(float inverseDistance, bool front, uint patchIndex) {
  return ((floatBitsToUint(inverseDistance) + (front ? 64u : 0u)) & ~15u) | (front ? 8u : 0u) | (patchIndex & 7u);
}

struct Triangle {
  vec3 a, b, c;  // in the hemicube's frame: x along u, y along v, z along n
};

vec3 toFrame(Frame f, vec3 p) {
  vec3 d = p - f.origin.xyz;
  return vec3(dot(d, f.u.xyz), dot(d, f.v.xyz), dot(d, f.n.xyz));
}

Triangle triangleOf(Frame f, int index) {
  return Triangle(toFrame(f, patchCorner(index, 0)), toFrame(f, patchCorner(index, 1)), toFrame(f, patchCorner(index, 2)));
}

// Not the patch itself, nor what lies in its plane or below.
bool isAbove(Frame f, Triangle t, int index, int self) { return index != self && max(t.a.z, max(t.b.z, t.c.z)) * f.origin.w >= 1.0; }

// Face 0 looks along n; 1..4 along u, v, -u, -v with n upwards.
vec3 toFace(int face, vec3 p) {
  vec2 level = (face & 1) == 1 ? p.yx : vec2(-p.x, p.y);
  if (face > 2) level = -level;
  return face == 0 ? p : vec3(level.x, p.z, level.y);
}

bool anyLess(vec3 a, vec3 b) { return any(lessThan(a, b)); }

// A bit for each face that may see the triangle. Software renderers run both sides of a branch: so a lane goes on with the faces that it has,
// instead of asking five times.
uint facesOf(Triangle t) {
  vec3 x = vec3(t.a.x, t.b.x, t.c.x), y = vec3(t.a.y, t.b.y, t.c.y), z = vec3(t.a.z, t.b.z, t.c.z), none = vec3(0.0);
  bool xBelowZ = anyLess(x, z), yBelowZ = anyLess(y, z), minusXBelowZ = anyLess(-x, z), minusYBelowZ = anyLess(-y, z);
  bool xBelowY = anyLess(x, y), yBelowX = anyLess(y, x), minusXBelowY = anyLess(-x, y), sumNegative = anyLess(x, -y);
  uint faces = xBelowZ && yBelowZ && minusXBelowZ && minusYBelowZ ? 1u : 0u;
  if (anyLess(none, x) && anyLess(z, x) && yBelowX && minusXBelowY) faces |= 2u;
  if (anyLess(none, y) && anyLess(z, y) && xBelowY && minusXBelowY) faces |= 4u;
  if (anyLess(x, none) && anyLess(z, -x) && xBelowY && sumNegative) faces |= 8u;
  if (anyLess(y, none) && anyLess(z, -y) && yBelowX && sumNegative) faces |= 16u;
  return anyLess(none, z) ? faces : 0u;
}

int facePixels(int face) { return face == 0 ? 0 : faceSize * faceSize + (face - 1) * (faceSize * faceSize / 2); }
int pixelsPerHemicube() { return 3 * faceSize * faceSize; }

// A triangle as one face sees it: what a pixel needs.
struct FaceTriangle {
  vec3 e0, e1, e2;   // edge functions over (x, y, 1), positive inside
  vec3 inverse;      // inverse distance over (x, y, 1)
  ivec2 low, high;   // pixels to look at, inclusive
  bool front;
};

// Neighbours take an edge in opposite senses; without contraction the products are the same, so no pixel falls between them.
vec3 edge(vec3 a, vec3 b) {
  precise vec3 across = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  return across;
}

FaceTriangle onFace(int face, Triangle t) {
  FaceTriangle r;
  vec3 a = toFace(face, t.a), b = toFace(face, t.b), c = toFace(face, t.c);
  float bottom = face == 0 ? -1.0 : 0.0;  // half faces end at the horizon
  vec3 x = vec3(a.x, b.x, c.x), y = vec3(a.y, b.y, c.y), z = vec3(a.z, b.z, c.z);
  vec3 e0 = edge(b, c), e1 = edge(c, a), e2 = edge(a, b);
  float det = dot(a, e0);
  r.front = det < 0.0;
  float s = r.front ? -1.0 : 1.0;
  r.e0 = s * e0;
  r.e1 = s * e1;
  r.e2 = s * e2;
  det = abs(det);
  r.inverse = (r.e0 + r.e1 + r.e2) / det;
  float half_ = 0.5 * float(faceSize);
  vec2 low = vec2(-1.0, bottom), high = vec2(1.0);
  if (min(z.x, min(z.y, z.z)) > 0.0) {
    vec3 px = x / z, py = y / z;
    low = max(low, vec2(min(px.x, min(px.y, px.z)), min(py.x, min(py.y, py.z))));
    high = min(high, vec2(max(px.x, max(px.y, px.z)), max(py.x, max(py.y, py.z))));
  }
  // Centres are at (i + 1/2 - N/2) / (N/2); a hair wider, as the quotients are rounded.
  r.low = ivec2(ceil((low - vec2(-1.0, bottom)) * half_ - 0.501));
  r.high = ivec2(floor((high - vec2(-1.0, bottom)) * half_ - 0.499));
  r.low = max(r.low, ivec2(0));
  r.high = min(r.high, ivec2(faceSize - 1, face == 0 ? faceSize - 1 : faceSize / 2 - 1));
  if (det <= 0.0) r.high = r.low - 1;
  return r;
}

// A row of pixels: x goes over columns.x..columns.y; at a pixel's centre the edge functions are edges + ex * x, alike for the inverse distance.
struct Row {
  ivec2 columns;
  vec4 atZero, slope;
};

// Columns inside all three edges: x >= -edges / ex where ex > 0, <= where ex < 0; a hair wider, as quotients are rounded.
Row rowOf(FaceTriangle t, float y) {
  Row r;
  r.slope = vec4(t.e0.x, t.e1.x, t.e2.x, t.inverse.x);
  r.atZero = vec4(t.e0.y, t.e1.y, t.e2.y, t.inverse.y) * y + vec4(t.e0.z, t.e1.z, t.e2.z, t.inverse.z);
  vec3 at = -r.atZero.xyz / r.slope.xyz;
  vec3 low = mix(vec3(-1.0), at, greaterThan(r.slope.xyz, vec3(0.0))), high = mix(vec3(1.0), at, lessThan(r.slope.xyz, vec3(0.0)));
  vec2 span = clamp(vec2(max(low.x, max(low.y, low.z)), min(high.x, min(high.y, high.z))), -1.1, 1.1);
  float half_ = 0.5 * float(faceSize);
  r.columns = ivec2(max(t.low.x, int(ceil((span.x + 1.0) * half_ - 0.51))), min(t.high.x, int(floor((span.y + 1.0) * half_ - 0.49))));
  return r;
}

vec2 pixelCentre(int face, ivec2 pixel) {
  return (vec2(pixel) + 0.5) * (2.0 / float(faceSize)) - vec2(1.0, face == 0 ? 1.0 : 0.0);
}

bool isLarge(FaceTriangle t) {
  ivec2 size = t.high - t.low + 1;
  return min(size.x, size.y) > 0 && size.x * size.y > kMostPixels;
}

void listLarge(int entry) {
  uint slot = atomicAdd(largeCount, 1u);
  large[slot] = uint(entry);
  atomicMax(largeGroups, min(slot + 1u, kMostGroups));
}

// All rows of a hemicube, 3 N: which face and which row of it.
int rowsPerHemicube() { return 3 * faceSize; }
ivec2 faceAndRow(int row) {
  int half_ = faceSize / 2;
  return row < faceSize ? ivec2(0, row) : ivec2(1 + (row - faceSize) / half_, (row - faceSize) % half_);
}
