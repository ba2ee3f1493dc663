#include "rays/shadow_rays.hpp"

#include "gl/chunks.hpp"
#include "gl/pass.hpp"
#include "rays/light_table.hpp"
#include "rays/view_rays.hpp"
#include "scene/motion.hpp"
#include "shared/bindings.h"

#include <algorithm>
#include <bit>

namespace lucerna {

namespace {
constexpr int kShadowGroup = 8;

Scene surfacesOf(Scene scene) {
  std::vector<std::uint32_t> indices;
  for (Mesh& mesh : scene.meshes) {
    const auto first = scene.indices.begin() + mesh.firstIndex, end = first + mesh.indexCount;
    mesh.firstIndex = static_cast<std::uint32_t>(indices.size());
    if (scene.materials[static_cast<std::size_t>(mesh.material)].bsdf == Bsdf::none) mesh.indexCount = 0;
    else indices.insert(indices.end(), first, end);
  }
  scene.indices = std::move(indices);
  return scene;
}

}  // namespace

const PathScene& TracedScene::get() {
  if (scene_) return *scene_;
  const SceneFeatures features = analyse(*source_);
  PathScene::Settings settings{.diffuseOnly = true};
  settings.rays.moves = source_->motion != nullptr;
  if (features.nullBoundaries) scene_.emplace(surfacesOf(*source_), features, *capabilities_, settings);
  else scene_.emplace(*source_, features, *capabilities_, settings);
  return *scene_;
}

void TracedScene::update(std::span<const std::size_t> meshes) {
  if (!scene_) return;
  if (analyse(*source_).nullBoundaries) scene_->update(surfacesOf(*source_), meshes);
  else scene_->update(*source_, meshes);
}

ShadowRays::ShadowRays(gl::ProgramLibrary& programs, const PathScene& scene, const glm::dvec3& origin,
                       const Lights& lights, double unmeasured)
    : scene_(&scene),
      rayOrigin_(scene.origin() - origin),
      lights_(lights),
      chunks_(unmeasured),
      constants_("shadow rays", sizeof(shared::PathConstants), nullptr, gl::Usage::dynamicDraw),
      program_(&programs.loadCompute("shadow rays", "rays/shadow_rays.comp",
                                     gl::with(scene.flags(), {{"LINEAR_SEEDS", 0},
                                                              {"GLOSSY", 0},
                                                              {"SHARED_STACK", scene.rays().sharedStack()},
                                                              {"SUN_RAYS", lights.sun.has_value()},
                                                              {"LAMPS", lights.lamps},
                                                              {"WIDE", lights.lamps + (lights.sun ? 1 : 0) > 32}}))) {}

void ShadowRays::resize(glm::ivec2 size) {
  const int lights = lights_.lamps + (lights_.sun ? 1 : 0), layers = std::max((lights + 127) / 128, 1);
  visible_ = gl::Texture("visible lights", lights > 32 ? gl::Format::rgba32ui : gl::Format::r32ui,
                         glm::ivec3(size, layers), {}, 1, gl::TextureKind::array);
}

void ShadowRays::record(const View& view) {
  shared::PathConstants constants{};
  const glm::ivec2 picture = visible_.size2d();
  setView(constants, view.camera, rayOrigin_, picture, view.offset);
  constants.picture = glm::ivec4(picture, 0, 0);
  constants_.upload(0, sizeof constants, &constants);
  const gl::ComputePass pass("shadow rays", gl::Barrier::textureFetch, gl::Barrier::image);
  program_->use();
  constants_.bindUniform(BLOCK_CACHE_PATHS);
  scene_->bind();
  visible_.bindImage(0, gl::Access::write);
  program_->set("drawnOrigin", glm::vec3(-rayOrigin_));
  program_->set("pixelSample", view.samples > 1 ? view.sample : -1);
  program_->set("samplesOfPixel", std::bit_ceil(static_cast<unsigned>(view.samples)));
  if (lights_.sun) {
    program_->set("sunDirection", glm::vec3(lights_.sun->direction));
    program_->set("sunLessCosine", sunLessCosine(*lights_.sun));
  }
  const double iterations = (1.0 + lights_.lamps + (lights_.sun ? 1.0 : 0.0)) * gl::kIterationsOfRay;
  chunks_.forEach(picture, iterations, kShadowGroup, [&](glm::ivec2 corner, glm::ivec2 size) {
    program_->set("firstPixel", corner);
    pass.dispatch(glm::ivec3(size, 1), glm::ivec3(kShadowGroup, kShadowGroup, 1));
  });
}

void ShadowRays::bindForShading() const { visible_.bind(UNIT_VISIBLE_LIGHTS); }

}  // namespace lucerna
