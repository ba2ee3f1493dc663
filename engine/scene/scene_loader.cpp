// Loads models through Assimp: geometry into one vertex and one index buffer, materials, textures, cameras and the sun.
//
// Decisions where files are silent:
// - Missing normals are made by Assimp, smooth across edges up to kCreaseAngle.
// - Triangles with positions that are not finite are dropped and counted (Scene::droppedTriangles); lines and points
//   are dropped. Triangles of zero area are counted (Scene::degenerateTriangles) and kept: Crytek Sponza has one, and
//   its published count of 262,267 should be met.
// - Vertices of a mesh are merged if all their floats are equal, bit by bit: no tolerance, so that scenes of any scale
//   keep their shape.
// - A material with opacity 0 would be invisible; exporters that mix up `d` and `Tr` write it for solid things, so it
//   counts as 1.
// - Metallic-roughness (glTF 2.0, appendix B): diffuse = base (1 - metallic), specular = mix(0.04, base, metallic),
//   Blinn-Phong exponent 2 / roughness^4 - 2 (alpha = roughness^2; B. Karis, "Specular BRDF Reference", 2013). glTF's
//   textures of it are read texel by texel (MetalMap). Code that treats a material as a whole, and files of other
//   formats, use their mean, which preserves a surface's total.
// - glTF 2 is read from its own JSON where Assimp 5.2.5 leaves things out (gltf_file.hpp): KHR_texture_transform goes
//   into the texture coordinates, alphaCutoff over baseColorFactor's alpha into the mask,
//   KHR_materials_emissive_strength into the emission, KHR_materials_volume into a medium, colours that all vertices of
//   a mesh share into its material. Unsupported properties give one warning per material. Occlusion textures are not
//   read: techniques compute that light themselves.
// - Scattering in the path tracer (Material::bsdf; the real-time techniques do not read it). MTL: illum 5 is a mirror
//   of Ks; illum 4, 6, 7 and 9 with an Ni are a smooth dielectric of that index (Ni 1: a boundary without effect).
//   glTF: transmission above 0.5 is a dielectric of index 1.5, otherwise metallic above 0.5 a conductor of the base
//   colour; alpha = roughness^2. Everything else is Lambertian.
// - Lights: a directional light's colour is its irradiance, that of a spot or point light its radiant intensity in
//   W/sr, as in the file (glTF's candela are not divided by a luminous efficacy); if other formats give a quadratic
//   attenuation q, colour / q. Constant and linear attenuation are unphysical and ignored.
// - Lamps far too weak or strong for an exposure of 1, since their units are arbitrary: another exposure, with a
//   warning.
// - No light in the file: a sun, over the shoulder of a view that we chose, otherwise slanted to suit courtyards and
//   halls; and its clear sky (set in loadScene, as the sun may still be turned). No camera: the first key of
//   keyFrames/<stem>.txt if the repository has one, otherwise a view from outside that frames the bounding sphere.
#include "scene/scene_file.hpp"

#include "base/angles.hpp"
#include "base/data.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/clear_sky.hpp"
#include "scene/gltf_file.hpp"
#include "scene/import_guard.hpp"
#include "scene/key_frames.hpp"
#include "scene/shininess.hpp"
#include "scene/texture_mean.hpp"

#include <assimp/DefaultIOSystem.h>
#include <assimp/GltfMaterial.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <unordered_map>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

constexpr float kCreaseAngle = 60.0f;  // degrees between faces
constexpr double kDefaultFov = 50.0 * kPi / 180.0;

/// Slanted, so that walls are lit too. In Crytek Sponza it reaches a quarter of the court's floor and the curtains on
/// +z.
const glm::dvec3 kDefaultSunDirection = glm::normalize(glm::dvec3(0.12, -1.0, 0.2));
/// For the default view from outside: over its right shoulder, so that all visible sides of a box are lit, and also a
/// sheet that faces +z.
const glm::dvec3 kSunOverShoulder = glm::normalize(glm::dvec3(-0.3, -1.0, -0.6));
const glm::vec3 kDefaultSunIrradiance(10.0f, 9.6f, 9.0f);
/// Match that sun and its sky, some 12 W/unit^2: white stands at 0.4 * 0.8 * 12 / pi = 1.2 before the tone curve.
const float kExposureOutside = 0.4f, kExposureInside = 3.0f;

glm::dvec3 toGlm(const aiVector3D& v) { return {v.x, v.y, v.z}; }
glm::vec3 toGlm(const aiColor3D& c) { return {c.r, c.g, c.b}; }
bool isFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Row-major Assimp to column-major GLM.
glm::dmat4 toGlm(const aiMatrix4x4& m) {
  return glm::transpose(
      glm::dmat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4));
}

/// File names as Windows exporters write them.
std::string withForwardSlashes(std::string path) {
  std::replace(path.begin(), path.end(), '\\', '/');
  return path;
}

/// File access for Assimp: replaces backslashes, serves the checked model from memory, and records missing material
/// libraries (Assimp only logs them).
class ModelFiles : public Assimp::IOSystem {
 public:
  ModelFiles(std::string model, std::span<const std::uint8_t> content) : model_(std::move(model)), content_(content) {}

  bool Exists(const char* file) const override { return disk_.Exists(withForwardSlashes(file).c_str()); }
  char getOsSeparator() const override { return disk_.getOsSeparator(); }
  bool ComparePaths(const char* one, const char* other) const override { return disk_.ComparePaths(one, other); }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  Assimp::IOStream* Open(const char* file, const char* mode = "rb") override {
    if (model_ == file) return new Assimp::MemoryIOStream(content_.data(), content_.size());
    const std::string path = withForwardSlashes(file);
    Assimp::IOStream* stream = disk_.Open(path.c_str(), mode);
    if (lowerExtension(path) == ".mtl") {
      if (stream) foundMaterials = true;
      else missingMaterials.push_back(path);
    }
    return stream;
  }

