#include "rsm/rsm_gather.hpp"

#include "base/error.hpp"
#include "base/radical_inverse.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lucerna {

namespace {

constexpr GLuint kPatternBinding = 0, kWorkBinding = 1;
constexpr GLuint kLowUnit = 5, kRefusedUnit = 5, kRefusedImage = 1;
constexpr int kGroup = 8;  // pixels each way of a work group
constexpr double kIterationsOfInterpolation = 8.0;  // of a pixel; a gathered sample is one

// The Work block of shaders/rsm/work.glsl.
struct GatherCounts {
  GLuint groupsX = 0, groupsY = 1, groupsZ = 1;
  GLuint refused = 0, surfaces = 0, lowSamples = 0;
};

/// Dispatches a part of a picture.
auto dispatcher(const gl::ComputePass& pass, const gl::Program& program) {
  return [&](const glm::ivec2& corner, const glm::ivec2& size) {
    program.set("firstPixel", corner);
    pass.dispatch(glm::ivec3(size, 1), glm::ivec3(kGroup, kGroup, 1));
  };
}

glm::ivec2 lowSize(glm::ivec2 size, int step) { return (size + step - 1) / step; }

}  // namespace

float RsmGather::Settings::farthest() const {
  // The whole map, from any of its points; of a lamp's sphere the half turn.
  return reach == Reach::map ? std::max(radius, std::numbers::sqrt2_v<float>) : radius;
}

double RsmGather::Settings::exponent() const {
  return std::max(std::log2(static_cast<double>(farthest()) / static_cast<double>(radius)), 1.0);
}

std::vector<glm::vec4> RsmGather::pattern(int samples, Weight weight, const glm::dvec2& shift, double exponent) {
  std::vector<glm::vec4> result;
  for (int i = 0; i < samples; ++i) {
    const double xi1 = std::fmod((i + 0.5) / samples + shift.x, 1.0);
    const double angle = 2.0 * std::numbers::pi * (radicalInverse(static_cast<std::uint32_t>(i)) + shift.y);
    // One over the density of samples: distance times its derivative by xi1.
    const double distance = std::pow(xi1, exponent), unbiased = exponent * std::pow(xi1, 2.0 * exponent - 1.0);
    result.emplace_back(distance * std::sin(angle), distance * std::cos(angle),
                        weight == Weight::published ? xi1 * unbiased : unbiased, 0.0);
  }
  return result;
}

gl::ShaderFlags RsmGather::flags(const Settings& settings, Light light) {
  return {{"NEAR", static_cast<int>(settings.nearField)},
          {"ROTATION", settings.rotation == Rotation::noise},
          {"MAP_LIGHT", static_cast<int>(light)},
          {"WHOLE_MAP", settings.reach == Reach::map},
          {"INSPECTED", 0}};
}

RsmGather::RsmGather(gl::ProgramLibrary& programs, const std::array<bool, 3>& lights, const Settings& settings,
                     const VisibleSurfaces& visible, double unmeasuredIterations)
    : settings_(settings), visible_(&visible), chunks_(unmeasuredIterations) {
  constexpr std::array<const char*, 3> kNames{"", " spot", " lamp"};
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (!lights[i]) continue;
    const char* const name = kNames[i];
    const gl::ShaderFlags flagsOfLight = flags(settings, static_cast<Light>(i));
    if (settings.interpolates())
      low_[i] = &programs.loadCompute(fmt::format("rsm gather{} low", name), "rsm/gather_low.comp", flagsOfLight);
    full_[i] =
        settings.interpolates()
            ? &programs.loadCompute(fmt::format("rsm gather{} refused", name), "rsm/gather_refused.comp", flagsOfLight)
            : &programs.loadCompute(fmt::format("rsm gather{} all", name), "rsm/gather_all.comp", flagsOfLight);
  }
  if (settings.interpolates()) interpolate_ = &programs.loadCompute("rsm interpolate", "rsm/interpolate.comp");
  const std::vector<glm::vec4> samples =
      pattern(settings.samples, settings.weight, glm::dvec2(0.0), settings.exponent());
  pattern_ =
      gl::Buffer("rsm gather pattern", samples.size() * sizeof(glm::vec4), samples.data(), gl::Usage::staticDraw);
  work_ = gl::Buffer("rsm gather work", sizeof(GatherCounts), nullptr, gl::Usage::dynamicCopy);
  ring_ = std::make_unique<gl::ReadBackRing>("rsm gather counts", sizeof(GatherCounts));
  resize();
}

