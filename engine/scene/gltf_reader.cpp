// glTF 2: meshes as the nodes of the default scene place them, lights and cameras [GLTF2].
// - A mesh is drawn in the pose of the file: morphed by its node's weights or else its own (3.7.2.2), skinned by its
//   joints where the file's nodes stand (3.7.3.3). Animations move it from there (gltf_animations.hpp).
// - Without normals it is flat (3.7.2.1). Points and lines are not drawn.
// - EXT_mesh_gpu_instancing repeats a node's mesh. Colours that all vertices of a mesh share go into its material,
//   others by their mean.
// - Numbers are in double until they are a scene's vertices: a node may lie far away.
// - Lights' candela are not divided by a luminous efficacy. An orthographic camera shows its height (2 ymag); the width
//   follows from the picture's, as it does for perspective ones.
#include "base/angles.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "scene/gltf_animations.hpp"
#include "scene/gltf_material.hpp"
#include "scene/gltf_meshes.hpp"
#include "scene/motion.hpp"
#include "scene/texture_mean.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>

namespace lucerna {

namespace {

/// A primitive as one node, or several, place it.
struct Shape {
  MeshData data;
  int material = 0;
  TextureTransform transform;
};

class GltfReader {
 public:
  GltfReader(Scene& scene, std::span<const std::uint8_t> content)
      : scene_(scene),
        shared_(std::make_shared<const GltfFile>(scene.file, content)),
        file_(*shared_),
        meshes_(std::make_shared<GltfMeshes>(shared_)),
        animations_(file_),
        textures_(scene, gltfPictures(file_)) {}

  ModelViews read() {
    for (const std::size_t node : drawnNodes()) readNode(node);
    place();
    warn();
    addMotion();
    return std::move(views_);
  }

 private:
  using Primitive = std::pair<std::size_t, std::size_t>;  ///< a mesh and the number of its primitive
  struct Placed {
    std::shared_ptr<const Shape> shape;
    glm::dmat4 worldFromMesh{1.0};
    // Of what moves:
    std::size_t node = 0, primitive = 0;
    glm::dmat4 place{1.0};  ///< in the node
    bool moves = false, isPosedAnew = false;  ///< the second: skinned or morphed
    std::size_t mesh = 0;  ///< of the scene
  };

  std::vector<std::size_t> drawnNodes() const;
  void readNode(std::size_t index);
  void readMesh(const Value& node, std::size_t index, const std::string& nodeName);
  bool jointsMove(const Value& node) const;
  std::shared_ptr<Shape> shapeOf(std::size_t node, const Value& primitive, const std::string& name);
  int materialFor(std::optional<std::size_t> index, const glm::vec3& tint);
  GltfMaterial& propertiesOf(std::optional<std::size_t> index);
  void readLight(const Value& node, const std::string& name, std::size_t index);
  void readCamera(const Value& node, const std::string& name, std::size_t index);
  void count(std::size_t triangles);
  void place();
  void warn() const;
  void addMotion();
  void moveMaterials(SceneMotion& motion);

