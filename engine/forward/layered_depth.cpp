#include "forward/layered_depth.hpp"

#include "base/error.hpp"

#include <fmt/core.h>

namespace lucerna {

LayeredDepth::LayeredDepth(gl::ProgramLibrary& programs, const GpuScene& scene, const std::string& name,
                           const Shape& shape)
    : shape_(shape) {
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
  for (int first = 0; first < shape.layers; first += shape.layersPerDraw)
    targets_.emplace_back(name, depth_.layers(name, first, shape.layersPerDraw));
}

void LayeredDepth::record(const GpuScene& scene, std::span<const View> views) {
  CHECK(static_cast<int>(views.size()) == shape_.layers, "{} views for {} layers", views.size(), shape_.layers);
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  state.polygonOffset = {shape_.followed ? 0.0f : 1.5f, 2.0f};
  state.depthClamp = true;
  const auto perDraw = static_cast<std::size_t>(shape_.layersPerDraw);
  for (std::size_t target = 0; target < targets_.size(); ++target) {
    const auto drawn = views.subspan(target * perDraw, perDraw);
    for (const gl::Program* program : {programs_.opaque, programs_.masked}) {
      if (!program) continue;
      for (std::size_t i = 0; i < perDraw; ++i) {
        program->set(fmt::format("clipFromPlace[{}]", i), drawn[i].clipFromPlace);
        program->set(fmt::format("viewPlace[{}]", i), drawn[i].place);
      }
    }
    targets_[target].record(scene, programs_, state, drawn);
  }
}

void LayeredDepth::forget() {
  for (DepthTarget& target : targets_) target.forget();
}

std::size_t LayeredDepth::gpuBytes() const {
  std::size_t bytes = depth_.bytes();
  for (const DepthTarget& target : targets_) bytes += target.keptBytes();
  return bytes;
}

}  // namespace lucerna
