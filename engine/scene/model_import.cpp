// Reads models through Assimp. Lines and points are dropped, and the stand-in that it draws of a skeleton without
// meshes.
#include "scene/model_import.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/import_guard.hpp"

#include <assimp/config.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

glm::vec3 toGlm(const aiVector3D& v) { return {v.x, v.y, v.z}; }
glm::vec3 toGlm(const aiColor3D& c) { return {c.r, c.g, c.b}; }

/// Row-major Assimp to column-major GLM.
glm::dmat4 toGlm(const aiMatrix4x4& m) {
  return glm::transpose(
      glm::dmat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4));
}

/// File access for Assimp: replaces backslashes, and serves the checked model from memory.
class ModelFiles : public Assimp::IOSystem {
 public:
  ModelFiles(std::string model, std::span<const std::uint8_t> content) : model_(std::move(model)), content_(content) {}

  bool Exists(const char* file) const override { return disk_.Exists(withForwardSlashes(file).c_str()); }
  char getOsSeparator() const override { return disk_.getOsSeparator(); }
  bool ComparePaths(const char* one, const char* other) const override { return disk_.ComparePaths(one, other); }
  void Close(Assimp::IOStream* stream) override { delete stream; }
  Assimp::IOStream* Open(const char* file, const char* mode = "rb") override {
    if (model_ == file) return new Assimp::MemoryIOStream(content_.data(), content_.size());
    return disk_.Open(withForwardSlashes(file).c_str(), mode);
  }

 private:
  Assimp::DefaultIOSystem disk_;  ///< final since Assimp 6
  std::string model_;
  std::span<const std::uint8_t> content_;
};

