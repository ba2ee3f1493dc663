// What readers of model files append to a scene (no GL; private to engine/scene). Nothing here depends on the library
// that read the file.
#pragma once

#include "scene/scene.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

inline bool isFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// File names as Windows exporters write them.
std::string withForwardSlashes(std::string path);

/// The file that a model names: relative to it; if the path is from another machine, the bare name beside it, also in
/// other letters of upper and lower case. Where there is none, the first of these.
std::filesystem::path fileBeside(const std::filesystem::path& model, const std::string& name);

float clampedNumber(float value, float low, float high, float fallback);

/// Diffuse and specular colour and scattering by base colour, metallic share and roughness (glTF's: the root of GGX's
/// alpha).
void setMetallicRoughness(Material& material, const glm::vec3& base, float metallic, float roughness,
                          float transmission);

/// Mean over all texels, encoded values in 0..1.
glm::vec3 meanValue(const Bitmap& bitmap);

/// A picture as a model uses it.
struct PictureUse {
  std::string name;  ///< of a TextureLoader; empty: none
  TextureWraps wraps = {};
  bool empty() const { return name.empty(); }
  auto operator<=>(const PictureUse&) const = default;
};

/// Reads every picture once for each of its wraps; a picture that cannot be read is one warning.
class TextureLoader {
 public:
  /// The picture of that name inside the model file, if there is one; `label` names it in messages.
  using Embedded = std::function<std::optional<Bitmap>(const std::string& name, const std::filesystem::path& label)>;

  TextureLoader(Scene& scene, Embedded embedded) : scene_(scene), embedded_(std::move(embedded)) {}

  /// Index of an albedo map; the shared checker if it cannot be read; -1 if the material has none.
  int albedo(const PictureUse& picture);
  /// Index of a picture that only refines the material: -1 also if it cannot be read.
  int optional(const PictureUse& picture);
  /// The same of a picture that is kept only if `isWanted`.
  int optionalIf(const PictureUse& picture, bool (*isWanted)(const Bitmap&));
  /// The mean of a picture that is not kept, encoded values in 0..1; 1 without a picture.
  glm::vec3 mean(const std::string& name);
  /// An albedo map whose alpha is shifted so that `threshold` becomes 0.5, the cut-off of masks. The cut stays at the
  /// same texture coordinates, since adding a constant commutes with interpolation.
  int withThreshold(int texture, double threshold);

  const Bitmap& operator[](int texture) const { return scene_.textures[static_cast<std::size_t>(texture)].bitmap; }

 private:
  int load(const PictureUse& picture);
  std::optional<Texture> read(const PictureUse& picture);
  int checker();

  Scene& scene_;
  Embedded embedded_;
  std::map<PictureUse, int> indices_;
  std::map<std::pair<int, double>, int> moved_;
  std::vector<std::string> unreadable_;
  int checker_ = -1;
};

/// Maximum depth of nodes: importers recurse once per level.
inline constexpr int kMostNodeDepth = 1000;

/// A mesh as its file has it. Without normals or texture coordinates these are empty.
struct MeshData {
  std::string name;
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> texCoords;  ///< (0, 0) is the lower left corner of a picture
  std::vector<std::array<unsigned, 3>> triangles;
};

/// Appends one mesh as placed by one node. Vertices that are equal become one, unless the mesh moves: then it has those
/// of `source`.
enum class SharedVertices { yes, no };
void appendMesh(Scene& scene, const MeshData& source, const glm::dmat4& worldFromNode, int material,
                SharedVertices shared = SharedVertices::yes);

/// Vertices and faces of a mesh that was appended without shared vertices, of another pose of the same source.
void replaceMesh(Scene& scene, std::size_t mesh, const MeshData& source, const glm::dmat4& worldFromNode);

/// `radiance`: where the picture is white; texture -1: none.
void setEmission(Material& material, const glm::vec3& radiance, int texture, const TextureLoader& textures);

/// A light as its file has it, in world space.
struct ModelLight {
  enum class Kind { directional, point, spot, other };
  std::string name;
  Kind kind = Kind::other;
  glm::dvec3 position{0.0}, direction{0.0};
  glm::vec3 colour{0.0f};
  float attenuation = 1.0f;  ///< quadratic
  double innerAngle = 0.0, outerAngle = 0.0;  ///< of a spot, from its axis
  std::size_t node = 0;  ///< of glTF files
  std::function<glm::vec3(double seconds)> colourAt{};  ///< if it is animated
};

/// Returns where each has become one of the scene's: of those of its kind; -1: ignored.
std::vector<int> appendLights(Scene& scene, std::span<const ModelLight> lights);

/// Cameras whose directions need not be unit or perpendicular. Returns the places of those that are kept, -1 otherwise.
std::vector<int> appendCameras(Scene& scene, std::span<const Camera> cameras);

/// What a reader returns once it has appended the meshes and their materials.
struct ModelViews {
  std::vector<ModelLight> lights;
  std::vector<Camera> cameras;
  // Of animated glTF files:
  std::vector<std::size_t> cameraNodes{};  ///< one a camera
  std::function<glm::dmat4(std::size_t node, double seconds)> worldFromNode{};
  std::function<bool(std::size_t node)> moves{};
};

/// Readers of formats. `content`: of scene.file.
ModelViews readGltf(Scene& scene, std::span<const std::uint8_t> content);
void readObj(Scene& scene, std::span<const std::uint8_t> content);
void readPly(Scene& scene, std::span<const std::uint8_t> content);
void readStl(Scene& scene, std::span<const std::uint8_t> content);

}  // namespace lucerna