void RsmGather::resize() {
  const glm::ivec2 size = visible_->size();
  irradiance_ = gl::Texture("gathered irradiance", gl::Format::rgba32f, size);
  if (settings_.interpolates()) {
    lowIrradiance_ =
        gl::Texture("gathered irradiance low", gl::Format::rgba32f, lowSize(size, settings_.lowResolution));
    // A list, but not a buffer: storage blocks may be limited to 16 MiB, too small for a picture's pixels.
    refused_ = gl::Texture("refused pixels", gl::Format::r32ui, size);
  }
}

void RsmGather::bindMap(const gl::Program& program, const Settings& settings, const Map& map, bool adds) {
  program.use();
  map.rsm.bind();
  program.set("adds", adds ? 1 : 0);
  program.set("gatherRadius", settings.farthest());
  if (settings.nearField == Near::clamp)
    program.set("minimumDistance2", settings.clampTexels * settings.clampTexels * map.rsm.texelArea);
  if (map.rsm.light == Light::sun) return;
  CHECK(map.views, "no views of a light of kind {}", static_cast<int>(map.rsm.light));
  for (std::size_t i = 0; i < map.views->clipFromWorld.size(); ++i)
    program.set(fmt::format("clipFromPlace[{}]", i), map.views->clipFromPlace(i));
  program.set("lightPlace", map.views->place());
  program.set("texelWidth", static_cast<float>(map.views->texelWidth(map.rsm.position.size().x)));
}

void RsmGather::bindVisible(const gl::Program& program, const Inputs& inputs) const {
  program.use();
  visible_->bind(program, inputs.worldFromClip);
  if (settings_.interpolates()) program.set("lowStep", settings_.lowResolution);
  pattern_.bindStorage(kPatternBinding);
  work_.bindStorage(kWorkBinding);
}

void RsmGather::setFit(const gl::Program& program, const Inputs& inputs) const {
  program.set("pixelWidth", inputs.pixelWidth);
  program.set("fitNormal", settings_.fitNormal);
  program.set("fitPlane", settings_.fitPlane);
  program.set("fitDistance", settings_.fitDistance);
}

std::vector<InspectedPart> RsmGather::inspect(gl::ProgramLibrary& programs, const Inputs& inputs,
                                              glm::ivec2 pixel) const {
  constexpr std::size_t kPlaces = 4;  // places that interpolation uses
  std::vector<InspectedPart> all;
  for (std::size_t i = 0; i < inputs.maps.size(); ++i) {
    const Map& map = inputs.maps[i];
    gl::ShaderFlags flagsOfLight = flags(settings_, map.rsm.light);
    flagsOfLight.back().second = 1;
    const InspectedParts parts(kPlaces * static_cast<std::size_t>(settings_.samples));
    {
      const gl::Program& program = programs.loadCompute(fmt::format("rsm inspect {}", static_cast<int>(map.rsm.light)),
                                                        "rsm/inspect.comp", flagsOfLight);
      const gl::ComputePass pass("rsm inspect");
      bindMap(program, settings_, map);
      visible_->bind(program, inputs.worldFromClip);
      program.set("lowStep", std::max(settings_.lowResolution, 1));
      setFit(program, inputs);
      program.set("inspectedPixel", pixel);
      program.set("interpolates", settings_.interpolates() ? 1 : 0);
      pattern_.bindStorage(kPatternBinding);
      irradiance_.bind(kLowUnit);
      parts.bind();
      pass.dispatch(glm::ivec3(1), glm::ivec3(1));
    }
    for (InspectedPart& part : parts.read()) {
      part.number.w = static_cast<int>(i);
      all.push_back(part);
    }
  }
  return all;
}

