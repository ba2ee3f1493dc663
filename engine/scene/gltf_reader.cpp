// glTF: through Assimp, and from its own JSON where Assimp 5.2.5 lacks (gltf_file.hpp). KHR_texture_transform
// goes into the texture coordinates, alphaCutoff over baseColorFactor's alpha into the mask,
// KHR_materials_emissive_strength into the emission, KHR_materials_volume into a medium, colours that all vertices of a
// mesh share into its material. Unsupported properties give one warning per material. Occlusion textures are not read:
// techniques compute that light themselves. Metallic-roughness is read texel by texel (MetalMap). Lights' candela are
// not divided by a luminous efficacy.
#include "scene/gltf_file.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "scene/model_import.hpp"
#include "scene/scene_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace lucerna {

namespace {

void setMetal(Material& material, const aiMaterial& source, TextureLoader& textures, const GltfMaterial& gltf,
              const glm::vec3& tint) {
  const std::optional<float> metallic = numberOf(source, AI_MATKEY_METALLIC_FACTOR);
  if (!metallic) return;
  const float roughness = numberOf(source, AI_MATKEY_ROUGHNESS_FACTOR).value_or(1.0f);
  // Its own texture slot in Assimp 5.2.
  const int picture = textures.optional(pictureOf(source, {aiTextureType_METALNESS, aiTextureType_UNKNOWN}));
  const MetalMap factors{glm::vec3(1.0f), clampedNumber(*metallic, 0.0f, 1.0f, 0.0f),
                         clampedNumber(roughness, 0.0f, 1.0f, 1.0f), picture};
  const glm::vec3 base =
      setMetallicRoughness(material, source, tint, picture >= 0 ? meanValue(textures[picture]) : glm::vec3(1.0f),
                           static_cast<float>(gltf.transmission));
  // A metal's picture is the colour of its reflection.
  const bool coloured = !pictureOf(source, {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR}).empty();
  if (picture >= 0 || (factors.metallic > 0.0f && coloured)) {
    material.metalMap = factors;
    material.metalMap->base = base;
  }
}

void setInterior(Material& material, Scene& scene, const GltfMaterial& gltf) {
  if (material.bsdf != Bsdf::dielectric) return;
  material.ior = gltf.ior;
  if (!(gltf.thickness > 0.0) || gltf.absorption == glm::vec3(0.0f)) return;
  Medium medium;
  medium.name = material.name;
  medium.absorption = gltf.absorption;
  material.interior = static_cast<int>(scene.media.size());
  scene.media.push_back(std::move(medium));
}

/// Alpha is never blended: masks are cut at the cut-off, or at one half.
void setMask(Material& material, TextureLoader& textures, const GltfMaterial& gltf) {
  if (gltf.alpha == GltfMaterial::Alpha::opaque) {
    material.alphaMasked = false;
    return;
  }
  const double cutoff = gltf.alpha == GltfMaterial::Alpha::mask ? gltf.alphaCutoff : 0.5;
  const double threshold = gltf.alpha == GltfMaterial::Alpha::blend ? 0.5
                           : gltf.baseAlpha > 0.0                   ? cutoff / gltf.baseAlpha
                           : cutoff > 0.0                           ? 2.0
                                                                    : 0.0;
  if (threshold > 1.0) material.opacity = 0.0f;  // cut out everywhere
  else if (threshold <= 0.0) material.alphaMasked = false;
  else if (material.alphaMasked && threshold != 0.5)
    material.diffuseTexture = textures.withThreshold(material.diffuseTexture, threshold);
}

Material readMaterial(const aiMaterial& source, TextureLoader& textures, Scene& scene, const GltfMaterial& gltf,
                      const glm::vec3& tint) {
  Material material = colours(source, tint);
  material.name = gltf.name;
  setMetal(material, source, textures, gltf, tint);
  setInterior(material, scene, gltf);
  setEmission(material, source, textures, gltf.emissiveStrength);
  material.normalTexture = textures.optional(pictureOf(source, {aiTextureType_NORMALS}));
  material.normalScale = gltf.normalScale;
  setAlbedoAndMask(material, source, textures);
  setMask(material, textures, gltf);
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
  const auto position = [&](unsigned i) {
    return glm::dvec3(mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z);
  };
  glm::dvec3 sum(0.0);
  double area = 0.0;
  bool same = true;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;
    const unsigned a = face.mIndices[0], b = face.mIndices[1], c = face.mIndices[2];
    const double weight = glm::length(glm::cross(position(b) - position(a), position(c) - position(a)));
    if (!std::isfinite(weight) || !isFinite(at(a) + at(b) + at(c))) continue;
    sum += weight * (at(a) + at(b) + at(c)) / 3.0;
    area += weight;
    same = same && at(a) == at(mesh.mFaces[0].mIndices[0]) && at(b) == at(a) && at(c) == at(a);
  }
  return {area > 0.0 ? glm::clamp(glm::vec3(sum / area), 0.0f, 1.0f) : glm::vec3(1.0f), same};
}