/// Assimp passes on whatever its readers produced: RAW files leave missing nodes, and any mesh index may be wrong.
void checkNodesOf(const aiScene& source, const fs::path& file) {
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

/// Assimp's readers trust faces blindly: of a damaged file they may have no vertices or indices out of range, and a
/// mesh may be marked as polygons without one.
void checkFacesOf(const aiScene& source, const fs::path& file) {
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

}  // namespace

ImportedModel::ImportedModel(const fs::path& file, std::span<const std::uint8_t> content)
    : file_(file), importer_(std::make_unique<Assimp::Importer>()) {
  importer_->SetIOHandler(new ModelFiles(file.string(), content));  // all file access goes through it
  importer_->SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  try {
    const ImportGuard guard(file);
    scene_ = importer_->ReadFile(file.string(), 0);
    if (scene_) checkNodesOf(*scene_, file);
    if (scene_) checkFacesOf(*scene_, file);
  } catch (const Error&) { throw; } catch (const std::exception& e) {
    throwBadInput("{}: cannot be read as a model: {}", file.string(), e.what());
  }
  if (!scene_ || !scene_->mRootNode)
    throwBadInput("{}: cannot be read as a model: {}", file.string(), importer_->GetErrorString());
}

ImportedModel::~ImportedModel() {
  const ImportGuard guard(file_);
  importer_.reset();
}

void ImportedModel::forEachMesh(const MeshVisitor& visit) const {
  std::vector<std::pair<const aiNode*, glm::dmat4>> open = {{scene_->mRootNode, glm::dmat4(1.0)}};
  while (!open.empty()) {
    const auto [node, worldFromParent] = open.back();
    open.pop_back();
    const glm::dmat4 worldFromNode = worldFromParent * toGlm(node->mTransformation);
    for (unsigned i = 0; i < node->mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_->mMeshes[node->mMeshes[i]];
      const bool hasFaces = mesh.mPrimitiveTypes & (aiPrimitiveType_TRIANGLE | aiPrimitiveType_POLYGON);
      const bool standsIn = material(mesh.mMaterialIndex).GetName() == aiString("SkeletonMaterial");
      if (hasFaces && !standsIn)
        visit(mesh, worldFromNode, mesh.mName.length > 0 ? mesh.mName.C_Str() : node->mName.C_Str());
    }
    for (unsigned i = node->mNumChildren; i-- > 0;) open.emplace_back(node->mChildren[i], worldFromNode);
  }
}

const aiMaterial& ImportedModel::material(unsigned index) const {
  if (index >= scene_->mNumMaterials)
    throwBadInput("{}: a mesh names material {}, the file holds {}", file_.string(), index, scene_->mNumMaterials);
  return *scene_->mMaterials[index];
}

TextureLoader::Embedded ImportedModel::embedded() const {
  return [scene = scene_](const std::string& name, const fs::path& label) -> std::optional<Bitmap> {
    const aiTexture* texture = scene->GetEmbeddedTexture(name.c_str());
    if (!texture) return std::nullopt;
    if (texture->mHeight == 0)  // a whole file; mWidth is its size
      return decodeBitmap({reinterpret_cast<const std::uint8_t*>(texture->pcData), texture->mWidth}, label);
    Bitmap bitmap{static_cast<int>(texture->mWidth), static_cast<int>(texture->mHeight), {}, false};
    const std::size_t count = std::size_t{texture->mWidth} * texture->mHeight;
    bitmap.rgba.reserve(4 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const aiTexel& texel = texture->pcData[i];
      bitmap.rgba.insert(bitmap.rgba.end(), {texel.r, texel.g, texel.b, texel.a});
      bitmap.hasAlpha |= texel.a < 255;
    }
    return bitmap;
  };
}

glm::dmat4 ImportedModel::worldFromNamedNode(const std::string& name) const {
  aiMatrix4x4 world;
  for (const aiNode* node = scene_->mRootNode->FindNode(name.c_str()); node; node = node->mParent)
    world = node->mTransformation * world;
  return toGlm(world);
}

std::vector<ModelLight> ImportedModel::lights() const {
  std::vector<ModelLight> lights;
  for (unsigned i = 0; i < scene_->mNumLights; ++i) {
    const aiLight& given = *scene_->mLights[i];
    ModelLight& light = lights.emplace_back();
    light.name = given.mName.C_Str();
    const glm::dmat4 world = worldFromNamedNode(light.name);
    light.kind = given.mType == aiLightSource_DIRECTIONAL ? ModelLight::Kind::directional
                 : given.mType == aiLightSource_POINT     ? ModelLight::Kind::point
                 : given.mType == aiLightSource_SPOT      ? ModelLight::Kind::spot
                                                          : ModelLight::Kind::other;
    light.position = glm::dvec3(world * glm::dvec4(toGlm(given.mPosition), 1.0));
    light.direction = glm::dmat3(world) * glm::dvec3(toGlm(given.mDirection));
    light.colour = toGlm(given.mColorDiffuse);
    light.attenuation = given.mAttenuationQuadratic;
    light.innerAngle = 0.5 * given.mAngleInnerCone;  // full cones
    light.outerAngle = 0.5 * given.mAngleOuterCone;
  }
  return lights;
}

std::vector<Camera> ImportedModel::cameras() const {
  std::vector<Camera> cameras;
  for (unsigned i = 0; i < scene_->mNumCameras; ++i) {
    const aiCamera& given = *scene_->mCameras[i];
    Camera& camera = cameras.emplace_back();
    camera.name = given.mName.C_Str();
    const glm::dmat4 world = worldFromNamedNode(camera.name);
    camera.position = glm::dvec3(world * glm::dvec4(toGlm(given.mPosition), 1.0));
    camera.direction = glm::dmat3(world) * glm::dvec3(toGlm(given.mLookAt));
    camera.up = glm::dmat3(world) * glm::dvec3(toGlm(given.mUp));
    const double horizontal = given.mHorizontalFOV;
    camera.verticalFov = horizontal;  // where no aspect is known
    if (given.mAspect > 0.0f) camera.verticalFov = 2.0 * std::atan(std::tan(0.5 * horizontal) / given.mAspect);
  }
  return cameras;
}

std::optional<float> numberOf(const aiMaterial& material, const char* key, unsigned type, unsigned index) {
  float value = 0.0f;
  if (material.Get(key, type, index, value) != aiReturn_SUCCESS) return std::nullopt;
  return value;
}

std::optional<glm::vec3> colourOf(const aiMaterial& material, const char* key, unsigned type, unsigned index,
                                  float highest) {
  aiColor3D read;
  if (material.Get(key, type, index, read) != aiReturn_SUCCESS) return std::nullopt;
  glm::vec3 value;
  for (int c = 0; c < 3; ++c) value[c] = clampedNumber(toGlm(read)[c], 0.0f, highest, 0.0f);
  return value;
}

PictureUse pictureOf(const aiMaterial& material, std::initializer_list<aiTextureType> types) {
  const auto wrapOf = [](aiTextureMapMode mode) {
    if (mode == aiTextureMapMode_Mirror) return TextureWrap::mirror;
    return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? TextureWrap::edge : TextureWrap::repeat;
  };
  for (const aiTextureType type : types) {
    aiString name;
    aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (material.GetTexture(type, 0, &name, nullptr, nullptr, nullptr, nullptr, modes) == aiReturn_SUCCESS &&
        name.length > 0)
      return {name.C_Str(), {wrapOf(modes[0]), wrapOf(modes[1])}};
  }
  return {};
}

}  // namespace lucerna
