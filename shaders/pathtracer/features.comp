// What a pixel shows, for the denoiser (denoise.glsl): means over the pixel of the surface's albedo, normal, inverse
// distance and whether it shines (seen.glsl). Each dispatch adds SAMPLES points of every pixel. What lies behind glass
// is left to the picture itself.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/view.glsl"
#include "pathtracer/film_place.glsl"
#include "pathtracer/seen.glsl"

layout(rgba32f, binding = 0) restrict uniform image2D surfaceColours;  // albedo, share that shines
layout(rgba32f, binding = 1) restrict uniform image2D surfacePlaces;   // normal, inverse distance
uniform ivec2 firstPixel;
uniform int firstSample;

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
