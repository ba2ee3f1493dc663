// A scene as plain data (no GL): written by the loaders, read by every technique.
//
// Space: right-handed, +y up unless the file says otherwise, lengths in scene units; `metresPerUnit` is the length of a
// unit. Colours are linear. Reflectances are Lambertian albedos (exitance over irradiance), 0..1.
#pragma once

#include "base/image.hpp"
#include "scene/medium.hpp"

#include <glm/glm.hpp>

#include <cmath>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// Axis-aligned bounds; empty until something is added.
struct Bounds {
  glm::dvec3 min{1e300};
  glm::dvec3 max{-1e300};
  bool empty() const { return min.x > max.x; }
  void add(const glm::dvec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  void add(const Bounds& b) {
    min = glm::min(min, b.min);
    max = glm::max(max, b.max);
  }
  glm::dvec3 centre() const { return 0.5 * (min + max); }
  double farthestFrom(const glm::dvec3& p) const { return glm::length(glm::max(glm::abs(min - p), glm::abs(max - p))); }
  glm::dvec3 extent() const { return empty() ? glm::dvec3(0.0) : max - min; }
};

/// A vertex as laid out in the vertex buffer: attribute 0 position, 1 texture coordinate, 2 normal.
struct Vertex {
  glm::vec3 position{0.0f};
  glm::vec2 texCoord{0.0f};  ///< v = 0 is the bottom row of a texture (OBJ, OpenGL)
  glm::vec3 normal{0.0f, 1.0f, 0.0f};
};

/// What a texture shows where a coordinate lies outside of its picture's 0..1.
enum class TextureWrap {
  repeat,  ///< the picture again
  edge,  ///< the texels of its edge; what is read at the edge is theirs alone
  mirror,  ///< the picture again, every other time mirrored
};

struct TextureWraps {
  TextureWrap u = TextureWrap::repeat, v = TextureWrap::repeat;
  bool repeat() const { return u == TextureWrap::repeat && v == TextureWrap::repeat; }
  auto operator<=>(const TextureWraps&) const = default;
};

/// A picture used by materials; several materials may share one. A picture with two wraps is two textures.
struct Texture {
  std::filesystem::path file;  ///< its source, for messages
  Bitmap bitmap;  ///< 8-bit; albedo maps are sRGB-encoded
  TextureWraps wraps = {};
};

/// How a surface scatters light. Real-time techniques show only diffuse and rough conductors as the path tracer does.
enum class Bsdf {
  diffuse,  ///< Lambert, under a rough coat if `specular` is above 0 (scene/coat.hpp)
  mirror,  ///< reflects `specular`, smooth
  conductor,  ///< GGX of `roughness`, Fresnel by Schlick between `specular` at normal incidence and 1
  dielectric,  ///< reflects and refracts by `ior`; smooth at roughness 0, else GGX
  none,  ///< only a boundary between media: light passes straight through
};

/// A surface whose metallic share, roughness or highlight vary by texel [GLTF2, appendix B]: base colour b = `base` *
/// diffuseTexture, m = `metallic` * blue, r = `roughness` * green; then diffuse b (1 - m), specular mix(0.04, b, m),
/// GGX alpha r^2. A negative roughness: the material's own specular and roughness.
struct MetalMap {
  glm::vec3 base{1.0f};
  float metallic = 1.0f;
  float roughness = 1.0f;
  int texture = -1;  ///< its green and blue, not sRGB-encoded; -1: white
};

struct Material {
  std::string name;
  Bsdf bsdf = Bsdf::diffuse;
  float roughness = 0.0f;  ///< GGX alpha, 0..1; 0: smooth; a coat's is at least COAT_LEAST_ALPHA
  float ior = 1.5f;  ///< of the inside (against the normal) relative to vacuum
  int interior = -1;  ///< index into Scene::media of the interior of a dielectric or none; -1: vacuum
  int priority = 0;  ///< where two closed dielectrics overlap, the higher one counts [SchmidtBudge2002]
  glm::vec3 diffuse{0.5f};  ///< albedo factor of the base, multiplies the texture
  glm::vec3 specular{0.0f};  ///< reflectance at normal incidence
  glm::vec3 emission{0.0f};  ///< emitted radiance (Ke); with an emission texture, its mean
  glm::vec3 emissionScale{0.0f};  ///< with an emission texture: emitted radiance where that is white
  float opacity = 1.0f;  ///< d
  int emissionTexture = -1;  ///< emission texture (map_Ke), sRGB-encoded; radiosity uses its mean over a patch
  int diffuseTexture = -1;  ///< index into Scene::textures, -1: none
  int alphaTexture = -1;  ///< mask in its own file (map_d); its red channel, or its alpha where it has one
                          ///< (bitmap.hasAlpha); not sRGB-encoded, and never a diffuseTexture of this material
  bool alphaMasked = false;  ///< cut out where alpha < 0.5, from alphaTexture or the diffuse texture's alpha
  int normalTexture =
      -1;  ///< normals, x along u and y along v, as 0.5 + 0.5 n; not sRGB-encoded (shaders/lib/normal_map.glsl)
  float normalScale = 1.0f;  ///< on their x and y
  std::optional<MetalMap> metalMap;  ///< then diffuse, specular and roughness are those of the texture's mean
};

/// A run of indices drawn with one material.
struct Mesh {
  std::string name;
  std::uint32_t firstIndex = 0;
  std::uint32_t indexCount = 0;  ///< a multiple of 3
  int material = 0;
  Bounds bounds;
};

/// Seen from the Earth, in radians.
inline constexpr double kSunDiameter = 0.53 * 3.14159265358979323846 / 180.0;

/// The sun: light from a disc, infinitely far away, of the same radiance everywhere.
struct DirectionalLight {
  glm::dvec3 direction{0.0, -1.0, 0.0};  ///< unit vector along which the light travels
  glm::vec3 irradiance{0.0f};  ///< on a plane perpendicular to the rays, W/m^2 in scene units
  double angularDiameter = 0.0;  ///< of the disc, radians, below pi; 0: parallel rays, shadows without penumbra
};

/// A lamp with a cone of light. Radiant intensity at an angle theta from `direction`:
/// I(theta) = intensity * smoothstep((cos theta - cos outerAngle) / (cos innerAngle - cos outerAngle)), smoothstep(t) =
/// t^2 (3 - 2 t) for t clamped to [0,1]; equal angles make a hard edge. Since smoothstep is antisymmetric about t =
/// 1/2, the whole cone's flux is intensity * 2 pi * (1 - (cos innerAngle + cos outerAngle) / 2).
struct SpotLight {
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, -1.0, 0.0};  ///< unit, the cone's axis, away from the lamp
  glm::vec3 intensity{0.0f};  ///< radiant intensity on the axis, W/sr
  double innerAngle = 0.5;  ///< half angle of the cone of full intensity, radians; 0..outerAngle
  double outerAngle = 0.7;  ///< half angle of the cone, radians; above 0, at most kLargestSpotAngle
  double radius = 0.0;  ///< as PointLight's
  std::string name = {};  ///< empty: none
};

