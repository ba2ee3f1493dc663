// Loads scenes. The readers of formats: glTF (gltf_reader.cpp), OBJ and MTL (obj_reader.cpp, mtl_file.cpp), PLY
// (ply_reader.cpp), STL (stl_reader.cpp), and here all others that Assimp knows. What they share: pictures
// (model_textures.cpp), materials (model_material.cpp), polygons (polygon_mesh.cpp), meshes (model_mesh.cpp), lights
// and cameras (model_lights.cpp), Assimp itself (model_import.cpp). What files leave out: scene_defaults.cpp.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/log.hpp"
#include "scene/json_value.hpp"
#include "scene/model_import.hpp"
#include "scene/main_bounds.hpp"
#include "scene/motion.hpp"
#include "scene/polygon_mesh.hpp"
#include "scene/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <sstream>
#include <tuple>

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

void setOpacity(Material& material, const aiMaterial& source, const fs::path& file) {
  material.opacity = clampedNumber(numberOf(source, AI_MATKEY_OPACITY).value_or(1.0f), 0.0f, 1.0f, 1.0f);
  if (material.opacity > 0.0f) return;
  logWarning("{}: material '{}' has opacity 0; using 1", file.string(), material.name);
  material.opacity = 1.0f;
}

Material readMaterial(const aiMaterial& source, TextureLoader& textures, const fs::path& file) {
  Material material = colours(source);
  if (numberOf(source, AI_MATKEY_METALLIC_FACTOR))
    setMetallicRoughness(material, source,
                         textures.mean(pictureOf(source, {aiTextureType_METALNESS, aiTextureType_UNKNOWN}).name));
  setEmission(material, source, textures);
  setOpacity(material, source, file);
  setAlbedoAndMask(material, source, textures);
  return material;
}

/// What a file without materials gets from Assimp, by name: white with a white highlight, or grey with a grey one.
bool isDefault(const aiMaterial& source) { return source.GetName() == aiString(AI_DEFAULT_MATERIAL_NAME); }

PolygonMesh polygonsOf(const aiMesh& mesh, const glm::dmat4& worldFromNode, const std::string& name, bool coloured) {
  PolygonMesh polygons;
  polygons.name = name;
  const glm::dmat3 linear(worldFromNode);
  const double side = glm::determinant(linear) < 0.0 ? -1.0 : 1.0;  // mirrored
  const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                            glm::cross(linear[0], linear[1]));
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const auto vector = [](const aiVector3D& v) { return glm::dvec3(v.x, v.y, v.z); };
    polygons.positions.emplace_back(worldFromNode * glm::dvec4(vector(mesh.mVertices[i]), 1.0));
    if (mesh.HasNormals()) {
      const glm::dvec3 normal = side * (cofactor * vector(mesh.mNormals[i]));
      const double length = glm::length(normal);
      polygons.normals.emplace_back(length > 0.0 && std::isfinite(length) ? normal / length : glm::dvec3(0.0));
    }
    if (mesh.HasTextureCoords(0)) polygons.texCoords.emplace_back(vector(mesh.mTextureCoords[0][i]));
    if (coloured) {
      const aiColor4D& c = mesh.mColors[0][i];
      polygons.colours.emplace_back(linearFromSrgb(clampedNumber(c.r, 0.0f, 1.0f, 1.0f)),
                                    linearFromSrgb(clampedNumber(c.g, 0.0f, 1.0f, 1.0f)),
                                    linearFromSrgb(clampedNumber(c.b, 0.0f, 1.0f, 1.0f)));
    }
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices < 3) continue;
    for (unsigned k = 0; k < face.mNumIndices; ++k)
      polygons.corners.push_back(face.mIndices[side > 0.0 ? k : face.mNumIndices - 1 - k]);
    polygons.endFace();
  }
  return polygons;
}

