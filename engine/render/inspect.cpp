// What lit a pixel of the last frame: Renderer::inspect.
#include "render/renderer.hpp"

#include "gl/pass.hpp"

#include <fmt/format.h>

namespace lucerna {

namespace {

glm::dvec3 texelAt(const gl::Texture& texture, glm::ivec2 fromBelow) {
  const gl::Texture one("inspected pixel", texture.format(), glm::ivec2(1));
  gl::copyTexels(texture, fromBelow, one, {0, 0}, {1, 1});
  return glm::dvec3(glm::vec3(one.readRgba().front()));
}

}  // namespace

InspectedTerms Renderer::drawInspected(gl::ProgramLibrary& programs, const FrameView& view, glm::ivec2 fromBelow) {
  InspectedTerms terms;
  const SurfacePrograms inspected = surfacePrograms(programs, true);
  bindFrameConstants(view);
  bindForShading();
  terms.bind();
  for (const GeometryTechnique::Sides& side : sides()) {
    gl::RasterState state;
    state.depth = gl::Depth::equalReadOnly;
    state.cull = side.cull;
    state.polygonOffset = side.polygonOffset;
    const gl::RasterPass pass("inspected pixel", radianceTarget_, state);
    pass.restrictTo(fromBelow, {1, 1});
    for (const gl::Program* program : {inspected.opaque, inspected.masked})
      if (program) program->set("inspectedPixel", fromBelow);
    gpuScene_->draw(inspected, view.drawn());
    gl::memoryBarrier(gl::Barrier::storage);  // both sides write the terms
  }
  terms.read();
  return terms;
}

PixelInspection Renderer::inspect(gl::ProgramLibrary& programs, const Camera& camera, glm::ivec2 pixel) {
  if (picture_) return picture_->inspect(camera, pixel);
  const glm::ivec2 fromBelow(pixel.x, settings_.size.y - 1 - pixel.y);
  PixelInspection answer;
  answer.pixel = pixel;
  answer.technique = settings_.technique;
  const FrameView view = viewOf(camera, camera);
  FrameView centres = view;
  centres.isNew = false;
  if (accumulates()) drawFrame(centres, {}, false);
  answer.radiance = texelAt(radiance_, fromBelow);
  const InspectedTerms terms = drawInspected(programs, view, fromBelow);
  if (accumulates() && isSettled()) antialiasing_.writeMean(radianceTarget_, noAttributes_);  // what was shown
  if (terms.fourth(INSPECTED_POSITION) != 1.0f) {  // no surface, or a patch's back
    answer.add("seen directly", "what lies behind the scene", answer.radiance);
    return answer;
  }
  const glm::dvec3 position = glm::dvec3(terms[INSPECTED_POSITION]) + origin_;
  answer.surface =
      PixelInspection::Surface{position, glm::dvec3(terms[INSPECTED_NORMAL]), glm::dvec3(terms[INSPECTED_ALBEDO])};
  answer.add("emission", "the surface itself", glm::dvec3(terms[INSPECTED_EMISSION]), {position});
  if (!geometry_) addDirectShares(terms, answer);
  if (technique_) technique_->addShares({timer_, view, terms, fromBelow}, answer);
  return answer;
}

void Renderer::addDirectShares(const InspectedTerms& terms, PixelInspection& answer) {
  const glm::dvec3 position = answer.surface->position;
  const Scene& scene = gpuScene_->scene();
  const double reach = glm::length(scene.bounds.extent());
  if (scene.sun)
    answer.add("direct", "sun", glm::dvec3(terms[INSPECTED_SUN]), {position, position - reach * scene.sun->direction});
  const auto lamps = [&](const std::vector<LightViews>& lights, std::size_t first) {
    for (std::size_t i = 0; i < lights.size() && localLights_; ++i)
      answer.add("direct", fmt::format("{} {}", lights[i].isPoint ? "point" : "spot", lights[i].index + 1),
                 glm::dvec3(terms[first + i]), {position, lights[i].position + origin_});
  };
  lamps(spots_, INSPECTED_SPOTS);
  lamps(points_, INSPECTED_POINTS);
  if (!plainLamps_.empty())
    answer.add("direct", fmt::format("{} lamps without shadow maps", plainLamps_.size()),
               glm::dvec3(terms[INSPECTED_PLAIN_LAMPS]), {position});
}

}  // namespace lucerna
