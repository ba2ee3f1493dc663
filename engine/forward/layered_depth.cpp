#include "forward/layered_depth.hpp"

#include "base/error.hpp"

#include <fmt/core.h>

namespace lucerna {

LayeredDepth::LayeredDepth(gl::ProgramLibrary& programs, const GpuScene& scene, const std::string& name,
                           const Shape& shape)
    : name_(name), shape_(shape) {
  CHECK(shape.layersPerDraw > 0 && shape.layers % shape.layersPerDraw == 0, "{} layers, {} a draw", shape.layers,
        shape.layersPerDraw);
  const auto load = [&](bool masked) {
    return &programs.loadRaster(fmt::format("{} {}", name, masked ? "masked" : "opaque"), "forward/depth_layered.vert",
                                masked ? "forward/depth.frag" : "",
                                {{"ALPHA_MASK", masked}, {"LAYERS", shape.layersPerDraw}, {"LAMPS", shape.lamps}},
                                "forward/depth_layered.geom");
  };
  programs_.opaque = load(false);
  if (scene.features().alphaMasks) programs_.masked = load(true);
  gl::Sampling sampling;
  if (!shape.followed) {
    sampling = {gl::Filter::linear, gl::Filter::linear, gl::Wrap::border, glm::vec4(1.0f)};
    if (shape.kind == gl::TextureKind::cubeArray) sampling.wrap = gl::Wrap::edge;  // seamless: there is no edge
    sampling.depthCompare = true;
  }
  depth_ = gl::Texture(name, gl::Format::depth32f, glm::ivec3(shape.size, shape.size, shape.layers), sampling, 1,
                       shape.kind);
  framebuffer_ = gl::Framebuffer(name, {}, &depth_);
}

void LayeredDepth::record(const GpuScene& scene, std::span<const View> views) const {
  CHECK(static_cast<int>(views.size()) == shape_.layers, "{} views for {} layers", views.size(), shape_.layers);
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  state.polygonOffset = {shape_.followed ? 0.0f : 1.5f, 2.0f};
  state.depthClamp = true;
  const gl::RasterPass pass(name_, framebuffer_, state);
  pass.clearDepth();
  for (int first = 0; first < shape_.layers; first += shape_.layersPerDraw) {
    for (const gl::Program* program : {programs_.opaque, programs_.masked}) {
      if (!program) continue;
      program->set("firstLayer", first);
      for (int i = 0; i < shape_.layersPerDraw; ++i) {
        const View& view = views[static_cast<std::size_t>(first + i)];
        program->set(fmt::format("clipFromPlace[{}]", i), view.clipFromPlace);
        program->set(fmt::format("viewPlace[{}]", i), view.place);
      }
    }
    scene.drawDepth(programs_);
  }
}

}  // namespace lucerna