/// The model library keeps positions in single precision, also where a file has more.
void warnOfPrecision(const Scene& scene) {
  if (scene.bounds.empty()) return;
  const glm::dvec3 extent = scene.bounds.extent(), low = glm::abs(scene.bounds.min), high = glm::abs(scene.bounds.max);
  const double step = std::max({low.x, low.y, low.z, high.x, high.y, high.z}) * 0x1p-23;
  if (std::max({extent.x, extent.y, extent.z}) < 0x1p14 * step)
    logWarning("{}: so far from the origin, positions in single precision are {:.2g} apart", scene.file.string(), step);
}

/// Formats without a reader of their own. Vertex colours are the colour of what has no material.
ModelViews readOther(Scene& scene, std::span<const std::uint8_t> content) {
  if (lowerExtension(scene.file) == ".off") checkOff(scene.file, content);
  const ImportedModel model(scene.file, content);
  TextureLoader textures(scene, model.embedded());
  std::map<std::pair<unsigned, bool>, int> materialOf;  // those in use
  std::vector<PolygonMesh> meshes;
  model.forEachMesh([&](const aiMesh& mesh, const glm::dmat4& worldFromNode, const std::string& name) {
    const aiMaterial& source = model.material(mesh.mMaterialIndex);
    const bool isPlain = isDefault(source), coloured = isPlain && mesh.HasVertexColors(0);
    const auto [material, isNew] =
        materialOf.try_emplace({mesh.mMaterialIndex, coloured}, static_cast<int>(scene.materials.size()));
    if (isNew && isPlain) {
      Material& plain = scene.materials.emplace_back();
      plain.name = AI_DEFAULT_MATERIAL_NAME;
      plain.diffuse = glm::vec3(coloured ? 1.0f : kDefaultAlbedo);
    } else if (isNew) {
      scene.materials.push_back(readMaterial(source, textures, scene.file));
    }
    meshes.push_back(polygonsOf(mesh, worldFromNode, name, coloured));
    meshes.back().material = material->second;
  });
  appendPolygons(scene, std::move(meshes));
  warnOfPrecision(scene);
  ModelViews views{model.lights(), model.cameras()};
  for (ModelLight& light : views.lights) light.position -= scene.origin;
  for (Camera& camera : views.cameras) camera.position -= scene.origin;
  return views;
}

ModelViews readModel(Scene& scene, std::span<const std::uint8_t> content) {
  const std::string extension = lowerExtension(scene.file);
  const std::string_view text(reinterpret_cast<const char*>(content.data()), content.size());
  if (content.empty()) throwBadInput("{}: the file is empty", scene.file.string());
  if (extension == ".gltf" || extension == ".glb" || extension == ".vrm" || text.starts_with("glTF"))
    return readGltf(scene, content);
  if (extension == ".obj") return readObj(scene, content), ModelViews{};
  if (extension == ".ply") return readPly(scene, content), ModelViews{};
  if (extension == ".stl") return readStl(scene, content), ModelViews{};
  return readOther(scene, content);
}

