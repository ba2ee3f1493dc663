// Asks what lit a pixel: the paths that path tracing has sent through it. Of other techniques: Renderer::ask.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/pixel_answer.hpp"

namespace lucerna {

/// The first `samples` paths of the pixel (from the top left) are followed again, with the numbers that they have in a
/// picture with these settings: their sum is the picture's pixel.
PixelAnswer askPaths(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                     PathTracer::Settings settings, std::uint32_t samples, glm::ivec2 pixel);

}  // namespace lucerna