  bool foundMaterials = false;
  std::vector<std::string> missingMaterials;

 private:
  Assimp::DefaultIOSystem disk_;  ///< final since Assimp 6
  std::string model_;
  std::span<const std::uint8_t> content_;
};

// -------------------------------------------------------------------------------------------------------------
// textures

Bitmap checkerBitmap() {
  constexpr int kSize = 64, kSquare = 8;
  Bitmap bitmap{kSize, kSize, std::vector<std::uint8_t>(4 * kSize * kSize, 255), false};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const std::uint8_t grey = (x / kSquare + y / kSquare) % 2 ? 200 : 90;
      std::fill_n(bitmap.rgba.begin() + 4 * (y * kSize + x), 3, grey);
    }
  return bitmap;
}

/// Mean over all texels, encoded values in 0..1.
glm::vec3 meanValue(const Bitmap& bitmap) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < bitmap.rgba.size(); i += 4)
    sum += glm::dvec3(bitmap.rgba[i], bitmap.rgba[i + 1], bitmap.rgba[i + 2]);
  return glm::vec3(sum / (255.0 * static_cast<double>(bitmap.rgba.size() / 4)));
}

/// Reads every picture once; a picture that cannot be read is one warning.
class TextureLoader {
 public:
  TextureLoader(Scene& scene, const aiScene& source)
      : scene_(scene), source_(source), folder_(scene.file.parent_path()) {}

  /// Index of an albedo map; the shared checker if it cannot be read; -1 if the material has none.
  int albedo(const aiMaterial& material, std::initializer_list<aiTextureType> types) {
    const std::string name = nameOf(material, types);
    if (name.empty()) return -1;
    const int index = load(name);
    return index >= 0 ? index : checker();
  }

  /// An albedo map whose alpha is shifted so that `threshold` becomes 0.5, the cut-off of masks. The cut stays at the
  /// same texture coordinates, since adding a constant commutes with interpolation.
  int withThreshold(int texture, double threshold) {
    const auto [known, isNew] = moved_.try_emplace({texture, threshold}, static_cast<int>(scene_.textures.size()));
    if (!isNew) return known->second;
    Texture copy = scene_.textures[static_cast<std::size_t>(texture)];
    const double shift = 255.0 * (0.5 - threshold);
    for (std::size_t i = 3; i < copy.bitmap.rgba.size(); i += 4)
      copy.bitmap.rgba[i] = static_cast<std::uint8_t>(std::clamp(std::lround(copy.bitmap.rgba[i] + shift), 0l, 255l));
    scene_.textures.push_back(std::move(copy));
    return known->second;
  }

  /// Index of a picture that only refines the material: -1 also if it cannot be read.
  int optional(const aiMaterial& material, std::initializer_list<aiTextureType> types) {
    const std::string name = nameOf(material, types);
    return name.empty() ? -1 : load(name);
  }

  /// The mean of a picture that is not kept, encoded values in 0..1; 1 without a picture.
  glm::vec3 mean(const aiMaterial& material, std::initializer_list<aiTextureType> types) {
    const std::string name = nameOf(material, types);
    if (name.empty()) return glm::vec3(1.0f);
    const std::optional<Texture> texture = read(name);
    return texture ? meanValue(texture->bitmap) : glm::vec3(1.0f);
  }

  static bool has(const aiMaterial& material, std::initializer_list<aiTextureType> types) {
    return !nameOf(material, types).empty();
  }

 private:
  static std::string nameOf(const aiMaterial& material, std::initializer_list<aiTextureType> types) {
    for (const aiTextureType type : types) {
      aiString name;
      if (material.GetTexture(type, 0, &name) == aiReturn_SUCCESS && name.length > 0) return name.C_Str();
    }
    return {};
  }

  int load(const std::string& name) {
    const auto known = indices_.find(name);
    if (known != indices_.end()) return known->second;
    int index = -1;
    if (std::optional<Texture> texture = read(name)) {
      index = static_cast<int>(scene_.textures.size());
      scene_.textures.push_back(std::move(*texture));
    }
    indices_[name] = index;
    return index;
  }

  std::optional<Texture> read(const std::string& name) {
    try {
      if (const aiTexture* embedded = source_.GetEmbeddedTexture(name.c_str())) return readEmbedded(*embedded, name);
      const fs::path file = resolve(name);
      return Texture{file, readBitmap(file)};
    } catch (const Error& e) {
      if (std::find(unreadable_.begin(), unreadable_.end(), name) == unreadable_.end()) {
        unreadable_.push_back(name);
        logWarning("texture {} (using a default)", e.what());
      }
      return std::nullopt;
    }
  }

  Texture readEmbedded(const aiTexture& embedded, const std::string& name) const {
    const fs::path file = scene_.file.string() + ":" + name;
    if (embedded.mHeight == 0) {  // a whole file; mWidth is its size
      return {file, decodeBitmap({reinterpret_cast<const std::uint8_t*>(embedded.pcData), embedded.mWidth}, file)};
    }
    Bitmap bitmap{static_cast<int>(embedded.mWidth), static_cast<int>(embedded.mHeight), {}, false};
    const std::size_t count = std::size_t{embedded.mWidth} * embedded.mHeight;
    bitmap.rgba.reserve(4 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const aiTexel& texel = embedded.pcData[i];
      bitmap.rgba.insert(bitmap.rgba.end(), {texel.r, texel.g, texel.b, texel.a});
      bitmap.hasAlpha |= texel.a < 255;
    }
    return {file, std::move(bitmap)};
  }

  /// Relative to the model; if the path is from another machine, the bare file name next to the model.
  fs::path resolve(const std::string& name) const {
    const fs::path path = (folder_ / withForwardSlashes(name)).lexically_normal();
    const fs::path bare = folder_ / path.filename();
    std::error_code error;
    return !fs::exists(path, error) && fs::exists(bare, error) ? bare : path;
  }

