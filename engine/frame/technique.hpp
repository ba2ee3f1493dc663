// A technique: what the frame asks of it, and its entry in the list of techniques (render/techniques.hpp).
//
// A technique is a folder, engine/NAME with shaders/NAME, and a line of engine/CMakeLists.txt. The folder declares its
// settings (RenderSettings::of), its deviations and a TechniqueEntry. CONTRIBUTING.md walks through a small one.
#pragma once

#include "frame/deviation.hpp"
#include "frame/frame_parts.hpp"
#include "frame/pixel_inspection.hpp"
#include "frame/setting.hpp"
#include "frame/stage_picture.hpp"
#include "gl/pass.hpp"
#include "gl/time_query.hpp"
#include "scene/motion.hpp"

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// What the frame asks of a technique, in the order in which it asks. All but gpuBytes() have a default: nothing.
class FrameTechnique {
 public:
  virtual ~FrameTechnique() = default;

  // Made once, and when the picture's size changes.
  /// The fragment shader of surfaces: it defines what shaders/forward/surface.glsl names, then includes that file.
  virtual std::string surfaceShader() const { return "forward/surface.frag"; }
  /// Flags of that shader.
  virtual gl::ShaderFlags surfaceFlags() const { return {}; }
  /// The depth texture is another now, of the new size.
  virtual void resize() {}
  /// The scene has moved, and the parts with it. False: make another.
  virtual bool follow(const SceneChange&) { return false; }

  // Each frame.
  /// Before record(), for a picture of several samples: what another one of them shows, so that light is found for all
  /// of them at once.
  virtual void see(gl::TimeQuery&, const FrameView&) {}
  /// Passes before shading. Returns whether depth was drawn.
  virtual bool record(gl::TimeQuery&, const FrameView&, FrameEffort) { return false; }
  /// Binds what the surface shader reads.
  virtual void bindForShading() const {}
  /// Adds to the finished picture.
  virtual void addToPicture(gl::TimeQuery&, const FrameView&) {}
  /// Takes results that the GPU has finished. `wait`: all of them.
  virtual void collect(bool /*wait*/) {}
  /// Whether another frame of the same view would look the same.
  virtual bool isSettled() const { return true; }
  /// Whether light is another in each frame although the scene rests: earlier frames show what was.
  virtual bool lightChanges() const { return false; }
  /// For a picture to its end: whether light of the last frame is still to come. Throws Error(fault) where it never
  /// comes. `frames`: how many have been drawn since the first.
  virtual bool lacksLight(std::size_t /*frames*/) const { return false; }
  /// Drops everything kept from frame to frame.
  virtual void forget() {}

  // On request.
  /// Shares of the light that it adds at that pixel. The surface is in `answer`.
  virtual void addShares(const InspectedPixel&, PixelInspection& /*answer*/) {}
  virtual void addStagePictures(std::vector<StagePicture>&) const {}
  /// Names of its own stages that this scene and these settings do without.
  virtual void addLeftOut(std::vector<std::string>&) const {}
  /// Lines to print after a picture: what its frames did, and which walls its light passes through.
  virtual std::string summary() const { return {}; }
  /// Whether it shows media inside of bodies, if only as a preview.
  virtual bool previewsMedia() const { return false; }
  /// Estimated iterations of its largest submission so far (gl/chunks.hpp), and of shading one pixel with its lookup.
  virtual double largestIterations() const { return 0.0; }
  virtual double iterationsOfPixel() const { return 0.0; }
  virtual std::size_t gpuBytes() const = 0;
};

/// One that draws geometry of its own instead of the scene's, with light of its own instead of shadow maps.
class GeometryTechnique : public FrameTechnique {
 public:
  /// How the two sides of surfaces are drawn, one after the other.
  struct Sides {
    gl::Cull cull = gl::Cull::none;
    glm::vec2 polygonOffset{0.0f};
  };
  virtual std::span<const Sides> sides() const = 0;
  virtual const Scene& geometry() const = 0;
  /// inspected: the variant with which one pixel records its terms.
  virtual SurfacePrograms surfacePrograms(bool inspected) const = 0;
  /// Null: the frame's own tone mapping.
  virtual const gl::Program* toneMap() const { return nullptr; }
  virtual void draw(const gl::RasterPass&, const SurfacePrograms&, const FrameView&) = 0;
};

/// One that makes the whole picture: no shadow maps, no depth, no surfaces are drawn.
class PictureTechnique : public FrameTechnique {
 public:
  /// `camera`: in the scene's coordinates, as for inspect().
  virtual void recordPicture(gl::TimeQuery&, const Camera& camera, FrameEffort) = 0;
  /// `pixel`: from the top left.
  virtual PixelInspection inspect(const Camera& camera, glm::ivec2 pixel) = 0;
};

/// The light of a technique's model, against which its error is measured.
struct LightModel {
  Transport transport = Transport::all;
  int bounces = 0;  ///< of Transport::indirect at most; 0: any number
  bool environmentAndEmission = false;  ///< are shown and reflected too, not the sun and lamps alone
};

struct TechniqueEntry {
  /// Settings or stages that several techniques share; "with" names a value ("cache.transport=gather") without which
  /// they are not read.
  struct Shared {
    std::string_view group, with = "";
  };

  std::string_view name;  ///< as in --technique
  std::span<const Setting> settings{};
  std::span<const Deviation> deviations{};
  std::vector<Shared> reads{};  ///< groups of settings of others: "maps", "shadows", "textures"
  std::vector<std::string_view> stages{};  ///< names for what is left out without it
  LightModel (*model)(const RenderSettings&);
  /// Whether a picture needs it at all; without it only direct light is drawn.
  bool (*isNeeded)(const RenderSettings&, const SceneFeatures&);
  std::unique_ptr<FrameTechnique> (*make)(const FrameParts&);

  // Where the defaults are not right.
  bool drawsReflections = false;  ///< what surfaces reflect and let through, besides lamps' highlights
  enum class Media { none, preview, all } media = Media::none;  ///< inside of bodies and boundaries
  bool drawsSurfaces = true;  ///< false: make() gives a GeometryTechnique or PictureTechnique, before the GpuScene
  /// Whether it reflects light of the lamps' maps.
  bool (*readsLightMaps)(const RenderSettings&, const SceneFeatures&) = nullptr;
  /// Changes what other stages do, before they are made. `scene`: about the drawn origin.
  void (*prepare)(RenderSettings&, const Scene& scene) = nullptr;
  /// Settings that belong to its published form besides the deviations.
  void (*publish)(RenderSettings&) = nullptr;
};

}  // namespace lucerna
