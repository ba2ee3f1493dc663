// Walks through dense media: paths move from collision to collision as long as no triangle can be met, and no ray is
// traced for these. Every random number is that of a path that traces them all, and every sum up to rounding. The
// longest walks have a hundred times the collisions of most, so each lane takes the next path from a queue when its own
// has arrived; in path.comp most lanes would wait.
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };

#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "pathtracer/fresnel.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/environment.glsl"
#include "rays/lights.glsl"
#include "rays/view.glsl"
#include "pathtracer/path.glsl"
uint collisionCount = 0u;  // of this lane, in this submission
#include "pathtracer/shadow_ray.glsl"
#include "pathtracer/crossing.glsl"
#if MANIFOLDS
#include "pathtracer/manifold_request.glsl"
#endif
#include "pathtracer/flight.glsl"

layout(rgba32ui, binding = 0) readonly uniform uimage2D filmMean;  // w: number of samples
const uint kAtOnce = 8u;

// The next path for this lane. False: there is none.
bool takeWalk(out PathNumbers numbers) {
  uint number;
  ivec2 pixel;
  if (loopIterations >= tracer.iterations || !takeFrom(kWalking + turn, number)) return false;
  findPixel(number, pixel);
  numbers = numbersOf(pixel, imageLoad(filmMean, pixel).w);
  return true;
}

void main() {
  Path path;
  PathNumbers numbers;
  MediumRecord medium;
  InteriorRecord interior;
  float flight = 0.0;
  bool walks = false;
  while (true) {  // ends: after tracer.iterations, and those of the last walk
    if (!walks) {
      if (!takeWalk(numbers)) break;
      restorePath(path);
      interior = interiors[topRank(path.inside)];
      medium = mediumOf(interior.medium);
      flight = beginFlight(path, medium, numbers);
      walks = true;
    }
    // Several collisions at a time: where a lane stores its path, all others wait.
    bool ends = false;
    for (uint k = 0u; k < kAtOnce && walks; ++k) {
      ++loopIterations;
      weighFlight(path, medium, channelProbabilities(path.throughput), path.head + flight, false, numbers);
      path.origin += flight * path.direction;
      ends = scatterInMedium(path, medium, vec3(0.0), numbers, false, 0.0) != kScattered;
      if (!ends) flight = beginFlight(path, medium, numbers);
      walks = !ends && mayWalk(interior, medium, path, flight, numbers);
    }
    if (walks && loopIterations < tracer.iterations) continue;
#if SPILLED
    spillPath(path);
#else
    savePath(path);  // with what the medium has emitted
#endif
    if (ends) mark(kPathEnded);
    addTo((walks ? kWalking : kReady) + 1u - turn, numberOf(home));
    walks = false;
  }
  atomicAdd(allIterations, loopIterations);
  atomicAdd(collisions, collisionCount);
}
