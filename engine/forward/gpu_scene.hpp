// A scene's meshes and textures on the GPU, for all raster passes.
#pragma once

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "scene/features.hpp"
#include "scene/motion.hpp"
#include "scene/scene.hpp"

#include <map>
#include <optional>
#include <vector>

namespace lucerna {

struct GpuSceneSettings {
  float anisotropy = 4.0f;  ///< maximum; 1 without the extension
  int pixelSamples = 1;  ///< over which a pixel is averaged: textures need not average over the whole pixel
  bool mipmaps = true;
  bool boundaries = true;  ///< draw meshes of Bsdf::none, which light passes straight through, like any other
};

/// The programs of a pass: masked meshes need a discard, which would disable early depth tests for the others.
struct SurfacePrograms {
  const gl::Program* opaque = nullptr;
  const gl::Program* masked = nullptr;  ///< null exactly when the scene has no alpha masks
};

class GpuScene {
 public:
  GpuScene(const Scene& scene, const SceneFeatures& features, const gl::Capabilities& capabilities,
           const GpuSceneSettings& settings = {});

  /// Flags that every program with materials takes, masked or not.
  gl::ShaderFlags materialFlags(bool masked) const;

  /// Triangles in the order in which they are drawn.
  class Selection {
   public:
    std::size_t gpuBytes() const { return indices_.bytes(); }
    std::size_t triangleCount() const { return indices_.bytes() / (3 * sizeof(std::uint32_t)); }

   private:
    friend class GpuScene;
    struct Draw {  ///< of a mesh
      std::uint32_t firstIndex, indexCount;
      int surface;
      glm::vec3 centre, halfExtent;
      std::uint32_t firstInScene;  ///< of Scene::indices
      bool moves = false;  ///< has ever
      bool hasMoved = false;  ///< since keepPlaces()
    };
    gl::Buffer indices_;
    gl::VertexArray vertexArray_;
    std::vector<Draw> opaque_, masked_;
  };

  /// Draws the meshes inside `clipFromWorld`'s frustum (all if null), nearest first as seen from `viewPoint` (in mesh
  /// order if null); `only`: these triangles of them.
  struct View {
    const glm::mat4* clipFromWorld = nullptr;
    const glm::vec3* viewPoint = nullptr;
    bool anisotropic = true;  ///< filter colours as the settings say; false: what is drawn is not looked at
  };
  void draw(const SurfacePrograms& programs, const View& view, const Selection* only = nullptr) const;
  enum class Meshes { all, still, moving };  ///< moving: those that update() has ever named
  /// Only positions for opaque meshes, in one call if all are drawn; masked meshes with their masks.
  void drawDepth(const SurfacePrograms& programs, Meshes meshes) const;

  /// The triangles that may cover the centre of a texel of a map with size x size texels under a parallel projection,
  /// in the order in which all are drawn: the map is the same, bit by bit. They are found on the CPU.
  Selection covering(const glm::mat4& clipFromWorld, int size) const;
  /// Whether that takes less time than to draw all: where the CPU transforms vertices, and triangles outnumber texels.
  bool isSelectionWorthwhile(int size) const;

  /// The scene's vertices and faces of these meshes, and what its materials' textures do not say, are others.
  void update(const std::vector<std::size_t>& meshes);
  std::size_t poses() const { return poses_; }  ///< so far: calls of update() with any meshes, and the first pose
  std::size_t movingMeshes() const { return movingMeshes_; }  ///< meshes that it has ever named
  /// All its meshes are others, of the same materials.
  void replaceMeshes();

  /// Keeps the places of vertices, as those of the frame before, from the first update() of a mesh on.
  void keepPlaces();
  /// Nobody wants to know them.
  void forgetPlaces() {
    before_ = {};
    movedVertices_.clear();
  }
  /// Whether a mesh has moved since they were kept.
  bool hasMoved() const { return !movedVertices_.empty(); }
  /// Draws the meshes that have. Attribute kPlaceBefore: a vertex's place then.
  void drawMoved(const SurfacePrograms& programs) const;
  static constexpr GLuint kPlaceBefore = 3;

  const Scene& scene() const { return *scene_; }
  const SceneFeatures& features() const { return features_; }
  std::size_t gpuBytes() const;

 private:
  struct Surface {
    glm::vec3 diffuse, specular, emission;
    float alpha;  ///< of the coat; 0: a mirror or glass, which only rays show
    int diffuseTexture = -1, maskTexture = -1, emissionTexture = -1, normalTexture = -1, metalTexture = -1;
    const gl::Sampler* isotropic = nullptr;  ///< of isotropic_, if there is a diffuseTexture
    bool masked = false;
    float normalScale = 0.0f;  ///< 0: no normal map
    float metallic = 0.0f, roughness = -1.0f;  ///< factors of a MetalMap; these values: none
  };
  using Draw = Selection::Draw;
  /// Makes buffer and vertex array of `to`, whose draws are known.
  void uploadIndices(const std::string& name, const std::vector<std::uint32_t>& indices, Selection& to) const;
  void uploadMeshes();
  void setValues(Surface& surface, const Material& material) const;
  void drawRange(const Draw& draw) const;
  void bindSurface(const gl::Program& program, const Surface& surface, bool isotropic) const;

  const Scene* scene_;
  SceneFeatures features_;
  gl::Buffer vertices_, before_;  ///< before_: as kept
  gl::VertexArray withBefore_;
  std::vector<VertexRange> movedVertices_;  ///< since then
  Selection all_;
  std::vector<gl::Texture> textures_;
  std::optional<gl::Texture> white_, coats_;
  std::map<TextureWraps, gl::Sampler> isotropic_;  ///< of colours, if textures are filtered anisotropically
  std::vector<Surface> surfaces_;
  std::size_t poses_ = 1, movingMeshes_ = 0;
  bool boundaries_;  ///< GpuSceneSettings::boundaries
  bool isSoftware_;  ///< the renderer
};

}  // namespace lucerna
