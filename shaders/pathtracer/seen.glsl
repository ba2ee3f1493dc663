// What a camera ray shows. Of mirrors the surface behind them counts, tinted, as far away as the way to it is long;
// boundaries without a surface of their own are passed. Glass counts as a white surface. Needs rays/materials.glsl and
// rays/bvh.glsl.
const int kMostSurfaces = 8;  // of mirrors and empty boundaries in a row

struct Seen {
  vec4 colour, place;  // albedo and whether it shines; normal and inverse distance, 0 for none
};

Seen seenAlong(vec3 origin, vec3 direction) {
  Seen seen = Seen(vec4(0.0), vec4(0.0));
  vec3 tint = vec3(1.0);
  uint skip = kNoHit;
  float travelled = 0.0;
  for (int i = 0; i < kMostSurfaces; ++i) {
    Hit hit = closestHit(Ray(origin, 0.0, direction, 3e38), skip);
    if (hit.triangle == kNoHit) break;
    travelled += hit.t;
    Surface surface = surfaceAt(hit.triangle, hit.barycentrics, direction);
#if NORMAL_MAPS
    applyNormalMap(surface, hit.triangle);
#endif
    PathMaterial material = materials[surface.material];
    uint kind = material.kind;
#if DIFFUSE_ONLY
    if (kind != PATH_NONE) kind = PATH_DIFFUSE;
#endif
    bool shines = any(greaterThan(material.emission, vec3(0.0)));
    bool mirrors = kind == PATH_MIRROR && !shines;
    if (mirrors || kind == PATH_NONE && !shines) {
      vec3 side = mirrors ? surface.geometricNormal : -surface.geometricNormal;
      origin = offsetRay(surface.position, side, surface.magnitude);
      skip = hit.triangle;
      if (mirrors) {
        tint *= material.specular;
        direction = reflect(direction, surface.normal);
      }
      continue;
    }
    vec3 albedo = kind == PATH_DIFFUSE || kind == PATH_COATED ? wholeAlbedoAt(surface)
                  : kind == PATH_DIELECTRIC                  ? vec3(1.0)
                                                             : material.specular;
    seen.colour = vec4(tint * clamp(albedo, vec3(0.0), vec3(1.0)), shines ? 1.0 : 0.0);
    seen.place = vec4(surface.normal, 1.0 / max(travelled, 1e-30));
    break;
  }
  return seen;
}
