// Technique ambient: the same irradiance everywhere, instead of light that is reflected. CONTRIBUTING.md walks through
// this file.
//
// L = albedo / pi * E of every surface, beside its direct light; E: W per square scene unit, for each channel.
#include "base/angles.hpp"
#include "frame/technique.hpp"
#include "shared/bindings.h"

namespace lucerna {

namespace {

struct AmbientSettings {
  float irradiance = 1.0f;
};

std::span<const Setting> ambientSettings() {
  using namespace setting_values;
  static const std::vector<Setting> table{
      {"ambient.irradiance", number(SETTING_FIELD(AmbientSettings, irradiance), 0.0, 1e6), "W per square scene unit",
       "of every surface"},
  };
  return table;
}

class Ambient final : public FrameTechnique {
 public:
  explicit Ambient(const FrameParts& parts)
      : irradiance_(parts.settings.of<AmbientSettings>().irradiance),
        constants_("ambient", sizeof(glm::vec4), &irradiance_, gl::Usage::staticDraw) {}

  std::string surfaceShader() const override { return "ambient/surface.frag"; }
  void bindForShading() const override { constants_.bindUniform(BLOCK_CASCADES); }  // free: there are no grids
  void addShares(const InspectedPixel&, PixelInspection& answer) override {
    answer.add("ambient", "the same everywhere", answer.surface->albedo / kPi * static_cast<double>(irradiance_.x),
               {answer.surface->position});
  }
  std::size_t gpuBytes() const override { return constants_.bytes(); }

 private:
  glm::vec4 irradiance_;
  gl::Buffer constants_;
};

bool isNeeded(const RenderSettings& settings, const SceneFeatures&) {
  return settings.component != Component::direct && settings.of<AmbientSettings>().irradiance > 0.0f;
}

}  // namespace

namespace ambient {

TechniqueEntry technique() {
  return {.name = "ambient",
          .settings = ambientSettings(),
          .reads = {{"shadows"}, {"textures"}},
          .stages = {"constant ambient light"},
          .model = [](const RenderSettings&) { return LightModel{Transport::indirect}; },
          .isNeeded = isNeeded,
          .make = [](const FrameParts& parts) -> std::unique_ptr<FrameTechnique> {
            return std::make_unique<Ambient>(parts);
          }};
}

}  // namespace ambient

}  // namespace lucerna