  int checker() {
    if (checker_ < 0) {
      checker_ = static_cast<int>(scene_.textures.size());
      scene_.textures.push_back({"(default checker)", checkerBitmap()});
    }
    return checker_;
  }

  Scene& scene_;
  const aiScene& source_;
  fs::path folder_;
  std::map<std::string, int> indices_;
  std::map<std::pair<int, double>, int> moved_;
  std::vector<std::string> unreadable_;
  int checker_ = -1;
};

// ------------------------------------------------------------------------------------------------------------
// materials

float clampedNumber(float value, float low, float high, float fallback) {
  return std::isfinite(value) ? std::clamp(value, low, high) : fallback;
}

/// `gltf`: properties that Assimp does not pass on, if the file is glTF. `tint`: the vertices' colour, a factor on the
/// base colour.
Material convertMaterial(const aiMaterial& source, TextureLoader& textures, Scene& scene, const GltfMaterial* gltf,
                         const glm::vec3& tint) {
  Material material;
  material.name = gltf ? gltf->name : source.GetName().C_Str();
  const auto colour = [&](const char* key, unsigned type, unsigned index, glm::vec3& value, float highest) {
    aiColor3D read;
    if (source.Get(key, type, index, read) != aiReturn_SUCCESS) return;
    for (int c = 0; c < 3; ++c) value[c] = clampedNumber(toGlm(read)[c], 0.0f, highest, 0.0f);
  };
  const auto number = [&](const char* key, unsigned type, unsigned index, float fallback) {
    float value = fallback;
    return source.Get(key, type, index, value) == aiReturn_SUCCESS ? value : fallback;
  };

  colour(AI_MATKEY_COLOR_DIFFUSE, material.diffuse, 1.0f);
  material.diffuse *= tint;
  colour(AI_MATKEY_COLOR_SPECULAR, material.specular, 1.0f);
  colour(AI_MATKEY_COLOR_EMISSIVE, material.emission, std::numeric_limits<float>::max());
  material.shininess = clampedNumber(number(AI_MATKEY_SHININESS, 1.0f), 1.0f, 1e6f, 1.0f);

  float metallic = 0.0f;
  if (source.Get(AI_MATKEY_METALLIC_FACTOR, metallic) == aiReturn_SUCCESS) {
    float roughness = number(AI_MATKEY_ROUGHNESS_FACTOR, 1.0f);
    // glTF: roughness in green, metallic in blue. Its own texture slot in Assimp 5.2.
    const int picture = gltf ? textures.optional(source, {aiTextureType_METALNESS, aiTextureType_UNKNOWN}) : -1;
    const glm::vec3 map = picture >= 0 ? meanValue(scene.textures[static_cast<std::size_t>(picture)].bitmap)
                          : gltf       ? glm::vec3(1.0f)
                                       : textures.mean(source, {aiTextureType_METALNESS, aiTextureType_UNKNOWN});
    const MetalMap factors{glm::vec3(1.0f), clampedNumber(metallic, 0.0f, 1.0f, 0.0f),
                           clampedNumber(roughness, 0.0f, 1.0f, 1.0f), picture};
    metallic = clampedNumber(metallic * map.z, 0.0f, 1.0f, 0.0f);
    roughness = clampedNumber(roughness * map.y, 0.0f, 1.0f, 1.0f);
    glm::vec3 base = material.diffuse;
    aiColor3D baseFactor;
    if (source.Get(AI_MATKEY_BASE_COLOR, baseFactor) == aiReturn_SUCCESS) {
      colour(AI_MATKEY_BASE_COLOR, base, 1.0f);
      base *= tint;
    }
    material.diffuse = base * (1.0f - metallic);
    material.specular = glm::mix(glm::vec3(0.04f), base, metallic);
    material.roughness = roughness * roughness;
    material.shininess = shininessOf(material.roughness);
    // A metal's picture is the colour of its reflection.
    if (gltf && (picture >= 0 || (factors.metallic > 0.0f &&
                                  textures.has(source, {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR})))) {
      material.metalMap = factors;
      material.metalMap->base = base;
    }
    if ((gltf ? static_cast<float>(gltf->transmission) : number(AI_MATKEY_TRANSMISSION_FACTOR, 0.0f)) > 0.5f)
      material.bsdf = Bsdf::dielectric;
    else if (metallic > 0.5f) material.bsdf = Bsdf::conductor;
  }

  int illum = 0;
  if (source.Get("$mat.illum", 0, 0, illum) == aiReturn_SUCCESS) {
    const float index = number(AI_MATKEY_REFRACTI, 0.0f);
    if (illum == 5 && material.specular != glm::vec3(0.0f)) material.bsdf = Bsdf::mirror;
    if ((illum == 4 || illum == 6 || illum == 7 || illum == 9) && std::isfinite(index) && index >= 1.0f) {
      material.bsdf = Bsdf::dielectric;
      material.ior = index;
    }
  }

  if (gltf && material.bsdf == Bsdf::dielectric) {
    material.ior = gltf->ior;
    if (gltf->thickness > 0.0 && gltf->absorption != glm::vec3(0.0f)) {
      Medium medium;
      medium.name = material.name;
      medium.absorption = gltf->absorption;
      material.interior = static_cast<int>(scene.media.size());
      scene.media.push_back(std::move(medium));
    }
  }

  const float strength = gltf ? gltf->emissiveStrength : number(AI_MATKEY_EMISSIVE_INTENSITY, 1.0f);
  if (material.emission != glm::vec3(0.0f)) {
    material.emissionScale = material.emission * clampedNumber(strength, 0.0f, 1e30f, 1.0f);
    material.emissionTexture = textures.optional(source, {aiTextureType_EMISSIVE, aiTextureType_EMISSION_COLOR});
    material.emission = material.emissionScale;
    if (material.emissionTexture >= 0)
      material.emission *=
          glm::vec3(meanColour(scene.textures[static_cast<std::size_t>(material.emissionTexture)].bitmap));
  }

  if (gltf) {
    material.normalTexture = textures.optional(source, {aiTextureType_NORMALS});
    material.normalScale = gltf->normalScale;
  }

  material.opacity = clampedNumber(number(AI_MATKEY_OPACITY, 1.0f), 0.0f, 1.0f, 1.0f);
  if (material.opacity == 0.0f && !gltf) {
    logWarning("{}: material '{}' has opacity 0; using 1", scene.file.string(), material.name);
    material.opacity = 1.0f;
  }

  material.diffuseTexture = textures.albedo(source, {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR});
  material.alphaTexture = textures.optional(source, {aiTextureType_OPACITY});
  const auto hasAlpha = [&](int texture) {
    return texture >= 0 && scene.textures[static_cast<std::size_t>(texture)].bitmap.hasAlpha;
  };
  // A colour picture named as its own mask means its alpha channel; without one it masks nothing.
  if (material.alphaTexture >= 0 && material.alphaTexture == material.diffuseTexture) material.alphaTexture = -1;
  material.alphaMasked = material.alphaTexture >= 0 || hasAlpha(material.diffuseTexture);
  if (!gltf) return material;
  material.opacity = 1.0f;
  if (gltf->alpha == GltfMaterial::Alpha::opaque) material.alphaMasked = false;
  // Alpha is never blended: masks are cut at the cut-off, or at one half.
  if (gltf->alpha == GltfMaterial::Alpha::opaque) return material;
  const double cutoff = gltf->alpha == GltfMaterial::Alpha::mask ? gltf->alphaCutoff : 0.5;
  const double threshold = gltf->alpha == GltfMaterial::Alpha::blend ? 0.5
                           : gltf->baseAlpha > 0.0                   ? cutoff / gltf->baseAlpha
                           : cutoff > 0.0                            ? 2.0
                                                                     : 0.0;
  if (threshold > 1.0) material.opacity = 0.0f;  // cut out everywhere
  else if (threshold <= 0.0) material.alphaMasked = false;
  else if (material.alphaMasked && threshold != 0.5)
    material.diffuseTexture = textures.withThreshold(material.diffuseTexture, threshold);
  return material;
}

