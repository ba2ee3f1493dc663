// Hemicubes [CohenGreenberg1985] without a projection matrix. A pixel's direction d = (x, y, 1) in a face's frame hits
// a triangle with corners a, b, c (relative to the hemicube's centre) if d . (a x b), d . (b x c) and d . (c x a) have
// the sign of det = a . (b x c); the inverse distance along d is (their sum) / det [Olano1997]. So nothing is clipped,
// there is no near plane, and triangles that touch the centre still block.
//
// There are three ways to find the patch that each pixel sees: raster (hemicube_points.comp, hemicube_depth.comp),
// rays (hemicube_rays.comp) and an item buffer (hemicube_item.*). hemicube_sum.comp sums each patch's delta form
// factors, always in the same order. Pixel layout of a hemicube: the full face N x N, then four half faces N x N/2,
// rows upwards from the horizon.
// Corners come from a buffer texture, which llvmpipe gathers from three times as fast as from a storage block.
layout(binding = 59) uniform samplerBuffer corners;  // three texels per patch
uniform int patchCount;

struct Frame {
  vec4 origin;   // w: 1 / (distance below which a corner counts as lying in the patch's plane)
  vec4 u, v, n;  // unit; n: the patch's normal. w of u: one bit for each hidden part of the patch
};
layout(std140, binding = 9) uniform Frames { Frame frames[256]; };

uniform int faceSize;        // N, even
uniform int halfFacePixels;  // N * N / 2
uniform float halfSize;      // N / 2
uniform float pixelSize;     // 2 / N
uniform int firstPatch;      // of this batch

struct Triangle {
  vec3 a, b, c;  // in the hemicube's frame: x along u, y along v, z along n
};

vec3 patchCorner(int patchIndex, int k) { return texelFetch(corners, 3 * patchIndex + k).xyz; }

vec3 toFrame(Frame f, vec3 p) {
  vec3 d = p - f.origin.xyz;
  return vec3(dot(d, f.u.xyz), dot(d, f.v.xyz), dot(d, f.n.xyz));
}

Triangle toFrame(Frame f, Triangle world) {
  return Triangle(toFrame(f, world.a), toFrame(f, world.b), toFrame(f, world.c));
}
Triangle worldTriangle(int index) {
  return Triangle(patchCorner(index, 0), patchCorner(index, 1), patchCorner(index, 2));
}
Triangle triangleOf(Frame f, int index) { return toFrame(f, worldTriangle(index)); }

// Excludes the patch itself and triangles in its plane or below.
bool isAbove(Frame f, Triangle t, int index, int self) {
  return index != self && max(t.a.z, max(t.b.z, t.c.z)) * f.origin.w >= 1.0;
}

// Face 0 looks along n; 1..4 along u, v, -u, -v with n upwards.
vec3 toFace(int face, vec3 p) {
  vec2 level = (face & 1) == 1 ? p.yx : vec2(-p.x, p.y);
  if (face > 2) level = -level;
  return face == 0 ? p : vec3(level.x, p.z, level.y);
}

bool anyLess(vec3 a, vec3 b) { return any(lessThan(a, b)); }

// One bit per face that may see the triangle. Software renderers execute both sides of a branch, so a lane iterates
// over its set bits instead of testing five faces.
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

// The lowest set bit's index; 0 if none is set.
int lowestFace(uint faces) { return faces == 0u ? 0 : (floatBitsToInt(float(int(faces & -faces))) >> 23) - 127; }

int facePixels(int face) { return face == 0 ? 0 : (face + 1) * halfFacePixels; }
int pixelsPerHemicube() { return 6 * halfFacePixels; }

vec2 pixelCentre(int face, ivec2 pixel) {
  return (vec2(pixel) + 0.5) * pixelSize - vec2(1.0, face == 0 ? 1.0 : 0.0);
}

// The inverse of toFace for a pixel's direction, in the hemicube's frame.
vec3 pixelDirection(int face, ivec2 pixel) {
  vec2 at = pixelCentre(face, pixel);
  vec2 level = face > 2 ? -vec2(at.x, 1.0) : vec2(at.x, 1.0);
  return face == 0 ? vec3(at, 1.0) : vec3((face & 1) == 1 ? level.yx : vec2(-level.x, level.y), at.y);
}

// Position of a hemicube's pixel: face, column, row.
ivec3 placeOf(int pixel) {
  int face = pixel < 2 * halfFacePixels ? 0 : pixel / halfFacePixels - 1;
  int inFace = pixel - facePixels(face);
  return ivec3(face, inFace % faceSize, inFace / faceSize);
}
