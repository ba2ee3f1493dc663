#include "rays/path_scene.hpp"

#include "rays/texture_atlas.hpp"
#include "scene/coat.hpp"
#include "shared/bindings.h"
#include "shared/coat.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <span>
#include <utility>

namespace lucerna {

namespace {

constexpr GLuint kTrianglesBinding = 2, kMaterialsBinding = 3, kLightsBinding = 4;  // GL_SHADER_STORAGE_BUFFER
constexpr GLuint kAtlasUnit = 0, kEnvironmentUnit = 1, kEnvironmentTableUnit = 2, kEnvironmentRowsUnit = 4,
                 kValuesUnit = UNIT_VALUE_ATLAS;
constexpr float kSmoothest = 1e-3f;  // GGX alpha below which a surface is smooth: a mirror to within half a degree

std::uint32_t kindOf(const Material& material) {
  switch (material.bsdf) {
    case Bsdf::diffuse: return PATH_DIFFUSE;
    case Bsdf::mirror: return PATH_MIRROR;
    case Bsdf::conductor: return PATH_CONDUCTOR;
    case Bsdf::dielectric: return PATH_DIELECTRIC;
    case Bsdf::none: return PATH_NONE;
  }
  return PATH_DIFFUSE;
}

}  // namespace

PathScene::PathScene(const Scene& scene, const SceneFeatures& features, const gl::Capabilities& capabilities,
                     const Settings& settings, const std::vector<int>& rankOfMaterial)
    : features_(features),
      settings_(settings),
      capabilities_(&capabilities),
      rankOfMaterial_(rankOfMaterial),
      rays_(scene, capabilities, settings.rays),
      materialValues_(scene.materials.size()) {
  for (shared::PathMaterial& material : materialValues_)
    for (shared::PathTexture* texture : {&material.diffuseTexture, &material.maskTexture, &material.emissionTexture,
                                         &material.normalTexture, &material.metalTexture})
      texture->layer = PATH_NO_TEXTURE;
  setMaterials(scene);
  isTextured_ = features_.diffuseTextures || features_.alphaMasks || features_.emissionTextures ||
                features_.normalMaps || features_.metalMaps;
  if (isTextured_) uploadTextures(scene);
  triangleWords_ = 4 + (isTextured_ ? 1 : 0) + (features_.smoothNormals ? 3 : 0);
  uploadLights(scene);
  hash_.bytes(materialValues_.data(), materialValues_.size() * sizeof(shared::PathMaterial));
  uploadTriangles(scene);
}

void PathScene::update(const Scene& scene, std::span<const std::size_t> meshes) {
  CHECK(scene.materials.size() == materialValues_.size(), "{} materials of {}", scene.materials.size(),
        materialValues_.size());
  // The hierarchy says what emits.
  std::vector<std::size_t> others(meshes.begin(), meshes.end());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const auto material = static_cast<std::size_t>(scene.meshes[m].material);
    const bool emitted = materialValues_[material].emission != glm::vec3(0.0f),
               emits = scene.materials[material].emission != glm::vec3(0.0f);
    if (emitted != emits && scene.materials[material].emissionTexture < 0) others.push_back(m);
  }
  const glm::dvec3 origin = rays_.origin();
  if (!others.empty()) rays_.update(scene, others);
  setMaterials(scene);
  const std::vector<std::uint32_t> before = std::move(lampWords_);
  uploadLights(scene);
  if (rays_.origin() != origin) {
    uploadTriangles(scene);
    return;
  }
  const auto wordOf = [](const std::vector<std::uint32_t>& words, std::uint32_t t) {
    return words.empty() ? 0u : words[t];
  };
  std::vector<std::uint32_t> changed;
  std::vector<bool> isOther(scene.meshes.size(), false);
  for (const std::size_t m : meshes) isOther[m] = true;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    for (std::uint32_t t = mesh.firstIndex / 3; t < (mesh.firstIndex + mesh.indexCount) / 3; ++t) {
      if (!isOther[m] && wordOf(before, t) == wordOf(lampWords_, t)) continue;
      writeTriangle(scene, t, static_cast<std::uint32_t>(mesh.material));
      changed.push_back(t);
    }
  }
  std::ranges::sort(changed);
  const std::size_t words = 4 * static_cast<std::size_t>(triangleWords_);
  forRuns(changed, [&](std::size_t first, std::size_t count) {
    triangles_.upload(first * words * sizeof(std::uint32_t), count * words * sizeof(std::uint32_t),
                      &triangleValues_[first * words]);
  });
}

