#include "forward/local_lights.hpp"

#include "base/error.hpp"
#include "shared/bindings.h"
#include "shared/lights.h"

#include <algorithm>

namespace lucerna {

void LocalLights::place(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings,
                        const std::vector<LightViews>& spots, const std::vector<LightViews>& points,
                        const std::vector<LightViews>& plain) {
  CHECK(std::max(spots.size(), points.size()) <= LIGHTS_MAX_SHADOWS, "{} spots, {} points", spots.size(),
        points.size());
  const auto areSoft = [&](const std::vector<LightViews>& lamps) {
    return std::ranges::any_of(lamps, [&](const LightViews& lamp) {
      const bool isFar = lamp.isPoint && !lamp.omnidirectional();
      return isFar || (settings.penumbrae && lamp.radius > 0.0);
    });
  };
  spotsAreSoft_ = areSoft(spots);
  pointsAreSoft_ = areSoft(points);
  spotViews_.clear();
  pointViews_.clear();
  shared::LightConstants constants{};
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const LightViews& light = spots[i];
    spotViews_.push_back({light.clipFromPlace(0), light.place()});
    constants.spots[i] = {light.clipFromPlace(0),
                          light.place(),
                          static_cast<float>(light.cosInner),
                          glm::vec3(light.direction),
                          static_cast<float>(light.cosOuter),
                          light.intensity,
                          static_cast<float>(light.texelWidth(settings.spotSize)),
                          glm::vec3(0.0f),
                          static_cast<float>(light.radius)};
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LightViews& light = points[i];
    for (std::size_t face = 0; face < light.clipFromWorld.size(); ++face)
      pointViews_.push_back({light.clipFromPlace(face), light.place()});
    // Window depth of a perspective view at the distance m along its axis: f / (f - n) - f n / ((f - n) m).
    const double span = light.far - light.near;
    constants.points[i] = {light.place(),
                           static_cast<float>(light.texelWidth(settings.pointSize)),
                           light.intensity,
                           static_cast<float>(light.far * light.near / span),
                           static_cast<float>(light.radius),
                           0.0f,
                           0.0f,
                           static_cast<float>(light.far / span)};
  }
  constants_ = gl::Buffer("lights", sizeof constants, &constants, gl::Usage::staticDraw);
  std::vector<shared::PlainLamp> lamps;
  for (const LightViews& light : plain)
    lamps.push_back({light.place(), static_cast<float>(light.cosInner), glm::vec3(light.direction),
                     light.omnidirectional() ? -2.0f : static_cast<float>(light.cosOuter), light.intensity,
                     static_cast<float>(light.radius)});
  plain_ = {};
  if (!lamps.empty())
    plain_ = gl::Buffer("lamps without shadows", lamps.size() * sizeof lamps[0], lamps.data(), gl::Usage::staticDraw);
  const auto makeMaps = [&](std::optional<LayeredDepth>& maps, const char* name, const LayeredDepth::Shape& shape) {
    if (shape.layers == 0) maps.reset();
    else if (!maps || maps->shape() != shape) maps.emplace(programs, scene, name, shape);
  };
  const int spotLayers = static_cast<int>(spotViews_.size()), pointLayers = static_cast<int>(pointViews_.size());
  makeMaps(spotShadows_, "spot shadows",
           {gl::TextureKind::array, settings.spotSize, spotLayers, 1, true, spotsAreSoft_});
  makeMaps(pointShadows_, "point shadows",
           {gl::TextureKind::cubeArray, settings.pointSize, pointLayers, 6, true, pointsAreSoft_});
}

void LocalLights::forget() {
  if (spotShadows_) spotShadows_->forget();
  if (pointShadows_) pointShadows_->forget();
}

void LocalLights::bindForShading() const {
  constants_.bindUniform(BLOCK_LIGHTS);
  if (hasPlainLamps()) plain_.bindStorage(PLAIN_LAMPS_BINDING);
  if (spotShadows_) spotShadows_->depth().bind(UNIT_SPOT_SHADOWS);
  if (pointShadows_) pointShadows_->depth().bind(UNIT_POINT_SHADOWS);
}

std::size_t LocalLights::gpuBytes() const {
  return constants_.bytes() + plain_.bytes() + (spotShadows_ ? spotShadows_->gpuBytes() : 0) +
         (pointShadows_ ? pointShadows_->gpuBytes() : 0);
}

}  // namespace lucerna