/// A lamp of the same intensity in all directions; its flux is 4 pi intensity.
struct PointLight {
  glm::dvec3 position{0.0};
  glm::vec3 intensity{0.0f};  ///< radiant intensity, W/sr
  double radius =
      0.0;  ///< of a ball that is not seen itself, of the same radiance everywhere, intensity / (pi radius^2)
  std::string name = {};  ///< empty: none
};

/// A spot light has one perspective shadow map, so its cone must be well below a half space: 80 degrees.
inline constexpr double kLargestSpotAngle = 80.0 * 3.14159265358979323846 / 180.0;

/// A view of the scene, in perspective or, from glTF files, orthographic. Positions in double, for precision far from
/// the origin.
struct Camera {
  std::string name;
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< unit
  glm::dvec3 up{0.0, 1.0, 0.0};  ///< unit, not parallel to direction
  double verticalFov = 0.9;  ///< radians; not read of an orthographic view
  double orthographicHeight = 0.0;  ///< above 0: an orthographic view of this height, scene units, whose rays are
                                    ///< parallel to `direction` and start in the plane through `position`

  bool isOrthographic() const { return orthographicHeight > 0.0; }
  /// Half the height of the view at distance 1 along it; of an orthographic one, at any distance.
  double halfHeight() const { return isOrthographic() ? 0.5 * orthographicHeight : std::tan(0.5 * verticalFov); }

