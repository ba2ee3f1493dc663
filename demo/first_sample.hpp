// Parts of a path traced picture's samples: where they begin.
#pragma once

#include "pathtracer/film.hpp"
#include "pathtracer/path_tracer.hpp"

namespace lucerna::demo {

/// The number of the first sample of a film that is empty, as after setCamera().
inline void setFirstSample(PathTracer& tracer, std::uint32_t first) {
  Film film = filmOf(tracer.checkpoint(), "an empty film");
  film.first = first;
  tracer.resume(bytesOf(film), "an empty film");
}

}  // namespace lucerna::demo
