// Direct light's visibility by rays: for each pixel, one bit a light (shaders/rays/shadow_rays.comp). Edges are exact,
// whatever the scene's size, and lights with a size have their penumbrae over a pixel's samples.
#pragma once

#include "gl/objects.hpp"
#include "gl/picture_chunks.hpp"
#include "gl/program.hpp"
#include "rays/path_scene.hpp"

#include <glm/glm.hpp>

#include <cstddef>
#include <optional>
#include <span>

namespace lucerna {

/// A scene's surfaces for rays, without boundaries of media, made when a stage asks for them first.
class TracedScene {
 public:
  /// The scene must outlive it.
  TracedScene(const Scene& scene, const gl::Capabilities& capabilities)
      : source_(&scene), capabilities_(&capabilities) {}
  const PathScene& get();
  /// The scene has changed; its features are the same.
  void update(std::span<const std::size_t> meshes);  ///< whose vertices are others
  std::size_t gpuBytes() const { return scene_ ? scene_->gpuBytes() : 0; }

 private:
  const Scene* source_;
  const gl::Capabilities* capabilities_;
  std::optional<PathScene> scene_;
};

class ShadowRays {
 public:
  static constexpr int kMostLights = 1024;  ///< the sun among them
  struct Lights {
    std::optional<DirectionalLight> sun;
    int lamps = 0;  ///< that the storage block PLAIN_LAMPS_BINDING begins with
  };
  struct View {
    const Camera& camera;  ///< about the drawn origin
    glm::dvec2 offset;  ///< of what pixels show from their centres, in pixels
    int sample, samples;  ///< number of the pixels' sample, and of how many
  };

  /// `origin`: of the drawn coordinates, in the scene's.
  ShadowRays(gl::ProgramLibrary& programs, const PathScene& scene, const glm::dvec3& origin, const Lights& lights,
             double unmeasured);
  void resize(glm::ivec2 size);
  void record(const View& view);
  void bindForShading() const;  ///< unit UNIT_VISIBLE_LIGHTS
  double largestIterations() const { return chunks_.largestIterations(); }
  std::size_t gpuBytes() const { return visible_.bytes(); }

 private:
  const PathScene* scene_;
  glm::dvec3 rayOrigin_;  ///< about the drawn origin
  Lights lights_;
  gl::PictureChunks chunks_;
  gl::Buffer constants_;
  gl::Texture visible_;
  const gl::Program* program_;
};

}  // namespace lucerna
