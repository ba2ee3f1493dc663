// The surface that a pixel of the camera sees, in the ray caster's coordinates; beyond the picture's pixels, one of the
// cache.prefetch surfaces around the camera. Needs rays/bvh.glsl, rays/materials.glsl, irradiance_cache/common.glsl and
// the path constants.
#include "rays/view.glsl"

void rayOf(int pixel, out vec3 origin, out vec3 direction) {
  int width = tracer.picture.x, beyond = pixel - width * tracer.picture.y;
  if (beyond >= 0) {  // a spherical Fibonacci lattice: each direction has the same share of the sphere
    const float kGoldenAngle = 2.39996323;
    float y = 1.0 - float(2 * beyond + 1) / float(cache.prefetch), azimuth = kGoldenAngle * float(beyond),
          radius = sqrt(max(0.0, 1.0 - y * y));
    origin = tracer.cameraPosition;
    direction = vec3(radius * cos(azimuth), y, radius * sin(azimuth));
    return;
  }
  viewRay(vec2(pixel % width, pixel / width) + 0.5, origin, direction);
}

bool seenAt(int pixel, out Hit hit, out Surface surface) {
  Ray ray = Ray(vec3(0.0), 0.0, vec3(0.0), 3e38);
  rayOf(pixel, ray.origin, ray.direction);
  hit = closestHit(ray, kNoHit);
  if (hit.triangle == kNoHit) return false;
  surface = surfaceAt(hit.triangle, hit.barycentrics, ray.direction);
  return true;
}