// All but the pictures.
void PathScene::setMaterials(const Scene& scene) {
  for (std::size_t i = 0; i < materialValues_.size(); ++i) {
    const Material& from = scene.materials[i];
    shared::PathMaterial& to = materialValues_[i];
    to.kind = kindOf(from);
    to.albedo = from.diffuse;
    to.specular = from.specular;
    to.roughness = from.roughness < kSmoothest ? 0.0f : std::min(from.roughness, 1.0f);
    to.mapRoughness = from.metalMap ? from.metalMap->roughness : -1.0f;
    const bool isCoated = to.specular != glm::vec3(0.0f) || to.mapRoughness >= 0.0f;
    if (to.kind == PATH_DIFFUSE && isCoated) {
      to.kind = PATH_COATED;
      to.roughness = std::max(to.roughness, static_cast<float>(COAT_LEAST_ALPHA));
      hasCoats_ = true;
    }
    if (settings_.diffuseOnly && (to.kind == PATH_MIRROR || to.kind == PATH_CONDUCTOR)) {
      to.albedo = glm::vec3(0.0f);
      hasCoats_ = true;
    }
    if (to.kind == PATH_DIELECTRIC) to.specular = glm::vec3(0.0f);
    to.emission = from.emissionTexture >= 0 ? from.emissionScale : from.emission;
    to.ior = from.ior;
    to.boundary = static_cast<std::uint32_t>(rankOfMaterial_.empty() ? -1 : rankOfMaterial_[i]);
    to.normalScale = from.normalScale;
    to.metallic = from.metalMap ? from.metalMap->metallic : -1.0f;
    if (from.metalMap) to.albedo = from.metalMap->base;
  }
}

void PathScene::uploadLights(const Scene& scene) {
  if (hasCoats_ && !coats_) {
    coats_.emplace("path coats", gl::Format::rgba32f, glm::ivec2(COAT_COSINES, COAT_ALPHAS),
                   gl::Sampling{gl::Filter::linear, gl::Filter::linear});
    coats_->upload(gl::Texels::rgbaFloat, coatTable().data());
  }
  if (settings_.nextEvent) {
    LightTable table = lightTable(scene, rays_.origin(), settings_.sunApart);
    sunApart_ = table.sunApart;
    lampWords_.clear();
    for (const float density : table.pickDensity) lampWords_.push_back(std::bit_cast<std::uint32_t>(density));
    // Programs are compiled for one or the other, also where lamps of a scene that moves go out.
    if (!hasHierarchy_)
      hasHierarchy_ =
          settings_.fewestOfHierarchy > 0 && table.lamps.size() >= settings_.fewestOfHierarchy &&
          hierarchyTexels(table.lamps.size()) <= static_cast<std::size_t>(capabilities_->maxTextureBufferSize);
    if (*hasHierarchy_) uploadHierarchy(table);
    lightCount_ = table.lights.size();
    if (lightCount_ > 0) lights_ = storageOf("path lights", table.lights, *capabilities_);
    constants_.environmentPick = static_cast<float>(table.environmentPick);
  }
  materials_ = storageOf("path materials", materialValues_, *capabilities_);
  if (features_.environment) uploadEnvironment(*scene.environment);
}

void PathScene::uploadHierarchy(const LightTable& table) {
  constants_.lampPick = static_cast<float>(table.lampPick);
  if (table.lamps.empty()) return;  // all have gone out; none is drawn
  const LightHierarchy hierarchy = lightHierarchy(table.lamps);
  const std::size_t bytes = hierarchy.texels.size() * sizeof(glm::uvec4);
  if (hierarchy_.bytes() == bytes) hierarchy_.upload(0, bytes, hierarchy.texels.data());
  else hierarchy_ = gl::BufferTexture("light hierarchy", gl::Format::rgba32ui, bytes, hierarchy.texels.data());
  constants_.lampPairs = hierarchy.pairs;
  for (std::size_t leaf = 0; leaf < hierarchy.lights.size(); ++leaf) {
    const shared::PathLight& light = table.lights[hierarchy.lights[leaf]];
    if (light.kind == PATH_LIGHT_TRIANGLE) lampWords_[light.p] = static_cast<std::uint32_t>(leaf);
  }
}

