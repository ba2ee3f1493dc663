#include "rsm/light_maps.hpp"

#include <algorithm>

namespace lucerna {

namespace {

std::vector<ReflectiveShadowMap::Light> lightsOf(const FrameParts& parts) {
  using Light = ReflectiveShadowMap::Light;
  std::vector<Light> lights(parts.features.directionalLight ? 1 : 0, Light::sun);
  lights.insert(lights.end(), parts.spots.size(), Light::spot);
  lights.insert(lights.end(), parts.points.size(), Light::point);
  return lights;
}

}  // namespace

LightMaps::LightMaps(const FrameParts& parts, bool albedo) : parts_(parts) {
  for (const ReflectiveShadowMap::Light light : lightsOf(parts)) {
    auto settings = parts.settings.of<ReflectiveShadowMap::Settings>();
    settings.light = light;
    settings.albedo = albedo;
    if (light == ReflectiveShadowMap::Light::point) settings.size = std::max(settings.size / 2, 1);
    maps_.emplace_back(parts.programs, parts.drawn(), settings);
  }
}

bool LightMaps::follow() {
  forget();
  return std::ranges::equal(maps_, lightsOf(parts_), {}, &ReflectiveShadowMap::light);
}

const std::vector<ReflectiveShadowMap::Outputs>& LightMaps::record(gl::TimeQuery& timer) {
  if (maps_.empty() || !willBeDrawn()) return outputs_;
  const gl::TimeQuery::Scope stage(timer, "rsm");
  outputs_.clear();
  auto spot = parts_.spots.begin(), point = parts_.points.begin();
  for (ReflectiveShadowMap& map : maps_) switch (map.light()) {
      case ReflectiveShadowMap::Light::sun: outputs_.push_back(map.record(parts_.drawn(), parts_.sun)); break;
      case ReflectiveShadowMap::Light::spot: outputs_.push_back(map.record(parts_.drawn(), *spot++)); break;
      case ReflectiveShadowMap::Light::point: outputs_.push_back(map.record(parts_.drawn(), *point++)); break;
    }
  made_ = true;
  return outputs_;
}

void LightMaps::addStagePictures(std::vector<StagePicture>& pictures) const {
  using Kind = StagePicture::Kind;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const std::string name = "rsm " + std::to_string(i + 1) + " ";
    pictures.push_back({Kind::flux, name + "flux", &outputs_[i].flux});
    pictures.push_back({Kind::normal, name + "normal", &outputs_[i].normal});
    pictures.push_back({Kind::position, name + "position", &outputs_[i].position});
  }
}

std::size_t LightMaps::gpuBytes() const {
  std::size_t bytes = 0;
  for (const ReflectiveShadowMap& map : maps_) bytes += map.gpuBytes();
  return bytes;
}

}  // namespace lucerna
