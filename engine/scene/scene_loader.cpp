// Loads scenes. The readers of formats: glTF (gltf_reader.cpp), and here all others that Assimp knows. What they share:
// pictures (model_textures.cpp), materials (model_material.cpp), meshes (model_mesh.cpp), lights and cameras
// (model_lights.cpp), Assimp itself (model_import.cpp). What files leave out: scene_defaults.cpp.
//
// Decisions where MTL is silent:
// - A material with opacity 0 would be invisible; exporters that mix up `d` and `Tr` write it for solid things, so it
//   counts as 1.
// - illum 5 is a mirror of Ks; illum 4, 6, 7 and 9 with an Ni are a smooth dielectric of that index (Ni 1: a boundary
//   without effect).
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/model_import.hpp"
#include "scene/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

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

void setIllum(Material& material, const aiMaterial& source) {
  int illum = 0;
  if (source.Get("$mat.illum", 0, 0, illum) != aiReturn_SUCCESS) return;
  const float index = numberOf(source, AI_MATKEY_REFRACTI).value_or(0.0f);
  if (illum == 5 && material.specular != glm::vec3(0.0f)) material.bsdf = Bsdf::mirror;
  if ((illum == 4 || illum == 6 || illum == 7 || illum == 9) && std::isfinite(index) && index >= 1.0f) {
    material.bsdf = Bsdf::dielectric;
    material.ior = index;
  }
}

void setOpacity(Material& material, const aiMaterial& source, const fs::path& file) {
  material.opacity = clampedNumber(numberOf(source, AI_MATKEY_OPACITY).value_or(1.0f), 0.0f, 1.0f, 1.0f);
  if (material.opacity > 0.0f) return;
  logWarning("{}: material '{}' has opacity 0; using 1", file.string(), material.name);
  material.opacity = 1.0f;
}

Material readMaterial(const aiMaterial& source, TextureLoader& textures, const fs::path& file) {
  Material material = colours(source, glm::vec3(1.0f));
  if (numberOf(source, AI_MATKEY_METALLIC_FACTOR))
    setMetallicRoughness(material, source, glm::vec3(1.0f),
                         textures.mean(pictureOf(source, {aiTextureType_METALNESS, aiTextureType_UNKNOWN})),
                         numberOf(source, AI_MATKEY_TRANSMISSION_FACTOR).value_or(0.0f));
  setIllum(material, source);
  setEmission(material, source, textures, numberOf(source, AI_MATKEY_EMISSIVE_INTENSITY).value_or(1.0f));
  setOpacity(material, source, file);
  setAlbedoAndMask(material, source, textures);
  return material;
}

/// All formats but glTF.
ModelViews readOther(Scene& scene, std::vector<std::uint8_t> content) {
  const std::string extension = lowerExtension(scene.file);
  if (extension == ".obj") {
    const std::string_view text(reinterpret_cast<const char*>(content.data()), content.size());
    checkObj(scene.file, text);
    const std::string repaired = repairedObj(text);
    content.assign(repaired.begin(), repaired.end());
  }
  if (content.empty()) throwBadInput("{}: the file is empty", scene.file.string());
  if (extension == ".off") checkOff(scene.file, content);
  const ImportedModel model(scene.file, content);
  readMeshes(scene, model);
  return {model.lights(), model.cameras()};
}

}  // namespace

void readMeshes(Scene& scene, const ImportedModel& model) {
  TextureLoader textures(scene, model.embedded());
  std::map<unsigned, int> materialOf;  // those in use
  model.forEachMesh([&](const aiMesh& mesh, const glm::dmat4& worldFromNode, const std::string& name) {
    const aiMaterial& source = model.material(mesh.mMaterialIndex);
    const auto [material, isNew] =
        materialOf.try_emplace(mesh.mMaterialIndex, static_cast<int>(scene.materials.size()));
    if (isNew) scene.materials.push_back(readMaterial(source, textures, scene.file));
    appendMesh(scene, meshData(mesh, name), worldFromNode, material->second);
  });
}

Scene loadModel(const fs::path& file) {
  Scene scene;
  scene.name = file.stem().string();
  scene.file = file;
  std::vector<std::uint8_t> content = readFileBytes(file);  // also tells a missing file or a folder
  const std::string extension = lowerExtension(file);
  const bool isGltf = extension == ".gltf" || extension == ".glb";
  if (isGltf && content.empty()) throwBadInput("{}: the file is empty", file.string());
  const ModelViews views = isGltf ? readGltf(scene, content) : readOther(scene, std::move(content));

  if (scene.indices.empty())
    throwBadInput("{}: nothing to draw: no triangles ({} dropped as not finite)", file.string(),
                  scene.droppedTriangles);
  if (scene.degenerateTriangles == scene.triangleCount())
    throwBadInput("{}: nothing to draw: all triangles have zero area", file.string());
  if (scene.droppedTriangles > 0)
    logWarning("{}: {} triangles with positions that are not finite ignored", file.string(), scene.droppedTriangles);

  appendLights(scene, views.lights);
  setDefaultSun(scene);
  appendCameras(scene, views.cameras);
  setDefaultView(scene);
  return scene;
}

Scene loadScene(const fs::path& file) {
  if (lowerExtension(file) == ".json") return loadSceneFile(file);
  Scene scene = loadModel(file);
  setDefaultSky(scene);
  setDefaultExposure(scene, scene.cameras.front());
  setExposureForLamps(scene);
  return scene;
}

}  // namespace lucerna