void PathScene::uploadEnvironment(const Environment& environment) {
  constants_.environment = environment.radiance;
  constants_.environmentTurn = glm::vec4(std::cos(environment.rotation), std::sin(environment.rotation), 0.0, 0.0);
  if (!features_.environmentPicture) return;
  const Image& picture = *environment.picture;
  const glm::ivec2 size(picture.width, picture.height);
  std::vector<glm::vec4> texels;
  texels.reserve(picture.pixels.size());
  for (const glm::vec3& p : picture.pixels) texels.emplace_back(p, 0.0f);
  environmentPicture_.emplace("environment", gl::Format::rgba32f, size);
  environmentPicture_->upload(gl::Texels::rgbaFloat, texels.data());
  texels = {};
  const EnvironmentTable table = environmentTable(picture);
  environmentTable_.emplace("environment table", gl::Format::rgba32ui, size);
  environmentTable_->upload(gl::Texels::rgbaWord, table.texels.data());
  environmentRows_.emplace("environment rows", gl::Format::rgba32ui, glm::ivec2(1, picture.height));
  environmentRows_->upload(gl::Texels::rgbaWord, table.rows.data());
}

namespace {

int pathWrapOf(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::edge: return PATH_WRAP_EDGE;
    case TextureWrap::mirror: return PATH_WRAP_MIRROR;
    case TextureWrap::repeat: break;
  }
  return PATH_WRAP_REPEAT;
}

/// The part of a picture that an atlas stores. A picture may occur twice: as colour, and as a mask in the alpha
/// channel.
struct AtlasEntry {
  int texture;
  bool mask;
  auto operator<=>(const AtlasEntry&) const = default;
};

/// Pictures of one encoding that share an array texture, and the material fields that receive their positions.
struct AtlasContent {
  std::map<AtlasEntry, std::size_t> index;
  std::vector<AtlasEntry> entries;
  std::vector<std::pair<std::size_t, shared::PathTexture*>> uses;
  void add(int texture, bool mask, shared::PathTexture& use) {
    const auto [place, isNew] = index.try_emplace({texture, mask}, entries.size());
    if (isNew) entries.push_back({texture, mask});
    uses.emplace_back(place->second, &use);
  }
};

