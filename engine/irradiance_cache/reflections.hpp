// What coats, mirrors and glass show of the scene in the technique irradiance-cache: rays from each of their pixels,
// lit at their ends by the records (shaders/irradiance_cache/reflect.comp). Those of rough coats are averaged with the
// pixels beside (smooth.comp). Lamps' highlights are forward shading's.
#pragma once

#include "forward/visible_surfaces.hpp"
#include "frame/frame_parts.hpp"
#include "gl/objects.hpp"
#include "gl/picture_chunks.hpp"
#include "gl/program.hpp"
#include "irradiance_cache/bodies.hpp"
#include "scene/features.hpp"
#include "scene/scene.hpp"

#include <functional>
#include <optional>

namespace lucerna {

class Reflections {
 public:
  static bool isNeeded(const SceneFeatures& features, int rays) {
    return (features.specular && rays > 0) || showsClouds(features, rays);
  }
  /// Whether surfaces are seen through clouds, whose boundaries are then not drawn.
  static bool showsClouds(const SceneFeatures& features, int rays) { return Bodies::hasClouds(features) && rays > 0; }
  /// flags: of programs that trace rays and look up records. rays: per pixel. hasCoats: rough surfaces reflect. bodies:
  /// if the scene has media.
  Reflections(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const Scene& scene,
              const SceneFeatures& features, const gl::ShaderFlags& flags, int rays, bool hasCoats, double unmeasured,
              std::optional<Bodies> bodies);

  void resize(glm::ivec2 size);
  /// A sample's share of a pixel's rays, and the weight of what they find.
  struct Share {
    int rays = 0;
    float weight = 1.0f;
    bool keepsCoats = false;  ///< pixels that showed a coat keep what the sample before found there
  };
  /// At least one. In a picture that is shown when it is whole the first samples trace all rays of coats: their edges
  /// are those of the surface. In motion further samples of a frame trace rays only where the frame has seen no coat
  /// yet. Mirrors and glass show edges of their own.
  Share shareOf(int sample, int samples, FrameEffort effort) const;
  /// For the view that IrradianceCache::show() or update() had last. sample: number of the pixels' sample. visible,
  /// worldFromClip: that view's. bind: scene, records and their constants.
  void record(int sample, const Share& share, const VisibleSurfaces& visible, const glm::mat4& worldFromClip,
              const std::function<void()>& bind);
  void clear();  ///< nothing is reflected
  void bindForShading() const;  ///< unit UNIT_REFLECTED for shaders/irradiance_cache/surface.frag
  double largestIterations() const { return chunks_.largestIterations(); }
  std::size_t gpuBytes() const {
    return radiance_.bytes() + (smooth_ ? averaged_.bytes() : 0) + (bodies_ ? bodies_->gpuBytes() : 0);
  }

 private:
  void smooth(const VisibleSurfaces& visible, const glm::mat4& worldFromClip) const;

  int rays_;
  bool coatsAlone_;  ///< no mirrors, glass or clouds
  bool clearTexture_;
  int lamps_;
  std::optional<Bodies> bodies_;
  gl::PictureChunks chunks_;
  gl::Texture radiance_;  ///< W per square scene unit and steradian, of each pixel
  gl::Texture averaged_;  ///< the same, along one axis; only with coats
  const gl::Program* program_;
  const gl::Program* smooth_ = nullptr;  ///< only with coats
};

}  // namespace lucerna
