#include "rsm/reflective_shadow_map.hpp"

#include "base/error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <vector>

namespace lucerna {

namespace {
constexpr std::array<const char*, 3> kNames{"rsm", "rsm spot", "rsm point"};

double largest(const glm::vec3& v) { return static_cast<double>(std::max({v.x, v.y, v.z})); }
}  // namespace

ReflectiveShadowMap::ReflectiveShadowMap(gl::ProgramLibrary& programs, const GpuScene& scene, const Settings& settings)
    : light_(settings.light) {
  const std::string name = kNames[static_cast<std::size_t>(settings.light)];
  const int layers = settings.light == Light::point ? 6 : 1;
  const auto load = [&](bool masked) {
    gl::ShaderFlags flags = scene.materialFlags(masked);
    flags.insert(flags.end(), {{"PERSPECTIVE", settings.light != Light::sun},
                               {"LAYERS", layers},
                               {"FLUX_COSINE", settings.fluxCosine},
                               {"ALBEDO", settings.albedo},
                               {"HAZE", settings.haze && settings.light == Light::sun}});
    return &programs.loadRaster(fmt::format("{} {}", name, masked ? "masked" : "opaque"), "rsm/rsm.vert",
                                "rsm/rsm.frag", flags, settings.light != Light::sun ? "rsm/rsm.geom" : "");
  };
  programs_.opaque = load(false);
  if (scene.features().alphaMasks) programs_.masked = load(true);
  // Positions and flux in 32 bits: neither world coordinates nor flux in arbitrary units fit into 16. Read texel by
  // texel.
  const glm::ivec3 size(settings.size, settings.size, layers);
  const auto texture = [&](const char* what, gl::Format format) {
    return gl::Texture(fmt::format("{} {}", name, what), format, size, {}, 1, gl::TextureKind::array);
  };
  position_ = texture("position", gl::Format::rgba32f);
  normal_ = texture("normal", gl::Format::rgba16f);
  flux_ = texture("flux", gl::Format::rgba32f);
  depth_ = texture("depth", gl::Format::depth32f);
  std::vector<const gl::Texture*> colors{&position_, &normal_, &flux_};
  if (settings.albedo) {
    albedo_ = texture("albedo", gl::Format::rgba16f);
    colors.push_back(&albedo_);
  }
  framebuffer_ = gl::Framebuffer(name, colors, &depth_);
}

void ReflectiveShadowMap::draw(const GpuScene& scene, bool depthClamp, const GpuScene::Selection* only) {
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  state.depthClamp = depthClamp;
  const gl::RasterPass pass(kNames[static_cast<std::size_t>(light_)], framebuffer_, state);
  for (int attachment = 0; attachment < (albedo() ? 4 : 3); ++attachment) pass.clearColor(attachment, glm::vec4(0.0f));
  pass.clearDepth();
  scene.draw(programs_, {nullptr, nullptr, false}, only);
}

ReflectiveShadowMap::Outputs ReflectiveShadowMap::record(const GpuScene& scene, const SunFrustum& sun) {
  CHECK(light_ == Light::sun, "a map of light kind {}", static_cast<int>(light_));
  const double texelArea = sun.texelArea(size());
  const glm::mat4 clipFromWorld(sun.clipFromWorld);
  if (scene.isSelectionWorthwhile(size()) && (!covering_ || coveredFrom_ != clipFromWorld)) {
    covering_ = scene.covering(clipFromWorld, size());
    coveredFrom_ = clipFromWorld;
  }
  programs_.opaque->set("texelArea", static_cast<float>(texelArea));
  if (programs_.masked) programs_.masked->set("texelArea", static_cast<float>(texelArea));
  draw(scene, false, covering_ ? &*covering_ : nullptr);
  const double irradiance = scene.scene().sun ? largest(scene.scene().sun->irradiance) : 0.0;
  return {position_, normal_, flux_, static_cast<float>(texelArea), irradiance * texelArea * size() * size(),
          light_,    albedo()};
}

ReflectiveShadowMap::Outputs ReflectiveShadowMap::record(const GpuScene& scene, const LightViews& light) {
  CHECK(light_ == (light.omnidirectional() ? Light::point : Light::spot), "a map of light kind {}",
        static_cast<int>(light_));
  for (const gl::Program* program : {programs_.opaque, programs_.masked}) {
    if (!program) continue;
    for (std::size_t i = 0; i < light.clipFromWorld.size(); ++i) {
      program->set(fmt::format("clipFromPlace[{}]", i), light.clipFromPlace(i));
      program->set(fmt::format("viewPlace[{}]", i), light.place());
    }
    program->set("lightPosition", light.place());
    program->set("lightIntensity", light.intensity);
    program->set("lightTangent", static_cast<float>(light.tangent));
    program->set("texelWidth", static_cast<float>(light.texelWidth(size())));
    if (light_ != Light::spot) continue;
    program->set("lightDirection", glm::vec3(light.direction));
    program->set("cosInner", static_cast<float>(light.cosInner));
    program->set("cosOuter", static_cast<float>(light.cosOuter));
  }
  draw(scene, true, nullptr);  // geometry in front of the near plane reflects too
  return {position_, normal_, flux_, 1.0f, largest(light.intensity) * light.largestSolidAngle(size()),
          light_,    albedo()};
}

}  // namespace lucerna