/// Whether some vertices are transparent. Colours of three numbers come with an alpha of 0.
bool haveAlpha(const aiMesh& mesh) {
  if (!mesh.HasVertexColors(0)) return false;
  return std::any_of(mesh.mColors[0], mesh.mColors[0] + mesh.mNumVertices,
                     [](const aiColor4D& colour) { return colour.a > 0.0f && colour.a < 1.0f; });
}

/// The vertices' colour of a mesh, a factor on the base colour: its mean over the surface, and whether all vertices
/// share it.
std::pair<glm::vec3, bool> vertexColour(const aiMesh& mesh) {
  if (!mesh.HasVertexColors(0)) return {glm::vec3(1.0f), true};
  const auto at = [&](unsigned i) {
    return glm::dvec3(mesh.mColors[0][i].r, mesh.mColors[0][i].g, mesh.mColors[0][i].b);
  };
  glm::dvec3 sum(0.0);
  double area = 0.0;
  bool same = true;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;
    const unsigned a = face.mIndices[0], b = face.mIndices[1], c = face.mIndices[2];
    const double weight = glm::length(glm::cross(toGlm(mesh.mVertices[b]) - toGlm(mesh.mVertices[a]),
                                                 toGlm(mesh.mVertices[c]) - toGlm(mesh.mVertices[a])));
    if (!std::isfinite(weight) || !isFinite(at(a) + at(b) + at(c))) continue;
    sum += weight * (at(a) + at(b) + at(c)) / 3.0;
    area += weight;
    same = same && at(a) == at(mesh.mFaces[0].mIndices[0]) && at(b) == at(a) && at(c) == at(a);
  }
  return {area > 0.0 ? glm::clamp(glm::vec3(sum / area), 0.0f, 1.0f) : glm::vec3(1.0f), same};
}

// -------------------------------------------------------------------------------------------------------------
// geometry

struct VertexHash {
  std::size_t operator()(const std::array<std::uint32_t, 8>& words) const {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const std::uint32_t w : words) {
      h = (h ^ w) * 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }
};
static_assert(sizeof(Vertex) == 8 * sizeof(float), "compared bit by bit, so without padding");

/// Assimp allocates as many vertices as an OFF file claims, whatever the file's size. A vertex or face takes at least
/// two bytes.
void checkOff(const fs::path& file, std::span<const std::uint8_t> content) {
  std::istringstream text(std::string(
      content.begin(), content.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(content.size(), 4096))));
  std::string word;
  double vertices = 0.0, faces = 0.0;
  text >> word;
  if (text >> vertices >> faces && vertices + faces > static_cast<double>(content.size()) / 2.0)
    throwBadInput("{}: {:.0f} vertices and {:.0f} faces in {} bytes; is the file truncated?", file.string(), vertices,
                  faces, content.size());
}

/// Assimp passes on whatever its readers produced: RAW files leave missing nodes, and any mesh index may be wrong.
void checkNodes(const aiScene& source, const fs::path& file) {
  std::vector<std::pair<const aiNode*, int>> open = {{source.mRootNode, 0}};
  while (!open.empty()) {
    const auto [node, depth] = open.back();
    open.pop_back();
    if (!node) throwBadInput("{}: cannot be read as a model: a node of it is missing", file.string());
    if (depth > kMostNodeDepth) throwBadInput("{}: nodes nested more than {} deep", file.string(), kMostNodeDepth);
    for (unsigned i = 0; i < node->mNumMeshes; ++i)
      if (node->mMeshes[i] >= source.mNumMeshes || !source.mMeshes[node->mMeshes[i]])
        throwBadInput("{}: a node names mesh {}, the file holds {}", file.string(), node->mMeshes[i],
                      source.mNumMeshes);
    for (unsigned i = 0; i < node->mNumChildren; ++i) open.emplace_back(node->mChildren[i], depth + 1);
  }
}