/// Empty if there is nothing to store.
std::optional<gl::Texture> makeAtlas(const Scene& scene, const gl::Capabilities& capabilities, const char* name,
                                     gl::Format format, const AtlasContent& content) {
  if (content.entries.empty()) return std::nullopt;
  std::vector<glm::ivec2> sizes;
  for (const AtlasEntry& entry : content.entries) {
    const Texture& texture = scene.textures[static_cast<std::size_t>(entry.texture)];
    sizes.emplace_back(texture.bitmap.width, texture.bitmap.height);
    if (std::max(sizes.back().x, sizes.back().y) > capabilities.maxTextureSize)
      throwMissingCapability("{}: {} x {} texels; this driver's textures have at most {} (GL_MAX_TEXTURE_SIZE)",
                             texture.file.string(), sizes.back().x, sizes.back().y, capabilities.maxTextureSize);
  }
  const AtlasLayout layout = layOutAtlas(sizes, std::min(capabilities.maxTextureSize, 8192));
  if (layout.size.z > capabilities.maxArrayTextureLayers)
    throwMissingCapability("{} layers of textures; this driver has at most {} (GL_MAX_ARRAY_TEXTURE_LAYERS)",
                           layout.size.z, capabilities.maxArrayTextureLayers);
  std::vector<std::uint8_t> texels(4 * static_cast<std::size_t>(layout.size.x) *
                                   static_cast<std::size_t>(layout.size.y) * static_cast<std::size_t>(layout.size.z));
  for (std::size_t i = 0; i < content.entries.size(); ++i) {
    const Bitmap& bitmap = scene.textures[static_cast<std::size_t>(content.entries[i].texture)].bitmap;
    const AtlasPlace& place = layout.places[i];
    for (int y = 0; y < sizes[i].y; ++y) {  // rows bottom first, as v = 0 is the bottom row
      const std::uint8_t* from =
          bitmap.rgba.data() + 4 * static_cast<std::size_t>(sizes[i].y - 1 - y) * static_cast<std::size_t>(sizes[i].x);
      std::uint8_t* to =
          texels.data() + 4 * ((static_cast<std::size_t>(place.layer) * static_cast<std::size_t>(layout.size.y) +
                                static_cast<std::size_t>(place.corner.y + y)) *
                                   static_cast<std::size_t>(layout.size.x) +
                               static_cast<std::size_t>(place.corner.x));
      std::copy_n(from, 4 * static_cast<std::size_t>(sizes[i].x), to);
      if (content.entries[i].mask && !bitmap.hasAlpha)
        for (int x = 0; x < sizes[i].x; ++x) to[4 * x + 3] = from[4 * x];
    }
  }
  std::optional<gl::Texture> atlas;
  atlas.emplace(name, format, layout.size, gl::Sampling{}, 1, gl::TextureKind::array);
  atlas->upload(gl::Texels::rgbaByte, texels.data());
  for (const auto& [entry, use] : content.uses) {
    const AtlasPlace& place = layout.places[entry];
    const TextureWraps& wraps = scene.textures[static_cast<std::size_t>(content.entries[entry].texture)].wraps;
    *use = {place.layer,    place.corner.x,      place.corner.y,      sizes[entry].x,
            sizes[entry].y, pathWrapOf(wraps.u), pathWrapOf(wraps.v), 0};
  }
  return atlas;
}

}  // namespace

void PathScene::uploadTextures(const Scene& scene) {
  std::vector<shared::PathMaterial>& materials = materialValues_;
  AtlasContent colours, values;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Material& material = scene.materials[i];
    if (features_.diffuseTextures && material.diffuseTexture >= 0)
      colours.add(material.diffuseTexture, false, materials[i].diffuseTexture);
    if (features_.alphaMasks && material.alphaMasked)
      colours.add(material.alphaTexture >= 0 ? material.alphaTexture : material.diffuseTexture, true,
                  materials[i].maskTexture);
    if (features_.emissionTextures && material.emissionTexture >= 0)
      colours.add(material.emissionTexture, false, materials[i].emissionTexture);
    if (features_.normalMaps && material.normalTexture >= 0)
      values.add(material.normalTexture, false, materials[i].normalTexture);
    if (features_.metalMaps && material.metalMap && material.metalMap->texture >= 0)
      values.add(material.metalMap->texture, false, materials[i].metalTexture);
  }
  atlas_ = makeAtlas(scene, *capabilities_, "texture atlas", gl::Format::srgb8Alpha8, colours);
  values_ = makeAtlas(scene, *capabilities_, "value atlas", gl::Format::rgba8, values);
}

void PathScene::uploadTriangles(const Scene& scene) {
  triangleValues_.assign(scene.triangleCount() * static_cast<std::size_t>(triangleWords_) * 4, 0u);
  std::vector<std::uint32_t> materialOf(scene.triangleCount(), 0);
  for (const Mesh& mesh : scene.meshes)
    std::fill_n(materialOf.begin() + mesh.firstIndex / 3, mesh.indexCount / 3,
                static_cast<std::uint32_t>(mesh.material));
  for (std::size_t t = 0; t < scene.triangleCount(); ++t) writeTriangle(scene, t, materialOf[t]);
  hash_.bytes(triangleValues_.data(), triangleValues_.size() * sizeof(std::uint32_t));
  triangles_ = storageOf("path triangles", triangleValues_, *capabilities_);
  if (settings_.rays.moves) return;
  triangleValues_ = {};
  lampWords_ = {};
}