/// With the texture's transform, in which v points down.
MeshData transformed(const aiMesh& mesh, const std::string& name, const TextureTransform& transform) {
  MeshData data = meshData(mesh, name, transform.texCoord);
  if (transform == TextureTransform{.texCoord = transform.texCoord}) return data;
  for (glm::vec2& uv : data.texCoords) {
    const glm::dvec2 moved = transform.apply({uv.x, 1.0 - uv.y});
    uv = {static_cast<float>(moved.x), static_cast<float>(1.0 - moved.y)};
  }
  return data;
}

/// Whether any texture coordinate lies outside the picture by more than rounding.
bool leavesPicture(const MeshData& mesh) {
  constexpr float kRounding = 1e-4f;
  return std::any_of(mesh.texCoords.begin(), mesh.texCoords.end(), [&](const glm::vec2& uv) {
    return !(std::min(uv.x, uv.y) >= -kRounding && std::max(uv.x, uv.y) <= 1.0f + kRounding);
  });
}

void readMeshes(Scene& scene, const ImportedModel& model, const Json& root) {
  TextureLoader textures(scene, model.embedded());
  std::map<unsigned, GltfMaterial> properties;
  std::map<std::pair<unsigned, std::array<float, 3>>, int> materialOf;  // those in use, once per vertex colour
  model.forEachMesh([&](const aiMesh& mesh, const glm::dmat4& worldFromNode, const std::string& name) {
    const unsigned index = mesh.mMaterialIndex;
    const aiMaterial& source = model.material(index);
    const auto [known, isNew] = properties.try_emplace(index);
    GltfMaterial& gltf = known->second;
    if (const auto number = numberOf(source.GetName().C_Str()); isNew && number)
      gltf = gltfMaterial(root, scene.file, *number);
    const auto lacks = [&](std::string_view what) {
      if (gltf.notDone.find(what) == std::string::npos)
        gltf.notDone += fmt::format("{}{}", gltf.notDone.empty() ? "" : ", ", what);
    };
    const MeshData data = transformed(mesh, name, gltf.transform);
    const auto [tint, same] = vertexColour(mesh);
    if (!same) lacks("vertex colours are their mean");
    if (haveAlpha(mesh) && gltf.alpha != GltfMaterial::Alpha::opaque) lacks("vertices' alpha is not read");
    if (gltf.clamped && leavesPicture(data)) lacks("its texture repeats where it should be clamped or mirrored");
    const auto [material, isNewTint] =
        materialOf.try_emplace({index, {tint.x, tint.y, tint.z}}, static_cast<int>(scene.materials.size()));
    if (isNewTint) scene.materials.push_back(readMaterial(source, textures, scene, gltf, tint));
    if (scene.materials[static_cast<std::size_t>(material->second)].opacity > 0.0f)
      appendMesh(scene, data, worldFromNode, material->second);
  });
  for (const auto& [index, gltf] : properties)
    if (!gltf.notDone.empty()) logWarning("{}: material '{}': {}", scene.file.string(), gltf.name, gltf.notDone);
}

std::vector<ModelLight> lightsOf(const ImportedModel& model) {
  std::vector<ModelLight> lights = model.lights();
  for (ModelLight& light : lights) {
    light.name = withoutNumber(light.name);
    light.attenuation = 1.0f;
    light.innerAngle *= 2.0;  // Assimp passes on half angles for full cones
    light.outerAngle *= 2.0;
  }
  return lights;
}

std::vector<Camera> camerasOf(const ImportedModel& model, const Json& root) {
  std::vector<Camera> cameras = model.cameras();
  for (Camera& camera : cameras) {
    // Assimp 5.2 copies a node's translation into its camera too.
    camera.position = glm::dvec3(model.worldFromNamedNode(camera.name) * glm::dvec4(0.0, 0.0, 0.0, 1.0));
    if (const auto number = numberOf(camera.name)) camera.verticalFov = gltfFieldOfView(root, *number);
    camera.name = withoutNumber(camera.name);
  }
  return cameras;
}

}  // namespace

ModelViews readGltf(Scene& scene, std::span<const std::uint8_t> content) {
  const Json root = checkedGltf(scene.file, content);
  const auto isArray = [&](const char* key) { return root.contains(key) && root.at(key).is_array(); };
  const bool isGltf2 = isArray("materials");  // glTF 1 has objects
  std::vector<std::uint8_t> numbered(content.begin(), content.end());
  if (isGltf2 || isArray("nodes")) numbered = withNumbers(root, content);
  const ImportedModel model(scene.file, numbered);
  if (isGltf2) readMeshes(scene, model, root);
  else readMeshes(scene, model);
  if (const std::string ranged = gltfLightsWithRange(root); !ranged.empty())
    logWarning("{}: lights {}: range ignored, falloff is 1/d^2 without a limit", scene.file.string(), ranged);
  return {lightsOf(model), camerasOf(model, root)};
}

}  // namespace lucerna