/// Assimp's post-processing trusts faces blindly. An index out of range is undefined behaviour; a face without vertices
/// (truncated PLY) aborts the program in Debian's build, as does a mesh marked polygonal that has no polygon.
void checkFaces(const aiScene& source, const fs::path& file) {
  for (unsigned m = 0; m < source.mNumMeshes; ++m) {
    aiMesh& mesh = *source.mMeshes[m];
    mesh.mPrimitiveTypes = 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices == 0)
        throwBadInput("{}: face {} of mesh '{}' has no vertices; is the file truncated?", file.string(), f,
                      mesh.mName.C_Str());
      for (unsigned i = 0; i < face.mNumIndices; ++i)
        if (face.mIndices[i] >= mesh.mNumVertices)
          throwBadInput("{}: face {} of mesh '{}' refers to vertex {}, the mesh holds {}; is the file truncated?",
                        file.string(), f, mesh.mName.C_Str(), face.mIndices[i], mesh.mNumVertices);
      constexpr unsigned kTypes[] = {aiPrimitiveType_POINT, aiPrimitiveType_LINE, aiPrimitiveType_TRIANGLE,
                                     aiPrimitiveType_POLYGON};
      mesh.mPrimitiveTypes |= kTypes[std::min(face.mNumIndices, 4u) - 1];
    }
  }
}

/// The transform is glTF's, in which v points down.
glm::vec2 texCoordOf(const aiMesh& mesh, unsigned vertex, const TextureTransform& transform) {
  const aiVector3D& uv = mesh.mTextureCoords[transform.texCoord][vertex];
  if (transform == TextureTransform{.texCoord = transform.texCoord}) return {uv.x, uv.y};
  const glm::dvec2 moved = transform.apply({uv.x, 1.0 - uv.y});
  return {static_cast<float>(moved.x), static_cast<float>(1.0 - moved.y)};
}

/// Whether any texture coordinate lies outside the picture by more than rounding.
bool leavesPicture(const aiMesh& mesh, const TextureTransform& transform) {
  constexpr float kRounding = 1e-4f;
  for (unsigned i = 0; mesh.HasTextureCoords(transform.texCoord) && i < mesh.mNumVertices; ++i) {
    const glm::vec2 uv = texCoordOf(mesh, i, transform);
    if (!(std::min(uv.x, uv.y) >= -kRounding && std::max(uv.x, uv.y) <= 1.0f + kRounding)) return true;
  }
  return false;
}

/// Appends one mesh as placed by one node.
void appendMesh(Scene& scene, const aiMesh& source, const glm::dmat4& worldFromNode, int material,
                const TextureTransform& transform, const std::string& name) {
  const glm::dmat3 linear(worldFromNode);
  const bool mirrored = glm::determinant(linear) < 0.0;
  // Normals transform by the inverse transpose. The cofactor matrix is that times the determinant, and also exists for
  // flattening scalings.
  const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                            glm::cross(linear[0], linear[1]));

  std::vector<Vertex> vertices(source.mNumVertices);
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    Vertex& vertex = vertices[i];
    vertex.position = glm::vec3(worldFromNode * glm::dvec4(toGlm(source.mVertices[i]), 1.0));
    if (source.HasTextureCoords(transform.texCoord)) vertex.texCoord = texCoordOf(source, i, transform);
    if (!std::isfinite(vertex.texCoord.x) || !std::isfinite(vertex.texCoord.y)) vertex.texCoord = glm::vec2(0.0f);
    const glm::dvec3 normal =
        source.HasNormals() ? cofactor * toGlm(source.mNormals[i]) * (mirrored ? -1.0 : 1.0) : glm::dvec3(0.0);
    const double length = glm::length(normal);
    vertex.normal = std::isfinite(length) && length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0f);
  }

  std::vector<std::array<unsigned, 3>> triangles;
  triangles.reserve(source.mNumFaces);
  std::vector<glm::dvec3> lentNormals(source.mNumVertices,
                                      glm::dvec3(0.0));  // area-weighted, for vertices that have none
  double agreement = 0.0;  // area-weighted agreement of faces' sides with vertices' normals
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines
    std::array<unsigned, 3> t = {face.mIndices[0], face.mIndices[1], face.mIndices[2]};
    if (mirrored) std::swap(t[1], t[2]);
    const glm::dvec3 a(vertices[t[0]].position), b(vertices[t[1]].position), c(vertices[t[2]].position);
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double longest2 = std::max({glm::dot(b - a, b - a), glm::dot(c - a, c - a), glm::dot(c - b, c - b)});
    if (!isFinite(a) || !isFinite(b) || !isFinite(c)) {
      ++scene.droppedTriangles;
      continue;
    }
    // Exact up to rounding in double: collinear float corners give 0, or 1e-16 of the longest side squared.
    if (!(glm::length(cross) > 1e-14 * longest2)) ++scene.degenerateTriangles;
    for (const unsigned i : t) lentNormals[i] += cross, agreement += glm::dot(cross, glm::dvec3(vertices[i].normal));
    triangles.push_back(t);
  }
  if (triangles.empty()) return;
  // A mesh whose faces are wound against its normals was written for another handedness. Its author judged the normals,
  // so faces follow them, as shading turns normals to the viewer by the side of the face.
  if (agreement < 0.0) {
    for (std::array<unsigned, 3>& t : triangles) std::swap(t[1], t[2]);
    for (glm::dvec3& normal : lentNormals) normal = -normal;
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const double length = glm::length(lentNormals[i]);
    if (vertices[i].normal == glm::vec3(0.0f))
      vertices[i].normal = length > 0.0 ? glm::vec3(lentNormals[i] / length) : glm::vec3(0.0f, 1.0f, 0.0f);
  }

  Mesh mesh;
  mesh.name = name;
  mesh.material = material;
  mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  std::unordered_map<std::array<std::uint32_t, 8>, std::uint32_t, VertexHash> joined;
  joined.reserve(triangles.size());
  for (const std::array<unsigned, 3>& t : triangles) {
    for (const unsigned i : t) {
      const Vertex& vertex = vertices[i];
      const auto next = static_cast<std::uint32_t>(scene.vertices.size());
      std::array<std::uint32_t, 8> bits;
      std::memcpy(bits.data(), &vertex, sizeof vertex);
      const auto [entry, isNew] = joined.try_emplace(bits, next);
      if (isNew) {
        scene.vertices.push_back(vertex);
        mesh.bounds.add(glm::dvec3(vertex.position));
      }
      scene.indices.push_back(entry->second);
    }
  }
  mesh.indexCount = static_cast<std::uint32_t>(scene.indices.size()) - mesh.firstIndex;
  scene.bounds.add(mesh.bounds);
  scene.meshes.push_back(std::move(mesh));
  if (scene.indices.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throwBadInput("{}: more than {} triangles", scene.file.string(), std::numeric_limits<std::uint32_t>::max() / 6);
}

