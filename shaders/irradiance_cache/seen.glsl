// The surface that a pixel of the camera sees, in the ray caster's coordinates; beyond the picture's pixels, one of the
// cache.prefetch surfaces around the camera. Needs rays/bvh.glsl, rays/materials.glsl, irradiance_cache/common.glsl and
// the path constants.
vec3 directionOf(int pixel) {
  int width = tracer.picture.x, beyond = pixel - width * tracer.picture.y;
  if (beyond >= 0) {  // a spherical Fibonacci lattice: each direction has the same share of the sphere
    const float kGoldenAngle = 2.39996323;
    float y = 1.0 - float(2 * beyond + 1) / float(cache.prefetch), azimuth = kGoldenAngle * float(beyond),
          radius = sqrt(max(0.0, 1.0 - y * y));
    return vec3(radius * cos(azimuth), y, radius * sin(azimuth));
  }
  vec2 place = vec2(pixel % width, pixel / width) + 0.5;
  return normalize(tracer.firstPixel + place.x * tracer.pixelRight + place.y * tracer.pixelUp);
}

bool seenAt(int pixel, out Hit hit, out Surface surface) {
  Ray ray = Ray(tracer.cameraPosition, 0.0, directionOf(pixel), 3e38);
  hit = closestHit(ray, kNoHit);
  if (hit.triangle == kNoHit) return false;
  surface = surfaceAt(hit.triangle, hit.barycentrics, ray.direction);
  return true;
}