  bool seesAs(const Camera& other) const {
    return position == other.position && direction == other.direction && up == other.up &&
           verticalFov == other.verticalFov && orthographicHeight == other.orthographicHeight;
  }
};

/// Light from infinity in all directions. A latitude-longitude picture: u grows with atan2(x, -z), v from +y (top row)
/// to -y.
struct Environment {
  glm::vec3 radiance{0.0f};  ///< constant, or a factor that scales the picture
  std::optional<Image> picture;  ///< linear radiance
  double rotation = 0.0;  ///< about +y, radians
};

struct SceneMotion;

struct Scene {
  std::string name;  ///< file stem
  std::filesystem::path file;  ///< the loaded file
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;  ///< triangles
  std::vector<Mesh> meshes;
  std::vector<Material> materials;  ///< at least one if there is a mesh
  std::vector<Texture> textures;
  std::optional<DirectionalLight> sun;
  bool defaultSun = false;  ///< no file has a light, so the sun is the default
  std::vector<SpotLight> spots;
  std::vector<PointLight> points;
  std::vector<Medium> media;
  int cameraMedium = -1;  ///< index of the medium around the camera outside all boundaries; -1: vacuum
  std::optional<Environment> environment;  ///< seen behind the scene; lights it in the path tracer, in radiosity and
                                           ///< in the irradiance cache
  std::vector<Camera> cameras;  ///< never empty after loading: the first is the default view
  Bounds bounds;  ///< of everything, during the whole motion
  std::optional<Bounds> mainBounds;  ///< without meshes that are far off and small (main_bounds.hpp), if it has such
  glm::dvec3 origin{0.0};  ///< taken off all positions, in double: places in files and options are places here + origin
  double metresPerUnit = 1.0;
  glm::vec3 background{0.0f};  ///< radiance visible where there is neither surface nor environment; it lights nothing
  float exposure = 1.0f;  ///< multiplies radiance before tone mapping
  bool defaultExposure = false;  ///< no file has one: it is chosen for the view (setDefaultExposure)
  bool studio = false;  ///< no file says how it is seen and lit: as scene/studio.hpp does
  std::filesystem::path keyFrames;  ///< the walk's camera path; empty: none named
  std::shared_ptr<SceneMotion> motion;  ///< scene/motion.hpp; null: nothing moves
  double time = 0.0;  ///< at which it is posed, seconds
  std::size_t degenerateTriangles = 0;  ///< of zero area, kept so that counts agree with the file's: code that divides
                                        ///< by an area or normalises a face normal must expect them
  std::size_t droppedTriangles = 0;  ///< left out while loading: a position is not finite

  std::size_t triangleCount() const { return indices.size() / 3; }
  const Bounds& main() const { return mainBounds ? *mainBounds : bounds; }
  bool isMain(const glm::dvec3& place) const {
    return !mainBounds || glm::clamp(place, mainBounds->min, mainBounds->max) == place;
  }
  /// The main bounds, or as large ones around a place that is far from them.
  Bounds mainAround(const glm::dvec3& place) const;
};

/// Reads a scene: a scene JSON (ours; see scene_file.cpp for its keys) or any format that Assimp reads.
/// Problems that leave something to show (missing texture, missing MTL) give one warning naming the file; others
/// (missing file, a folder, nothing to draw, truncated or malformed data) throw Error(badInput).
/// Files without any light get the default sun, files without a camera a view computed from the bounds.
Scene loadScene(const std::filesystem::path& file);

}  // namespace lucerna
