// Rasterises a hemicube's triangles in compute: which pixels of a face a triangle covers, and at which inverse
// distance. An invocation takes one triangle and several hemicubes. Triangles that span more than kMostPixels of a face
// are listed for a separate pass, one work group per triangle, one lane per row. This keeps lanes busy, and no loop
// comes near the 65,535 iterations after which Mesa's software renderer leaves any shader's loops.
#include "lib/clamped_int.glsl"
#include "radiosity/hemicube.glsl"

layout(local_size_x = 64) in;
uniform int hemicubes;      // in this batch
const int kMostPixels = 1024;

// The nearest surface has the largest key. It consists of the inverse distance, with a front face slightly nearer than
// a back face in the same place (sheets of two fronts); the last bits hold the front flag and the patch, so that ties
// are resolved identically in every run.
// The factor of a patch's inverse distance: a lamp is nearer than what it coincides with, on either side, as for rays.
const float kLampNearness = 1.000012;
float nearnessOf(int patchIndex) { return texelFetch(corners, 3 * patchIndex).w > 0.0 ? kLampNearness : 1.0; }

uint keyOf(float inverseDistance, bool front, uint patchIndex) {
  return (floatBitsToUint(front ? inverseDistance * 1.000004 : inverseDistance) & ~15u) | (front ? 8u : 0u) |
         (patchIndex & 7u);
}

// A triangle as a face sees it: the constants of its pixel tests.
struct FaceTriangle {
  vec3 e0, e1, e2;   // edge functions over (x, y, 1), positive inside
  vec3 inverse;      // inverse distance over (x, y, 1)
  ivec2 low, high;   // pixel bounds, inclusive
  bool front;
};

// Neighbours traverse a shared edge in opposite directions; without contraction the products are identical, so no pixel
// falls between them.
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
  vec2 low = vec2(-1.0, bottom), high = vec2(1.0);
  if (min(z.x, min(z.y, z.z)) > 0.0) {
    vec3 px = x / z, py = y / z;
    low = max(low, vec2(min(px.x, min(px.y, px.z)), min(py.x, min(py.y, py.z))));
    high = min(high, vec2(max(px.x, max(px.y, px.z)), max(py.x, max(py.y, py.z))));
  }
  // Pixel centres are at (i + 1/2 - N/2) / (N/2). The bounds are slightly wider, since the quotients are rounded.
  // A triangle beside the face has low > high. Its corners may lie as far outside as floats reach.
  ivec2 last = ivec2(faceSize - 1, face == 0 ? faceSize - 1 : faceSize / 2 - 1);
  r.low = clampedInt(ceil((low - vec2(-1.0, bottom)) * halfSize - 0.501), ivec2(0), last + 1);
  r.high = clampedInt(floor((high - vec2(-1.0, bottom)) * halfSize - 0.499), ivec2(-1), last);
  if (det <= 0.0) r.high = r.low - 1;
  return r;
}

// Iterates over the pixels that a triangle may cover, row by row, in one loop for rows and columns: with lanes in
// lockstep, one lane's longest row does not wait for another's. Loop with do .. while (row <= high.y), which never
// touches a pixel of another row: before a software renderer leaves a loop whose condition comes first, it runs the
// whole body once more with no lane active.
struct Walk {
  int column, row, lastColumn;
  int rowStart;    // first pixel of the row
  float bottom;    // y where the face begins
  vec4 rowValue;   // edge functions and inverse distance at x = 0 of this row
  vec4 slope;      // their change with x
  vec3 low, high;  // 1 / slope of edges that bound columns from below and from above; else 0
};

float highest(vec3 v) { return max(v.x, max(v.y, v.z)); }

void beginRow(inout Walk w, FaceTriangle t) {
  float y = (float(w.row) + 0.5) * pixelSize + w.bottom;
  w.rowValue = vec4(t.e0.y, t.e1.y, t.e2.y, t.inverse.y) * y + vec4(t.e0.z, t.e1.z, t.e2.z, t.inverse.z);
  // An edge is positive from x = -rowValue / slope on, or up to there; measured from the left end and from the right
  // end. Slightly wider, since quotients are rounded.
  vec3 first = (w.slope.xyz - w.rowValue.xyz) * w.low, last = (w.slope.xyz + w.rowValue.xyz) * w.high;
  vec2 from = clamp(vec2(highest(first), highest(last)), 0.0, 2.1) * halfSize + 0.49;  // ceil(v - 0.51)
  ivec2 pixels = clampedInt(from, ivec2(0), ivec2(2 * faceSize));
  w.column = max(t.low.x, pixels.x);
  w.lastColumn = w.row > t.high.y ? -1 : min(t.high.x, faceSize - 1 - pixels.y);
}

// firstPixel: the face's first pixel.
Walk beginWalk(FaceTriangle t, int face, int firstPixel) {
  Walk w;
  w.slope = vec4(t.e0.x, t.e1.x, t.e2.x, t.inverse.x);
  vec3 inverse = 1.0 / w.slope.xyz;
  w.low = mix(vec3(0.0), inverse, greaterThan(w.slope.xyz, vec3(1e-37)));
  w.high = mix(vec3(0.0), inverse, lessThan(w.slope.xyz, vec3(-1e-37)));
  w.row = t.low.y;
  w.rowStart = firstPixel + w.row * faceSize;
  w.bottom = face == 0 ? -1.0 : 0.0;
  beginRow(w, t);
  return w;
}

void advance(inout Walk w, FaceTriangle t) {
  ++w.column;
  if (w.column > w.lastColumn) {
    ++w.row;
    w.rowStart += faceSize;
    beginRow(w, t);
  }
}

vec4 valueAt(Walk w) { return w.rowValue + w.slope * ((float(w.column) + 0.5) * pixelSize - 1.0); }
bool covers(Walk w, vec4 value) {
  return w.column <= w.lastColumn && min(value.x, min(value.y, value.z)) >= 0.0 && value.w > 0.0;
}

bool isLarge(FaceTriangle t) {
  ivec2 size = t.high - t.low + 1;
  return min(size.x, size.y) > 0 && size.x * size.y > kMostPixels;
}

// Of the 3 N rows of a hemicube: the face and the row in it.
ivec2 faceAndRow(int row) {
  int half_ = faceSize / 2;
  return row < faceSize ? ivec2(0, row) : ivec2(1 + (row - faceSize) / half_, (row - faceSize) % half_);
}
