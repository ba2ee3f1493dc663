// Where shadow rays to the sun and to lamps start. Triangles with smooth normals stand for a curved surface: where it
// bulges, faces that are turned away from a light are lit, and rays start on it instead [Hanika2021]: on the mean of
// the planes through the corners that are perpendicular to their normals. Rays from it meet `triangle` itself too.
struct ShadowStart {
  vec3 origin;
  vec3 normal;  // light comes from its side
  uint skip;    // the triangle that the ray does not meet
};

ShadowStart shadowStart(Surface surface, uint triangle) {
  ShadowStart start = ShadowStart(offsetRay(surface.position, surface.geometricNormal, surface.magnitude),
                                  surface.geometricNormal, triangle);
#if SMOOTH_NORMALS
  uint first = triangle * TRIANGLE_WORDS, n = first + TRIANGLE_WORDS - 3u;
  vec3 weights = vec3(1.0 - surface.barycentrics.x - surface.barycentrics.y, surface.barycentrics);
  vec3 bulge = vec3(0.0), smoothed = vec3(0.0);
  for (uint i = 0u; i < 3u; ++i) {
    vec3 normal = uintBitsToFloat(triangleData[n + i].xyz) * (surface.front ? 1.0 : -1.0);
    float height = dot(normal, uintBitsToFloat(triangleData[first + i].xyz) - surface.position);
    bulge += weights[i] * max(height, 0.0) * normal;
    smoothed += weights[i] * normal;
  }
  if (dot(bulge, surface.geometricNormal) > surface.magnitude * 7.62939453125e-6)  // 2^-17: twice offsetRay's
    start = ShadowStart(start.origin + bulge, smoothed, kNoHit);
#endif
  return start;
}