/// The lights and cameras of an animated file. firstCamera: how many views of our own come before the file's.
void addMovingViews(Scene& scene, const ModelViews& views, const std::vector<int>& lights,
                    const std::vector<int>& cameras, std::size_t firstCamera) {
  using Kind = ModelLight::Kind;
  SceneMotion& motion = motionOf(scene);
  for (const auto& [kind, part, name] : {std::tuple(Kind::directional, SceneMotion::Part::sun, "sun"),
                                         std::tuple(Kind::spot, SceneMotion::Part::spots, "spots"),
                                         std::tuple(Kind::point, SceneMotion::Part::points, "points")}) {
    std::vector<std::pair<std::size_t, std::size_t>> moved;  // the scene's number of a light, and its node
    std::vector<std::pair<std::size_t, std::function<glm::vec3(double)>>> coloured;
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const ModelLight& light = views.lights[i];
      if (lights[i] < 0 || light.kind != kind) continue;
      if (views.moves(light.node)) moved.emplace_back(static_cast<std::size_t>(lights[i]), light.node);
      if (light.colourAt) coloured.emplace_back(static_cast<std::size_t>(lights[i]), light.colourAt);
    }
    if (moved.empty() && coloured.empty()) continue;
    motion.names.emplace_back(name);
    motion[part] = [kind = kind, moved, coloured, world = views.worldFromNode](Scene& posed, double seconds) {
      for (const auto& [light, colourAt] : coloured) {
        if (kind == Kind::point) posed.points[light].intensity = colourAt(seconds);
        if (kind == Kind::spot) posed.spots[light].intensity = colourAt(seconds);
        if (kind == Kind::directional) posed.sun->irradiance = colourAt(seconds);
      }
      for (const auto& [light, node] : moved) {
        const glm::dmat4 m = world(node, seconds);
        const glm::dvec3 forwards = -glm::dvec3(m[2]);
        const double length = glm::length(forwards);
        if (kind == Kind::point) posed.points[light].position = glm::dvec3(m[3]);
        if (kind == Kind::spot) posed.spots[light].position = glm::dvec3(m[3]);
        if (!(length > 0.0)) continue;
        if (kind == Kind::spot) posed.spots[light].direction = forwards / length;
        if (kind == Kind::directional) posed.sun->direction = forwards / length;
      }
    };
  }
  std::vector<std::pair<std::size_t, std::size_t>> moved;
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (cameras[i] >= 0 && views.moves(views.cameraNodes[i]))
      moved.emplace_back(firstCamera + static_cast<std::size_t>(cameras[i]), views.cameraNodes[i]);
  if (moved.empty()) return;
  motion.names.emplace_back("cameras");
  motion[SceneMotion::Part::views] = [moved, world = views.worldFromNode](Scene& posed, double seconds) {
    for (const auto& [index, node] : moved) {
      const glm::dmat4 m = world(node, seconds);
      Camera& camera = posed.cameras[index];
      const glm::dvec3 forwards = -glm::dvec3(m[2]), right = glm::cross(forwards, glm::dvec3(m[1]));
      camera.position = glm::dvec3(m[3]);
      if (!(glm::length(right) > 0.0)) continue;
      camera.direction = glm::normalize(forwards);
      camera.up = glm::normalize(glm::cross(right, camera.direction));
    }
  };
}

/// The surfaces of a model, and its lights and cameras.
ModelViews readSurfaces(Scene& scene, const fs::path& file) {
  scene.name = file.stem().string();
  scene.file = file;
  ModelViews views = readModel(scene, readFileBytes(file));  // also tells a missing file or a folder

  if (scene.indices.empty() && scene.droppedTriangles > 0)
    throwBadInput("{}: nothing to draw: none of its {} triangles has finite positions (up to 3.4e38)", file.string(),
                  scene.droppedTriangles);
  findMainBounds(scene);
  if (scene.indices.empty()) throwBadInput("{}: nothing to draw: it has no triangles", file.string());
  if (scene.degenerateTriangles == scene.triangleCount())
    throwBadInput("{}: nothing to draw: all triangles have zero area", file.string());
  if (scene.droppedTriangles > 0)
    logWarning("{}: {} triangles with positions that are not finite (up to 3.4e38) ignored", file.string(),
               scene.droppedTriangles);
  return views;
}

}  // namespace

Scene loadModel(const fs::path& file) {
  Scene scene;
  const ModelViews views = readSurfaces(scene, file);
  const std::vector<int> lights = appendLights(scene, views.lights);
  setDefaultSun(scene);
  const std::vector<int> cameras = appendCameras(scene, views.cameras);
  const std::size_t cameraCount = scene.cameras.size();
  setDefaultView(scene);
  if (views.moves) addMovingViews(scene, views, lights, cameras, scene.cameras.size() - cameraCount);
  return scene;
}