// ---------------------------------------------------------------------------------------------------- cameras and
// lights

/// The transform of the node of that name (Assimp ties cameras and lights to nodes by name).
glm::dmat4 worldFromNamedNode(const aiScene& source, const aiString& name) {
  aiMatrix4x4 world;
  for (const aiNode* node = source.mRootNode->FindNode(name); node; node = node->mParent)
    world = node->mTransformation * world;
  return toGlm(world);
}

/// `gltf`: its JSON, if it is glTF.
void appendCameras(Scene& scene, const aiScene& source, const Json& gltf) {
  for (unsigned i = 0; i < source.mNumCameras; ++i) {
    const aiCamera& given = *source.mCameras[i];
    const glm::dmat4 world = worldFromNamedNode(source, given.mName);
    Camera camera;
    camera.name = withoutNumber(given.mName.C_Str());
    // Assimp 5.2 copies a glTF node's translation into its camera too.
    const glm::dvec3 position = gltf.is_object() ? glm::dvec3(0.0) : toGlm(given.mPosition);
    camera.position = glm::dvec3(world * glm::dvec4(position, 1.0));
    camera.direction = glm::dmat3(world) * toGlm(given.mLookAt);
    camera.up = glm::dmat3(world) * toGlm(given.mUp);
    const double horizontal = given.mHorizontalFOV;
    camera.verticalFov = horizontal;  // where no aspect is known
    if (given.mAspect > 0.0f) camera.verticalFov = 2.0 * std::atan(std::tan(0.5 * horizontal) / given.mAspect);
    if (const auto number = numberOf(given.mName.C_Str()); number && gltf.is_object())
      camera.verticalFov = gltfFieldOfView(gltf, *number);
    const glm::dvec3 right = glm::cross(camera.direction, camera.up);
    const bool usable =
        isFinite(camera.position) && glm::length(right) > 0.0 && camera.verticalFov > 0.0 && camera.verticalFov < kPi;
    if (!usable) {
      logWarning("{}: camera '{}' has an invalid direction, up or field of view; ignored", scene.file.string(),
                 camera.name);
      continue;
    }
    camera.direction = glm::normalize(camera.direction);
    camera.up = glm::normalize(glm::cross(right, camera.direction));
    scene.cameras.push_back(std::move(camera));
  }
}

void appendLights(Scene& scene, const aiScene& source) {
  const std::string extension = lowerExtension(scene.file);
  const bool gltf = extension == ".gltf" || extension == ".glb";
  unsigned others = 0;
  for (unsigned i = 0; i < source.mNumLights; ++i) {
    const aiLight& light = *source.mLights[i];
    const glm::dmat4 world = worldFromNamedNode(source, light.mName);
    const glm::dvec3 position(world * glm::dvec4(toGlm(light.mPosition), 1.0));
    const glm::dvec3 direction = glm::dmat3(world) * toGlm(light.mDirection);
    const glm::vec3 colour = glm::max(toGlm(light.mColorDiffuse), glm::vec3(0.0f));
    if (colour == glm::vec3(0.0f)) continue;  // no light: keep the default sun
    const bool aimed = isFinite(direction) && glm::length(direction) > 0.0;
    const float attenuation = gltf || !(light.mAttenuationQuadratic > 0.0f) ? 1.0f : light.mAttenuationQuadratic;
    const glm::vec3 intensity = colour / attenuation;
    const bool placed = isFinite(position) && isFinite(intensity);
    if (light.mType == aiLightSource_DIRECTIONAL && aimed && isFinite(colour) && !scene.sun) {
      scene.sun = DirectionalLight{glm::normalize(direction), colour};
    } else if (light.mType == aiLightSource_POINT && placed) {
      scene.points.push_back({position, intensity});
    } else if (light.mType == aiLightSource_SPOT && placed && aimed && light.mAngleOuterCone > 0.0f) {
      // Assimp's angles are full cones, but its glTF reader passes on that format's half angles.
      const double half = gltf ? 1.0 : 0.5;
      const double outer = std::min(half * light.mAngleOuterCone, kLargestSpotAngle);
      if (half * light.mAngleOuterCone > kLargestSpotAngle)
        logWarning("{}: spot light '{}' is wider than 80 degrees from its axis; clamped to that", scene.file.string(),
                   withoutNumber(light.mName.C_Str()));
      const double inner = std::clamp(half * light.mAngleInnerCone, 0.0, outer);
      scene.spots.push_back({position, glm::normalize(direction), intensity, inner, outer});
    } else {
      ++others;
    }
  }
  if (others > 0)
    logWarning(
        "{}: {} lights ignored; supported are one directional light, spot and point lights and emissive surfaces",
        scene.file.string(), others);
  if (scene.sun || !scene.spots.empty() || !scene.points.empty()) return;
  scene.sun = DirectionalLight{kDefaultSunDirection, kDefaultSunIrradiance};
  scene.defaultSun = true;
  scene.defaultExposure = true;
}

