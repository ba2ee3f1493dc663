// Finds out what lit a pixel of a path traced picture: the paths through it.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "pathtracer/path_tracer.hpp"
#include "frame/pixel_inspection.hpp"

namespace lucerna {

/// Retraces the first `samples` paths of the pixel (counted from the top left), with the random numbers they have in a
/// picture with these settings: their sum is the picture's pixel.
PixelInspection inspectPaths(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                             const Camera& camera, PathTracer::Settings settings, std::uint32_t samples,
                             glm::ivec2 pixel);

}  // namespace lucerna