  Scene& scene_;
  std::shared_ptr<const GltfFile> shared_;
  const GltfFile& file_;
  std::shared_ptr<GltfMeshes> meshes_;
  GltfAnimations animations_;
  TextureLoader textures_;
  std::map<std::optional<std::size_t>, GltfMaterial> properties_;
  /// Those in use, once per vertex colour.
  std::map<std::pair<std::optional<std::size_t>, std::array<float, 3>>, int> materials_;
  std::map<Primitive, std::shared_ptr<Shape>> shapes_;  ///< of meshes in the pose of their own weights, unskinned
  std::vector<Placed> placed_;
  ModelViews views_;
  std::size_t triangles_ = 0;
  std::string ranged_;  ///< lights that have a range, which contradicts 1/d^2
};

// ------------------------------------------------------------------------------------------------ nodes

/// Those of the default scene and their descendants, parents before children, each once. Without scenes, all.
std::vector<std::size_t> GltfReader::drawnNodes() const {
  std::vector<std::size_t> open, found;
  const std::size_t scenes = file_.count("scenes");
  if (scenes > 0) {
    const Value scene =
        file_.at("scenes", file_.root().has("scene") ? file_.indexOf(file_.root().at("scene"), "scenes") : 0);
    if (!scene.json.is_object()) scene.fail("an object {...}");
    if (scene.has("nodes")) {
      const Value nodes = scene.at("nodes");
      if (!nodes.json.is_array()) nodes.fail("an array");
      for (std::size_t i = 0; i < nodes.json.size(); ++i) open.push_back(file_.indexOf(nodes.at(i), "nodes"));
    }
  } else {
    for (std::size_t i = 0; i < file_.parents().size(); ++i)
      if (file_.parents()[i] < 0) open.push_back(i);
  }
  std::reverse(open.begin(), open.end());
  std::vector<bool> seen(file_.parents().size(), false);
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    if (seen[node]) continue;
    seen[node] = true;
    found.push_back(node);
    const Json& json = file_.at("nodes", node).json;
    if (const auto children = json.find("children"); children != json.end())
      for (auto child = children->rbegin(); child != children->rend(); ++child)
        open.push_back(child->get<std::size_t>());
  }
  return found;
}

void GltfReader::readNode(std::size_t index) {
  const Value node = file_.at("nodes", index);
  const std::string name = node.has("name") ? node.at("name").text() : fmt::format("nodes_{}", index);
  if (node.has("mesh")) readMesh(node, index, name);
  if (node.has("camera")) readCamera(node, name, index);
  readLight(node, name, index);
}

// ------------------------------------------------------------------------------------------------ meshes

void GltfReader::readMesh(const Value& node, std::size_t index, const std::string& nodeName) {
  const std::size_t meshIndex = file_.indexOf(node.at("mesh"), "meshes");
  const Value mesh = file_.at("meshes", meshIndex);
  if (!mesh.json.is_object() || !mesh.has("primitives") || !mesh.at("primitives").json.is_array())
    mesh.fail("an object with an array of primitives");
  const std::string name = mesh.has("name") ? mesh.at("name").text() : nodeName;
  const std::vector<glm::dmat4> placesInNode = meshes_->instances(node);
  const bool moves = animations_.moves(index), morphs = animations_.morphs(index);
  const Value primitives = mesh.at("primitives");
  for (std::size_t p = 0; p < primitives.json.size(); ++p) {
    const Value primitive = primitives.at(p);
    if (!primitive.json.is_object() || !primitive.has("attributes") || !primitive.at("attributes").json.is_object())
      primitive.fail("an object with attributes");
    const bool skinned = GltfMeshes::isSkinned(node, primitive);
    const bool isShared = !skinned && !node.has("weights") && !morphs;
    std::shared_ptr<Shape> shape;
    if (const auto known = shapes_.find({meshIndex, p}); isShared && known != shapes_.end()) shape = known->second;
    else shape = shapeOf(index, primitive, name);
    if (isShared) shapes_[{meshIndex, p}] = shape;
    if (!shape) continue;
    // A skin's joints place it, whatever its node (3.7.3.3).
    if (skinned) {
      const bool isPosed = morphs || moves || jointsMove(node);
      placed_.push_back({shape, glm::dmat4(1.0), index, p, glm::dmat4(1.0), isPosed, isPosed});
      continue;
    }
    for (const glm::dmat4& place : placesInNode)
      placed_.push_back({shape, meshes_->worldFromNode(index) * place, index, p, place, moves || morphs, morphs});
  }
}

bool GltfReader::jointsMove(const Value& node) const {
  const Value joints = file_.at("skins", file_.indexOf(node.at("skin"), "skins")).at("joints");
  for (std::size_t j = 0; j < joints.json.size(); ++j)
    if (animations_.moves(file_.indexOf(joints.at(j), "nodes"))) return true;
  return false;
}

/// The colour of a mesh's vertices, a factor on the base colour: its mean over the surface, and whether all vertices
/// share it.
std::pair<glm::vec3, bool> vertexColour(const GltfVertices& vertices, const GltfTriangles& triangles) {
  if (vertices.colours.empty()) return {glm::vec3(1.0f), true};
  const auto at = [&](unsigned i) { return glm::dvec3(vertices.colours[i]); };
  glm::dvec3 sum(0.0);
  double area = 0.0;
  bool same = true;
  for (const auto& [a, b, c] : triangles) {
    const std::vector<glm::dvec3>& p = vertices.positions;
    const double weight = glm::length(glm::cross(p[b] - p[a], p[c] - p[a]));
    if (!std::isfinite(weight) || !isFinite(at(a) + at(b) + at(c))) continue;
    sum += weight * (at(a) + at(b) + at(c)) / 3.0;
    area += weight;
    same = same && at(a) == at(triangles[0][0]) && at(b) == at(a) && at(c) == at(a);
  }
  return {area > 0.0 ? glm::clamp(glm::vec3(sum / area), 0.0f, 1.0f) : glm::vec3(1.0f), same};
}

/// Null if nothing of it is drawn.
std::shared_ptr<Shape> GltfReader::shapeOf(std::size_t node, const Value& primitive, const std::string& name) {
  std::optional<std::size_t> material;
  if (primitive.has("material")) material = file_.indexOf(primitive.at("material"), "materials");
  GltfMaterial& gltf = propertiesOf(material);
  const auto shape = std::make_shared<Shape>();
  shape->transform = gltf.transform.value_or(TextureTransform{});
  GltfShape read = meshes_->shapeOf(node, primitive, shape->transform);
  const GltfTriangles& triangles = read.corners.triangles;
  const GltfVertices& vertices = read.vertices;
  if (triangles.empty()) return nullptr;
  count(triangles.size());
  shape->data = std::move(read.data);
  shape->data.name = name;

  const auto [tint, same] = vertexColour(vertices, triangles);
  if (!same) gltf.lacks("vertex colours are their mean");
  const bool haveAlpha = std::any_of(vertices.colours.begin(), vertices.colours.end(),
                                     [](const glm::dvec4& colour) { return colour.w < 1.0; });
  if (haveAlpha && gltf.alpha != GltfMaterial::Alpha::opaque) gltf.lacks("vertices' alpha is not read");
  if (gltf.transform && vertices.texCoords.empty())
    gltf.lacks(fmt::format("a mesh without its texture coordinates (TEXCOORD_{})", shape->transform.texCoord));
  shape->material = materialFor(material, tint);
  return scene_.materials[static_cast<std::size_t>(shape->material)].opacity > 0.0f ? shape : nullptr;
}

GltfMaterial& GltfReader::propertiesOf(std::optional<std::size_t> index) {
  const auto known = properties_.find(index);
  if (known != properties_.end()) return known->second;
  return properties_.emplace(index, gltfMaterial(file_, index)).first->second;
}

int GltfReader::materialFor(std::optional<std::size_t> index, const glm::vec3& tint) {
  const auto [material, isNew] =
      materials_.try_emplace({index, {tint.x, tint.y, tint.z}}, static_cast<int>(scene_.materials.size()));
  if (isNew) scene_.materials.push_back(materialOf(propertiesOf(index), tint, textures_, scene_));
  return material->second;
}

/// Small files must not become scenes beyond all memory: meshes may share accessors, and nodes meshes.
void GltfReader::count(std::size_t triangles) {
  constexpr std::size_t kPerByte = 256, kAlways = 1u << 20;
  triangles_ += triangles;
  if (const std::size_t bytes = file_.bytesRead(); triangles_ > kAlways + kPerByte * bytes)
    throwBadInput("{}: {} triangles or more from {} bytes, at most {} a byte are supported", file_.path().string(),
                  triangles_, bytes, kPerByte);
}

/// What single precision does to a mesh.
struct Rounding {
  Bounds bounds;
  double loss = 0.0;  ///< largest change of a coordinate
  double edges = 0.0;  ///< sum of lengths
  std::size_t edgeCount = 0;