void addModel(Scene& scene, const fs::path& file) {
  Scene other;
  readSurfaces(other, file);
  if (other.motion)
    throwBadInput("{}: it has animations, which only the first model of a scene may have", file.string());
  const auto shift = [](int& index, std::size_t by) { index += index >= 0 ? static_cast<int>(by) : 0; };
  const auto firstVertex = static_cast<std::uint32_t>(scene.vertices.size()),
             firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  const glm::dvec3 offset = other.origin - scene.origin;
  for (Vertex& vertex : other.vertices) vertex.position = glm::vec3(glm::dvec3(vertex.position) + offset);
  for (std::uint32_t& index : other.indices) index += firstVertex;
  for (Mesh& mesh : other.meshes) {
    mesh.firstIndex += firstIndex;
    shift(mesh.material, scene.materials.size());
    mesh.bounds.min += offset;
    mesh.bounds.max += offset;
    scene.bounds.add(mesh.bounds);
  }
  for (Material& material : other.materials) {
    shift(material.interior, scene.media.size());
    for (int* texture :
         {&material.emissionTexture, &material.diffuseTexture, &material.alphaTexture, &material.normalTexture})
      shift(*texture, scene.textures.size());
    if (material.metalMap) shift(material.metalMap->texture, scene.textures.size());
  }
  const auto append = [](auto& to, auto& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  append(scene.vertices, other.vertices);
  append(scene.indices, other.indices);
  append(scene.meshes, other.meshes);
  append(scene.materials, other.materials);
  append(scene.textures, other.textures);
  append(scene.media, other.media);
  findMainBounds(scene);
  scene.degenerateTriangles += other.degenerateTriangles;
  scene.droppedTriangles += other.droppedTriangles;
}

namespace {

/// Surfaces that let light pass are dielectrics and masks; an opacity between them is not drawn.
void warnOfOpacity(const Scene& scene) {
  std::string names;
  for (const Material& m : scene.materials)
    if (m.opacity > 0.0f && m.opacity < 1.0f && m.bsdf != Bsdf::dielectric && m.bsdf != Bsdf::none && !m.alphaMasked)
      names += fmt::format("{}'{}' ({:.3g})", names.empty() ? "" : ", ", m.name, m.opacity);
  if (!names.empty()) logWarning("{}: opaque in spite of an opacity: material {}", scene.file.string(), names);
}

/// Lights of any file: finite, and not so bright that sums of light would leave the range of floats.
void checkLights(const Scene& scene, const fs::path& file) {
  const auto check = [&](const std::string& what, const glm::vec3& light) {
    for (int c = 0; c < 3; ++c)
      if (!(light[c] >= 0.0f && light[c] <= static_cast<float>(kMostLight)))
        throwBadInput("{}: {} is {} {} {}; expected numbers from 0 to {:g}", file.string(), what, light.x, light.y,
                      light.z, kMostLight);
  };
  if (scene.sun) check("the sun's irradiance", scene.sun->irradiance);
  for (std::size_t i = 0; i < scene.spots.size(); ++i)
    check(fmt::format("the intensity of spot {}", i + 1), scene.spots[i].intensity);
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    check(fmt::format("the intensity of point light {}", i + 1), scene.points[i].intensity);
  for (const Material& material : scene.materials) {
    check(fmt::format("the emission of material {}", material.name), material.emission);
    check(fmt::format("the emission of material {}", material.name), material.emissionScale);
  }
}

}  // namespace

Scene loadScene(const fs::path& file) {
  const bool isModel = lowerExtension(file) != ".json";
  Scene scene = isModel ? loadModel(file) : loadSceneFile(file);
  checkLights(scene, file);
  if (isModel) {
    setDefaultSky(scene);
    setDefaultExposure(scene, scene.cameras.front());
    setExposureForLamps(scene);
  }
  warnOfOpacity(scene);
  finishMotion(scene);
  return scene;
}

Scene loadScene(const fs::path& file, double seconds) {
  Scene scene = loadScene(file);
  if (seconds != 0.0) poseAt(scene, seconds);
  return scene;
}

}  // namespace lucerna
