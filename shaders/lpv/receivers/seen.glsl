// The surface that a pixel of the camera sees, in the ray caster's coordinates. Needs rays/bvh.glsl,
// rays/materials.glsl and the path constants.
bool seenAt(int pixel, out Hit hit, out Surface surface) {
  int width = tracer.picture.x;
  vec2 place = vec2(pixel % width, pixel / width) + 0.5;
  Ray ray = Ray(tracer.cameraPosition, 0.0,
                normalize(tracer.firstPixel + place.x * tracer.pixelRight + place.y * tracer.pixelUp), 3e38);
  hit = closestHit(ray, kNoHit);
  if (hit.triangle == kNoHit) return false;
  surface = surfaceAt(hit.triangle, hit.barycentrics, ray.direction);
  return true;
}