  void add(const MeshData& mesh, const glm::dmat4& worldFromMesh) {
    for (const std::array<unsigned, 3>& t : mesh.triangles) {
      std::array<glm::dvec3, 3> corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = glm::dvec3(worldFromMesh * glm::dvec4(mesh.positions[t[k]], 1.0));
      for (std::size_t k = 0; k < 3; ++k) {
        const auto rounded = glm::dvec3(glm::vec3(corners[k]));
        if (!isFinite(rounded)) continue;
        const glm::dvec3 change = glm::abs(rounded - corners[k]);
        loss = std::max({loss, change.x, change.y, change.z});
        bounds.add(corners[k]);
        if (const double edge = glm::length(corners[(k + 1) % 3] - corners[k]); std::isfinite(edge))
          edges += edge, ++edgeCount;
      }
    }
  }
  /// Whether it changes an edge of average length by more than a part of it.
  bool exceeds(double part) const { return edgeCount > 0 && loss > part * edges / static_cast<double>(edgeCount); }
};

/// Where a model lies that single precision would ruin, as a round number; 0: near enough.
glm::dvec3 offsetFor(const Rounding& rounding) {
  glm::dvec3 offset(0.0);
  if (!rounding.exceeds(1e-4)) return offset;
  const glm::dvec3 extent = rounding.bounds.extent(), centre = rounding.bounds.centre();
  const double most = std::max({extent.x, extent.y, extent.z, 1e-30}),
               step = std::pow(10.0, std::floor(std::log10(most)));
  for (int k = 0; k < 3; ++k)
    if (std::abs(centre[k]) > 4.0 * most) offset[k] = std::round(centre[k] / step) * step;
  return offset;
}

/// Appends what was found to the scene.
void GltfReader::place() {
  if (placed_.empty() && meshes_->notDrawn > 0)
    throwBadInput("{}: nothing to draw: points and lines alone, {} primitives of them", scene_.file.string(),
                  meshes_->notDrawn);
  Rounding all;
  for (const Placed& placed : placed_) {
    count(placed.shape->data.triangles.size());
    all.add(placed.shape->data, placed.worldFromMesh);
  }
  scene_.origin = offsetFor(all);
  if (scene_.origin != glm::dvec3(0.0))
    logWarning("{}: ({:.15g}, {:.15g}, {:.15g}) taken off all positions: single precision would lose their detail",
               scene_.file.string(), scene_.origin.x, scene_.origin.y, scene_.origin.z);
  for (ModelLight& light : views_.lights) light.position -= scene_.origin;
  for (Camera& camera : views_.cameras) camera.position -= scene_.origin;

  glm::dmat4 sceneFromWorld(1.0);
  sceneFromWorld[3] -= glm::dvec4(scene_.origin, 0.0);
  std::string worst;
  double most = 0.0;
  for (Placed& placed : placed_) {
    placed.mesh = scene_.meshes.size();
    const glm::dmat4 sceneFromMesh = sceneFromWorld * placed.worldFromMesh;
    appendMesh(scene_, placed.shape->data, sceneFromMesh, placed.shape->material,
               placed.moves ? SharedVertices::no : SharedVertices::yes);
    placed.moves = placed.moves && scene_.meshes.size() > placed.mesh;
    if (!all.exceeds(1e-2)) continue;
    Rounding own;
    own.add(placed.shape->data, sceneFromMesh);
    if (own.exceeds(1e-2) && own.loss > most) most = own.loss, worst = placed.shape->data.name;
  }
  if (most > 0.0)
    logWarning("{}: so far from the others, single precision moves vertices by up to {:.2g} (mesh '{}')",
               scene_.file.string(), most, worst);
}

// ------------------------------------------------------------------------------------------------ lights, cameras

void GltfReader::readLight(const Value& node, const std::string& nodeName, std::size_t index) {
  const glm::dmat4& world = meshes_->worldFromNode(index);
  const std::optional<Value> use = GltfFile::extension(node, "KHR_lights_punctual");
  if (!use) return;
  const std::optional<Value> all = GltfFile::extension(file_.root(), "KHR_lights_punctual");
  if (!use->has("light") || !all || !all->has("lights") || !all->at("lights").json.is_array())
    use->fail("the number of a light of KHR_lights_punctual");
  const Value lights = all->at("lights"), number = use->at("light");
  if (!number.json.is_number_unsigned() || number.json.get<std::size_t>() >= lights.json.size())
    number.fail(fmt::format("the number of one of {} lights", lights.json.size()));
  const Value given = lights.at(number.json.get<std::size_t>());
  if (!given.json.is_object() || !given.has("type")) given.fail("an object with a type");
  const std::string type = given.at("type").text();
  ModelLight light;
  light.name = node.has("name") || !given.has("name") ? nodeName : given.at("name").text();
  light.kind = type == "directional" ? ModelLight::Kind::directional
               : type == "point"     ? ModelLight::Kind::point
               : type == "spot"      ? ModelLight::Kind::spot
                                     : ModelLight::Kind::other;
  light.position = glm::dvec3(world[3]);
  light.direction = -glm::dvec3(world[2]);
  const double intensity = given.has("intensity") ? given.at("intensity").number() : 1.0;
  const glm::dvec3 colour(given.has("color") ? given.at("color").light() : glm::vec3(1.0f));
  light.colour = glm::vec3(colour * intensity);
  if (const auto which = number.json.get<std::size_t>(); animations_.movesLight(which)) {
    light.colourAt = [animations = animations_, which, colour, intensity](double seconds) {
      return animations.lightAt(which, colour, intensity, seconds);
    };
    if (light.colour == glm::vec3(0.0f)) light.colour = glm::vec3(1.0f);  // it may be off at rest
  }
  if (light.kind == ModelLight::Kind::spot) {
    light.outerAngle = 0.25 * kPi;
    if (given.has("spot")) {
      const Value spot = given.at("spot");
      if (!spot.json.is_object()) spot.fail("an object {...}");
      if (spot.has("innerConeAngle")) light.innerAngle = spot.at("innerConeAngle").number();
      if (spot.has("outerConeAngle")) light.outerAngle = spot.at("outerConeAngle").number();
    }
  }
  if (given.has("range")) {
    const std::string name = given.has("name") ? given.at("name").text() : light.name;
    if (ranged_.find(name) == std::string::npos) ranged_ += (ranged_.empty() ? "" : ", ") + name;
  }
  light.node = index;
  views_.lights.push_back(light);
}

void GltfReader::readCamera(const Value& node, const std::string& name, std::size_t index) {
  const glm::dmat4& world = meshes_->worldFromNode(index);
  const Value given = file_.at("cameras", file_.indexOf(node.at("camera"), "cameras"));
  if (!given.json.is_object() || !given.has("type")) given.fail("an object with a type");
  const std::string type = given.at("type").text();
  if (type != "perspective" && type != "orthographic") given.at("type").fail("perspective or orthographic");
  const char* key = type == "perspective" ? "yfov" : "ymag";
  if (!given.has(type) || !given.at(type).json.is_object() || !given.at(type).has(key))
    given.fail(fmt::format("an object {} with {}", type, key));
  const double value = given.at(type).at(key).number();
  Camera camera;
  camera.name = name;
  camera.position = glm::dvec3(world[3]);
  camera.direction = -glm::dvec3(world[2]);
  camera.up = glm::dvec3(world[1]);
  if (type == "perspective") camera.verticalFov = value;
  else if (value != 0.0) camera.orthographicHeight = 2.0 * std::abs(value);
  else camera.verticalFov = 0.0;  // refused with a warning, as it is of perspective ones
  views_.cameras.push_back(camera);
  views_.cameraNodes.push_back(index);
}

// ------------------------------------------------------------------------------------------------ warnings

void GltfReader::warn() const {
  const std::string file = file_.path().string();
  for (const auto& [index, gltf] : properties_)
    if (!gltf.notDone.empty()) logWarning("{}: material '{}': {}", file, gltf.name, gltf.notDone);
  if (const std::vector<std::string> unsupported = file_.unsupported(); !unsupported.empty())
    logWarning("{}: extensions that are not supported: {}", file, fmt::join(unsupported, ", "));
  if (meshes_->notDrawn > 0) logWarning("{}: {} primitives of points or lines are not drawn", file, meshes_->notDrawn);
  if (meshes_->withoutPositions > 0)
    logWarning("{}: {} primitives without positions are not drawn", file, meshes_->withoutPositions);
  if (meshes_->leftOverIndices > 0)
    logWarning("{}: {} indices at the ends of primitives make no triangle", file, meshes_->leftOverIndices);
  if (!animations_.notPlayed().empty()) logWarning("{}: animations: {} is not played", file, animations_.notPlayed());
  if (!ranged_.empty()) logWarning("{}: lights {}: range ignored, falloff is 1/d^2 without a limit", file, ranged_);
}

/// What the animations move. Meshes that move have vertices of their own, one for each of the file's.
void GltfReader::addMotion() {
  if (animations_.empty()) return;
  SceneMotion& motion = motionOf(scene_);
  motion.end = animations_.end();
  std::erase_if(placed_, [](const Placed& placed) { return !placed.moves; });
  glm::dmat4 sceneFromWorld(1.0);
  sceneFromWorld[3] -= glm::dvec4(scene_.origin, 0.0);
  for (const Placed& placed : placed_) motion.meshes.push_back(placed.mesh);
  if (!placed_.empty()) {
    motion.names.emplace_back("meshes");
    motion[SceneMotion::Part::meshes] = [file = shared_, meshes = meshes_, animations = animations_, placed = placed_,
                                         sceneFromWorld](Scene& scene, double seconds) {
      meshes->setPose(animations.at(seconds));
      for (const Placed& one : placed) {
        if (one.isPosedAnew) {
          const Value mesh = file->at("meshes", file->indexOf(file->at("nodes", one.node).at("mesh"), "meshes"));
          const Value primitive = mesh.at("primitives").at(one.primitive);
          const bool skinned = GltfMeshes::isSkinned(file->at("nodes", one.node), primitive);
          const MeshData data = meshes->shapeOf(one.node, primitive, one.shape->transform).data;
          replaceMesh(scene, one.mesh, data,
                      skinned ? sceneFromWorld : sceneFromWorld * meshes->worldFromNode(one.node) * one.place);
        } else {
          replaceMesh(scene, one.mesh, one.shape->data, sceneFromWorld * meshes->worldFromNode(one.node) * one.place);
        }
      }
    };
  }
  moveMaterials(motion);
  views_.worldFromNode = [meshes = meshes_, animations = animations_, origin = scene_.origin](std::size_t node,
                                                                                              double seconds) {
    meshes->setPose(animations.at(seconds));
    glm::dmat4 world = meshes->worldFromNode(node);
    world[3] -= glm::dvec4(origin, 0.0);
    return world;
  };
  views_.moves = [animations = animations_](std::size_t node) { return animations.moves(node); };
}

void GltfReader::moveMaterials(SceneMotion& motion) {
  struct Moved {
    std::size_t index, material;  ///< in the file, in the scene
    GltfMaterial gltf;
    glm::vec3 tint, metalMean, emissiveMean;
  };
  std::vector<Moved> moved;
  for (const auto& [key, material] : materials_) {
    if (!key.first || !animations_.movesMaterial(*key.first)) continue;
    const GltfMaterial& gltf = propertiesOf(key.first);
    const auto number = static_cast<std::size_t>(material);
    const int metal = textures_.optional(gltf.metalPicture), emission = scene_.materials[number].emissionTexture;
    moved.push_back({*key.first, number, gltf, glm::vec3(key.second[0], key.second[1], key.second[2]),
                     metal >= 0 ? meanValue(textures_[metal]) : glm::vec3(1.0f),
                     emission >= 0 ? glm::vec3(meanColour(textures_[emission])) : glm::vec3(1.0f)});
  }
  if (moved.empty()) return;
  motion.names.emplace_back("materials");
  motion[SceneMotion::Part::media] = [animations = animations_, moved](Scene& scene, double seconds) {
    for (const Moved& one : moved) {
      GltfMaterial now = one.gltf;
      animations.setMaterial(now, one.index, seconds);
      setFactors(scene.materials[one.material], now, one.tint, one.metalMean, one.emissiveMean);
    }
  };
}

}  // namespace

ModelViews readGltf(Scene& scene, std::span<const std::uint8_t> content) { return GltfReader(scene, content).read(); }

}  // namespace lucerna