/// Whether the bounding sphere of the bounds intersects the cone around the view's corners, for a 16:9 picture.
bool seesAnything(const Camera& camera, const Bounds& bounds) {
  const glm::dvec3 away = bounds.centre() - camera.position;
  const double distance = glm::length(away), radius = 0.5 * glm::length(bounds.extent());
  if (distance <= radius) return true;
  const double corner = std::atan(std::tan(0.5 * camera.verticalFov) * std::hypot(1.0, 16.0 / 9.0));
  return std::acos(std::clamp(glm::dot(away, camera.direction) / distance, -1.0, 1.0)) - std::asin(radius / distance) <
         corner;
}

Camera outsideView(const Bounds& bounds) {
  Camera camera;
  camera.name = "default";
  camera.verticalFov = kDefaultFov;
  camera.direction = -glm::normalize(glm::dvec3(0.5, 0.35, 1.0));
  const double radius = 0.5 * glm::length(bounds.extent());
  camera.position = bounds.centre() - camera.direction * (radius / std::sin(0.5 * kDefaultFov));
  camera.up = glm::normalize(glm::dvec3(0.0, 1.0, 0.0) - camera.direction.y * camera.direction);
  return camera;
}

}  // namespace

void setKeyFrames(Scene& scene, const fs::path& file) {
  const std::vector<KeyFrame> keys = readKeyFrames(file);
  scene.keyFrames = file;
  if (!scene.cameras.empty()) return;
  Camera camera = Spline(keys).view(0);
  camera.name = "default";
  scene.cameras.push_back(std::move(camera));
}

Scene loadModel(const fs::path& file) {
  // First check for data that Assimp would misread or crash on.
  Scene scene;
  scene.name = file.stem().string();
  scene.file = file;

  const std::string extension = lowerExtension(file);
  std::vector<std::uint8_t> content = readFileBytes(file);  // also tells a missing file or a folder
  if (extension == ".obj") {
    const std::string_view text(reinterpret_cast<const char*>(content.data()), content.size());
    checkObj(file, text);
    const std::string repaired = repairedObj(text);
    content.assign(repaired.begin(), repaired.end());
  }
  if (content.empty()) throwBadInput("{}: the file is empty", file.string());
  Json gltf;
  if (extension == ".gltf" || extension == ".glb") gltf = checkedGltf(file, content);
  if (extension == ".off") checkOff(file, content);
  const auto isArray = [&](const char* key) {
    return gltf.is_object() && gltf.contains(key) && gltf.at(key).is_array();
  };
  const bool isGltf2 = isArray("materials");  // glTF 1 has objects
  if (isGltf2 || isArray("nodes")) content = withNumbers(gltf, content);

  // Assimp reads the model; all file access goes through ModelFiles.
  const auto end = [&](Assimp::Importer* ended) {
    const ImportGuard guard(file);
    delete ended;
  };
  const std::unique_ptr<Assimp::Importer, decltype(end)> importer(new Assimp::Importer, end);
  auto* files = new ModelFiles(file.string(), content);  // owned by the importer
  importer->SetIOHandler(files);
  importer->SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, kCreaseAngle);
  const aiScene* source = nullptr;
  try {
    const ImportGuard guard(file);
    source = importer->ReadFile(file.string(), 0);
    if (source) checkNodes(*source, file);
    if (source) checkFaces(*source, file);
    if (source) source = importer->ApplyPostProcessing(aiProcess_Triangulate | aiProcess_GenSmoothNormals);
  } catch (const Error&) { throw; } catch (const std::exception& e) {
    throwBadInput("{}: cannot be read as a model: {}", file.string(), e.what());
  }
  if (!source || !source->mRootNode)
    throwBadInput("{}: cannot be read as a model: {}", file.string(), importer->GetErrorString());
  if (!files->foundMaterials && !files->missingMaterials.empty())
    logWarning("{}: material library {} is missing; using default materials", file.string(),
               files->missingMaterials.front());

  TextureLoader textures(scene, *source);
  // Only materials in use are converted; for glTF once per vertex colour.
  std::map<std::pair<unsigned, std::array<float, 3>>, int> materialOf;
  std::map<unsigned, GltfMaterial> gltfMaterials;
  const auto convertedMaterial = [&](unsigned index, const glm::vec3& tint, const GltfMaterial* gltfMaterial) {
    const auto [known, isNew] =
        materialOf.try_emplace({index, {tint.x, tint.y, tint.z}}, static_cast<int>(scene.materials.size()));
    if (isNew)
      scene.materials.push_back(convertMaterial(*source->mMaterials[index], textures, scene, gltfMaterial, tint));
    return known->second;
  };
  // Meshes, node by node, in world space.
  std::vector<std::pair<const aiNode*, glm::dmat4>> open = {{source->mRootNode, glm::dmat4(1.0)}};
  while (!open.empty()) {
    const auto [node, worldFromParent] = open.back();
    open.pop_back();
    const glm::dmat4 worldFromNode = worldFromParent * toGlm(node->mTransformation);
    for (unsigned i = 0; i < node->mNumMeshes; ++i) {
      const aiMesh& mesh = *source->mMeshes[node->mMeshes[i]];
      if (!(mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) continue;
      const std::string name = mesh.mName.length > 0 ? mesh.mName.C_Str() : node->mName.C_Str();
      const unsigned index = mesh.mMaterialIndex;
      if (index >= source->mNumMaterials)
        throwBadInput("{}: a mesh names material {}, the file holds {}", file.string(), index, source->mNumMaterials);
      if (!isGltf2) {
        appendMesh(scene, mesh, worldFromNode, convertedMaterial(index, glm::vec3(1.0f), nullptr), {}, name);
        continue;
      }
      const auto [known, isNew] = gltfMaterials.try_emplace(index);
      GltfMaterial& rest = known->second;
      if (const auto number = numberOf(source->mMaterials[index]->GetName().C_Str()); isNew && number)
        rest = gltfMaterial(gltf, file, *number);
      const auto [tint, same] = vertexColour(mesh);
      const auto lacks = [&](std::string_view what) {
        if (rest.notDone.find(what) == std::string::npos)
          rest.notDone += fmt::format("{}{}", rest.notDone.empty() ? "" : ", ", what);
      };
      if (!same) lacks("vertex colours are their mean");
      if (haveAlpha(mesh) && rest.alpha != GltfMaterial::Alpha::opaque) lacks("vertices' alpha is not read");
      if (rest.clamped && leavesPicture(mesh, rest.transform))
        lacks("its texture repeats where it should be clamped or mirrored");
      const int material = convertedMaterial(index, tint, &rest);
      if (scene.materials[static_cast<std::size_t>(material)].opacity > 0.0f)
        appendMesh(scene, mesh, worldFromNode, material, rest.transform, name);
    }
    for (unsigned i = node->mNumChildren; i-- > 0;) open.emplace_back(node->mChildren[i], worldFromNode);
  }
  // Report what was left out, and check that anything is left.
  for (const auto& [index, rest] : gltfMaterials)
    if (!rest.notDone.empty()) logWarning("{}: material '{}': {}", file.string(), rest.name, rest.notDone);
  if (const std::string ranged = gltfLightsWithRange(gltf); !ranged.empty())
    logWarning("{}: lights {}: range ignored, falloff is 1/d^2 without a limit", file.string(), ranged);
  if (scene.indices.empty())
    throwBadInput("{}: nothing to draw: no triangles ({} dropped as not finite)", file.string(),
                  scene.droppedTriangles);
  if (scene.degenerateTriangles == scene.triangleCount())
    throwBadInput("{}: nothing to draw: all triangles have zero area", file.string());
  if (scene.droppedTriangles > 0)
    logWarning("{}: {} triangles with positions that are not finite ignored", file.string(), scene.droppedTriangles);

  // Lights, cameras, key frames.
  appendLights(scene, *source);
  appendCameras(scene, *source, gltf);
  if (const auto data = findDataFolder()) {
    const fs::path walk = *data / "keyFrames" / (scene.name + ".txt");
    if (fs::exists(walk)) setKeyFrames(scene, walk);
  }
  // Cameras that animations would have turned, or that were read with the wrong handedness, may see nothing: then they
  // do not come first.
  const bool blind = !scene.cameras.empty() && !seesAnything(scene.cameras.front(), scene.bounds);
  if (blind)
    logWarning("{}: camera '{}' sees nothing of the scene; using the default view from outside", file.string(),
               scene.cameras.front().name);
  if (scene.cameras.empty() || blind) {
    scene.cameras.insert(scene.cameras.begin(), outsideView(scene.bounds));
    if (scene.defaultSun) scene.sun->direction = kSunOverShoulder;
  }
  return scene;
}

