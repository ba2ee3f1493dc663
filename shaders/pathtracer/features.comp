// What a pixel shows, for the denoiser (denoise.glsl): means over the pixel of the surface's albedo, normal, inverse
// distance and whether it shines. Each dispatch adds SAMPLES points of every pixel.
//
// Of mirrors the surface behind them counts, tinted; boundaries without a surface of their own are passed. Glass counts
// as a white surface: what lies behind it is left to the picture itself.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/view.glsl"
#include "pathtracer/film_place.glsl"

layout(rgba32f, binding = 0) restrict uniform image2D surfaceColours;  // albedo, share that shines
layout(rgba32f, binding = 1) restrict uniform image2D surfacePlaces;   // normal, inverse distance
uniform ivec2 firstPixel;
uniform int firstSample;

const int kMostSurfaces = 8;  // of mirrors and empty boundaries in a row

struct Seen {
  vec4 colour, place;
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

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, tracer.picture.xy))) return;
  float before = float(firstSample), all = before + float(SAMPLES);
  vec4 colour = vec4(0.0), place = vec4(0.0);
  if (firstSample > 0) {
    colour = imageLoad(surfaceColours, pixel) * before;
    place = imageLoad(surfacePlaces, pixel) * before;
  }
  uint index = uint(pixel.y * tracer.picture.x + pixel.x);
  for (int i = 0; i < SAMPLES; ++i) {
    // Another seed than the paths': what weights are made of must not know their noise.
    PathNumbers numbers = PathNumbers(index, uint(firstSample + i), ~tracer.seed);
    vec3 origin, direction;
    viewRay(filmPlace(pixel, numbers), origin, direction);
    Seen seen = seenAlong(origin, direction);
    colour += seen.colour;
    place += seen.place;
  }
  imageStore(surfaceColours, pixel, colour / all);
  imageStore(surfacePlaces, pixel, place / all);
}
