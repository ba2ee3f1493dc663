// Hemicubes by rays: one through each pixel's centre, through the hierarchy of the path tracer. x: pixels, y: hemicubes of the batch.
// Written: the pixel's patch + 1, 0 where there is none; each patch's share of the hemisphere is summed (hemicube_keep.glsl).
#include "radiosity/hemicube.glsl"
#include "radiosity/hemicube_keep.glsl"
#include "pathtracer/bvh.glsl"

layout(local_size_x = 64) in;
layout(binding = 58) uniform samplerBuffer deltaFactors;  // the full face, then one half face
layout(std430, binding = 2) writeonly buffer Items { uint items[]; };
uniform vec3 raysOrigin;  // of the hierarchy's space

uint firstMet(Ray ray, uint skip) {
  BvhTraversal s = beginRay(ray, skip);
  do advanceRay(s, false);
  while (!isDone(s));
  return s.hit.triangle == kNoHit ? kNoHit : texelFetch(bvhTriangles, int(s.hit.triangle)).w & BVH_TRIANGLE_ID_MASK;
}

bool isBack(uint patchIndex, vec3 direction) {
  Triangle t = worldTriangle(int(patchIndex));
  return dot(cross(t.b - t.a, t.c - t.a), direction) > 0.0;
}

void main() {
  int pixel = int(gl_GlobalInvocationID.x), hemicube = int(gl_WorkGroupID.y);
  if (pixel >= pixelsPerHemicube()) return;
  ivec3 place = placeOf(pixel);
  Frame f = frames[hemicube];
  vec3 d = pixelDirection(place.x, place.yz);
  // What lies in the patch's own plane is not met.
  Ray ray = Ray(f.origin.xyz - raysOrigin, 1.0 / (f.origin.w * d.z), d.x * f.u.xyz + d.y * f.v.xyz + d.z * f.n.xyz, 3e38);
  uint patchIndex = firstMet(ray, uint(firstPatch + hemicube));
  // A front wins over a back at the same place: sheets of two fronts.
  if (patchIndex != kNoHit && isBack(patchIndex, ray.direction)) {
    Triangle t = worldTriangle(int(patchIndex));
    vec3 normal = cross(t.b - t.a, t.c - t.a);
    float at = dot(normal, t.a - f.origin.xyz) / dot(normal, ray.direction);
    ray.tMin = max(ray.tMin, at * 0.999999);
    ray.tMax = at * 1.000002;
    uint other = firstMet(ray, patchIndex);
    if (other != kNoHit && other != uint(firstPatch + hemicube) && !isBack(other, ray.direction)) patchIndex = other;
  }
  bool met = patchIndex != kNoHit;
  items[hemicube * pixelsPerHemicube() + pixel] = met ? patchIndex + 1u : 0u;
  float delta = texelFetch(deltaFactors, pixel - facePixels(place.x) + (place.x == 0 ? 0 : 2 * halfFacePixels)).x;
  if (met) keep(hemicube, int(patchIndex), delta);
}