void useChosenView(Scene& scene) {
  if (scene.defaultSun) scene.sun->direction = kDefaultSunDirection;
}

void setDefaultExposure(Scene& scene, const Camera& camera) {
  if (!scene.defaultExposure) return;
  const glm::bvec3 above = glm::greaterThan(camera.position, scene.bounds.min),
                   below = glm::lessThan(camera.position, scene.bounds.max);
  scene.exposure = glm::all(above) && glm::all(below) ? kExposureInside : kExposureOutside;
}

void setDefaultSky(Scene& scene) {
  if (scene.defaultSun) scene.environment = Environment{glm::vec3(1.0f), clearSkyPicture({}, *scene.sun), 0.0};
}

namespace {

/// Model files specify lamps in arbitrary units. If their light in the middle of the scene is far from what an exposure
/// of 1 shows, choose another exposure.
void setExposureForLamps(Scene& scene) {
  if (scene.defaultSun) return;
  const auto strongest = [](const glm::vec3& v) { return static_cast<double>(std::max({v.x, v.y, v.z})); };
  const double radius = 0.5 * glm::length(scene.bounds.extent());
  const auto lamp = [&](const glm::dvec3& position, const glm::vec3& intensity) {
    const double distance = std::max(glm::length(position - scene.bounds.centre()), radius);
    return strongest(intensity) / (distance * distance);
  };
  double irradiance = scene.sun ? strongest(scene.sun->irradiance) : 0.0;
  for (const SpotLight& light : scene.spots) irradiance += lamp(light.position, light.intensity);
  for (const PointLight& light : scene.points) irradiance += lamp(light.position, light.intensity);
  if (!(irradiance > 1e-30 && irradiance < 1e30) || (irradiance > 0.3 && irradiance < 30.0)) return;
  scene.exposure = static_cast<float>(3.0 / irradiance);
  logWarning(
      "{}: its lamps give an irradiance of about {:.2g}, so that pictures would be {} at exposure 1; {:.2g} is taken",
      scene.file.string(), irradiance, irradiance < 1.0 ? "black" : "white", scene.exposure);
}

}  // namespace

Scene loadScene(const fs::path& file) {
  if (lowerExtension(file) == ".json") return loadSceneFile(file);
  Scene scene = loadModel(file);
  setDefaultSky(scene);
  setDefaultExposure(scene, scene.cameras.front());
  setExposureForLamps(scene);
  return scene;
}

}  // namespace lucerna
