#include "irradiance_cache/reflections.hpp"

#include "gl/pass.hpp"
#include "shared/bindings.h"

#include <array>
#include <utility>

namespace lucerna {

namespace {
constexpr int kReflectionGroup = 8;
constexpr double kRaysOfEach = 4.0;  ///< on average: it passes mirrors and glass, and lamps are looked for at its end
constexpr double kRaysThroughMedia = 12.0;  ///< with the boundaries and collisions of a body or cloud

bool hasCoatsAlone(const SceneFeatures& features) {
  return !features.mirrors && !features.conductors && !features.dielectrics && !Bodies::isNeeded(features);
}
}  // namespace

Reflections::Reflections(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
                         const SceneFeatures& features, const gl::ShaderFlags& flags, int rays, bool hasCoats,
                         double unmeasured, std::optional<Bodies> bodies)
    : rays_(rays),
      coatsAlone_(hasCoats && hasCoatsAlone(features)),
      clearTexture_(capabilities.clearTexture),
      lamps_((scene.sun ? 1 : 0) + static_cast<int>(scene.spots.size() + scene.points.size())),
      bodies_(std::move(bodies)),
      chunks_(unmeasured),
      program_(&programs.loadCompute(
          "cache reflections", "irradiance_cache/reflect.comp",
          gl::with(gl::with(flags, {{"FRESNEL_AMPLITUDES", 0}, {"FRESNEL_SCHLICK", 0}, {"LAMPS", lamps_}}),
                   bodies_ ? bodies_->flags() : gl::ShaderFlags{{"BODIES", 0}, {"CLOUDS", 0}, {"GRIDS", 0}}))),
      smooth_(hasCoats ? &programs.loadCompute("cache smooth reflections", "irradiance_cache/smooth.comp", {})
                       : nullptr) {}

void Reflections::resize(glm::ivec2 size) {
  radiance_ = gl::Texture("reflections", gl::Format::rgba32f, size);
  if (smooth_) averaged_ = gl::Texture("averaged reflections", gl::Format::rgba32f, size);
}

Reflections::Share Reflections::shareOf(int sample, int samples, FrameEffort effort) const {
  const int rays = (rays_ + samples - 1) / samples;
  if (!coatsAlone_) return {rays};
  if (!effort.wholePicture) return {.rays = rays, .keepsCoats = effort.isFurtherSample};
  const int tracing = (rays_ + rays - 1) / rays;
  return {sample < tracing ? rays : 0, static_cast<float>(samples) / static_cast<float>(tracing)};
}

void Reflections::clear() {
  const std::array<const gl::Texture*, 1> textures{&radiance_};
  gl::clearToZero(textures, clearTexture_);
}

void Reflections::record(int sample, const Share& share, const VisibleSurfaces& visible, const glm::mat4& worldFromClip,
                         const std::function<void()>& bind) {
  {
    const gl::ComputePass pass("cache reflections", gl::Barrier::textureFetch, gl::Barrier::image);
    program_->use();
    bind();
    if (bodies_) bodies_->bind(*program_);
    program_->set("rays", share.rays);
    program_->set("weight", share.weight);
    program_->set("keepsCoats", share.keepsCoats);
    program_->set("pixelSample", sample);
    radiance_.bindImage(0, gl::Access::readWrite);
    const double ofEach = bodies_ ? kRaysThroughMedia : kRaysOfEach;
    // Its own ray, one to what shines, and one to each lamp.
    const double iterations = (1.0 + ofEach * share.rays * (2 + lamps_)) * gl::kIterationsOfRay;
    chunks_.forEach(radiance_.size2d(), iterations, kReflectionGroup, [&](glm::ivec2 corner, glm::ivec2 size) {
      program_->set("firstPixel", corner);
      pass.dispatch(glm::ivec3(size, 1), glm::ivec3(kReflectionGroup, kReflectionGroup, 1));
    });
  }
  if (smooth_ && !share.keepsCoats) smooth(visible, worldFromClip);
}

void Reflections::smooth(const VisibleSurfaces& visible, const glm::mat4& worldFromClip) const {
  for (const bool across : {false, true}) {
    const gl::ComputePass pass("cache smooth reflections", gl::Barrier::textureFetch,
                               across ? gl::Barrier::image : gl::Barrier::none);
    smooth_->use();
    visible.bind(*smooth_, worldFromClip);
    smooth_->set("along", across ? glm::ivec2(0, 1) : glm::ivec2(1, 0));
    (across ? averaged_ : radiance_).bind(UNIT_REFLECTED);
    (across ? radiance_ : averaged_).bindImage(0, gl::Access::write);
    pass.dispatch(glm::ivec3(radiance_.size2d(), 1), glm::ivec3(kReflectionGroup, kReflectionGroup, 1));
  }
}

void Reflections::bindForShading() const { radiance_.bind(UNIT_REFLECTED); }

}  // namespace lucerna