void PathScene::writeTriangle(const Scene& scene, std::size_t triangle, std::uint32_t material) {
  std::uint32_t* word = &triangleValues_[triangle * static_cast<std::size_t>(triangleWords_) * 4];
  const auto add = [&](float value) { *word++ = std::bit_cast<std::uint32_t>(value); };
  const auto add3 = [&](const glm::vec3& v) { add(v.x), add(v.y), add(v.z); };
  const Vertex* corners[3];
  for (std::size_t k = 0; k < 3; ++k) corners[k] = &scene.vertices[scene.indices[3 * triangle + k]];
  const auto place = [&](int k) { return glm::dvec3(corners[k]->position) - rays_.origin(); };
  const glm::dvec3 cross = glm::cross(place(1) - place(0), place(2) - place(0));
  const double length = glm::length(cross);
  const glm::vec3 normal =
      length > 0.0 ? glm::vec3(cross / length) : glm::vec3(0.0f);  // rays hit no triangle without area
  add3(glm::vec3(place(0)));
  *word++ = material;
  add3(glm::vec3(place(1)));
  add(normal.x);
  add3(glm::vec3(place(2)));
  add(normal.y);
  add3({normal.z, corners[2]->texCoord.x, corners[2]->texCoord.y});
  *word++ = lampWords_.empty() ? 0u : lampWords_[triangle];
  if (isTextured_)
    for (int k = 0; k < 2; ++k) add(corners[k]->texCoord.x), add(corners[k]->texCoord.y);
  if (features_.smoothNormals)
    for (const Vertex* corner : corners) add3(corner->normal), *word++ = 0;
}

void PathScene::bind() const {
  rays_.bind();
  triangles_.bindStorage(kTrianglesBinding);
  materials_.bindStorage(kMaterialsBinding);
  if (hasLights()) lights_.bindStorage(kLightsBinding);
  if (hasHierarchy()) hierarchy_.bind(UNIT_LIGHT_HIERARCHY);
  if (atlas_) atlas_->bind(kAtlasUnit);
  else if (values_) values_->bind(kAtlasUnit);  // declared with any texture; no material reads it
  if (values_) values_->bind(kValuesUnit);
  if (coats_) coats_->bind(UNIT_COAT);
  if (environmentPicture_) environmentPicture_->bind(kEnvironmentUnit);
  if (environmentTable_) environmentTable_->bind(kEnvironmentTableUnit);
  if (environmentRows_) environmentRows_->bind(kEnvironmentRowsUnit);
}

gl::ShaderFlags PathScene::flags() const {
  return {{"TEXTURES",
           features_.diffuseTextures || features_.emissionTextures || features_.normalMaps || features_.metalMaps},
          {"NORMAL_MAPS", features_.normalMaps},
          {"METAL_MAPS", features_.metalMaps},
          {"TEXTURE_WRAPS", features_.textureWraps},
          {"COATS", hasCoats_},
          {"ALPHA_MASKS", features_.alphaMasks},
          {"SMOOTH_NORMALS", features_.smoothNormals},
          {"TRIANGLE_WORDS", triangleWords_},
          {"EMISSION", features_.emission},
          {"SUN", hasLights() && features_.directionalLight},
          {"SPOTS", hasLights() && features_.spotLights},
          {"POINTS", hasLights() && features_.pointLights},
          {"ENVIRONMENT", features_.environment},
          {"ENVIRONMENT_PICTURE", features_.environmentPicture},
          {"SUN_APART", sunApart_},
          {"LIGHT_HIERARCHY", hasHierarchy()},
          {"NEXT_EVENT", hasLights()}};
}

void PathScene::fill(shared::PathConstants& constants) const {
  constants.environment = constants_.environment;
  constants.environmentPick = constants_.environmentPick;
  constants.lampPick = constants_.lampPick;
  constants.lampPairs = constants_.lampPairs;
  constants.environmentTurn = constants_.environmentTurn;
}

std::size_t PathScene::gpuBytes() const {
  std::size_t bytes = rays_.gpuBytes() + triangles_.bytes() + materials_.bytes() + lights_.bytes() + hierarchy_.bytes();
  for (const std::optional<gl::Texture>* texture :
       {&atlas_, &values_, &coats_, &environmentPicture_, &environmentTable_, &environmentRows_})
    if (*texture) bytes += (*texture)->bytes();
  return bytes;
}

}  // namespace lucerna