void RsmGather::gatherLow(const Inputs& inputs) {
  const GatherCounts start;
  work_.upload(0, sizeof start, &start);
  for (const Map& map : inputs.maps) {
    const gl::ComputePass pass("gather low", gl::Barrier::textureFetch | gl::Barrier::storage | gl::Barrier::image);
    const gl::Program& program = *low_[static_cast<std::size_t>(map.rsm.light)];
    bindMap(program, settings_, map, &map != &inputs.maps.front());
    bindVisible(program, inputs);
    lowIrradiance_.bindImage(0, gl::Access::readWrite);
    chunks_.forEach(lowIrradiance_.size2d(), settings_.samples, kGroup, dispatcher(pass, program));
  }
}

void RsmGather::interpolate(const Inputs& inputs) {
  const gl::ComputePass pass(
      "interpolation", gl::Barrier::storage | gl::Barrier::command | gl::Barrier::image | gl::Barrier::textureFetch);
  bindVisible(*interpolate_, inputs);
  lowIrradiance_.bind(kLowUnit);
  setFit(*interpolate_, inputs);
  irradiance_.bindImage(0, gl::Access::write);
  refused_.bindImage(kRefusedImage, gl::Access::write);
  chunks_.forEach(irradiance_.size2d(), kIterationsOfInterpolation, kGroup, dispatcher(pass, *interpolate_));
}

void RsmGather::gatherFull(const Inputs& inputs) {
  if (!settings_.interpolates()) {
    const GatherCounts start;
    work_.upload(0, sizeof start, &start);
  }
  for (const Map& map : inputs.maps) {
    const gl::ComputePass pass("gather full", gl::Barrier::storage | gl::Barrier::textureFetch | gl::Barrier::image,
                               gl::Barrier::image);
    const gl::Program& program = *full_[static_cast<std::size_t>(map.rsm.light)];
    bindMap(program, settings_, map, &map != &inputs.maps.front());
    bindVisible(program, inputs);
    irradiance_.bindImage(0, gl::Access::readWrite);
    if (!settings_.interpolates()) {
      chunks_.forEach(irradiance_.size2d(), settings_.samples, kGroup, dispatcher(pass, program));
      continue;
    }
    // How long the list is only the GPU knows: at most every pixel.
    refused_.bind(kRefusedUnit);
    chunks_.forEach(irradiance_.size2d(), settings_.samples, 1, [&](const glm::ivec2& corner, const glm::ivec2& size) {
      const int first = corner.y * irradiance_.size().x + corner.x;
      program.set("listPart", glm::ivec2(first, first + size.x * size.y));
      pass.dispatchIndirect(work_);
    });
  }
  ring_->copy(work_);
}

void RsmGather::collect(bool wait) {
  for (std::vector<GLuint> words = ring_->fetch(wait); !words.empty(); words = ring_->fetch(wait)) {
    const GLuint refused = words[3], surfaces = words[4], lowSamples = words[5];
    ++counts_.frames;
    counts_.pixels += surfaces;
    counts_.refused += refused;
    counts_.gathered += settings_.interpolates() ? lowSamples + refused : surfaces;
  }
}

std::size_t RsmGather::gpuBytes() const {
  std::size_t bytes = pattern_.bytes() + work_.bytes() + ring_->bytes() + irradiance_.bytes();
  if (settings_.interpolates()) bytes += lowIrradiance_.bytes() + refused_.bytes();
  return bytes;
}

}  // namespace lucerna
