// glTF 2: meshes as the nodes of the default scene place them, lights and cameras [GLTF2].
// - A mesh is drawn in the pose of the file: morphed by its node's weights or else its own (3.7.2.2), skinned by its
//   joints where the file's nodes stand (3.7.3.3). Animations are not played.
// - Without normals it is flat (3.7.2.1). Points and lines are not drawn.
// - EXT_mesh_gpu_instancing repeats a node's mesh. Colours that all vertices of a mesh share go into its material,
//   others by their mean.
// - Numbers are in double until they are a scene's vertices: a node may lie far away.
// - Lights' candela are not divided by a luminous efficacy. An orthographic camera shows its height (2 ymag); the width
//   follows from the picture's, as it does for perspective ones.
#include "base/angles.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "scene/gltf_material.hpp"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>

namespace lucerna {

namespace {

/// The members of a node's transform: an array of `size` numbers.
std::vector<double> numbersIn(const Value& value, std::size_t size) {
  if (!value.json.is_array() || value.json.size() != size) value.fail(fmt::format("an array of {} numbers", size));
  std::vector<double> numbers;
  for (std::size_t i = 0; i < size; ++i) numbers.push_back(value.at(i).number());
  return numbers;
}

/// Of 16 numbers, column by column.
template <class Numbers>
glm::dmat4 matrixOf(const Numbers& number) {
  glm::dmat4 m;
  for (std::size_t k = 0; k < 16; ++k) m[static_cast<int>(k / 4)][static_cast<int>(k % 4)] = number(k);
  return m;
}

/// `rotation`: a quaternion x, y, z, w of any length but 0, which is none.
glm::dmat4 matrixOf(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale) {
  const double length = glm::length(rotation);
  const glm::dvec4 q = length > 0.0 ? rotation / length : glm::dvec4(0.0, 0.0, 0.0, 1.0);
  glm::dmat4 m(glm::mat3_cast(glm::dquat(q.w, q.x, q.y, q.z)));
  for (int c = 0; c < 3; ++c) m[c] *= scale[c];
  m[3] = glm::dvec4(translation, 1.0);
  return m;
}

glm::dmat4 localTransform(const Value& node) {
  if (node.has("matrix")) {
    const std::vector<double> numbers = numbersIn(node.at("matrix"), 16);
    return matrixOf([&](std::size_t k) { return numbers[k]; });
  }
  glm::dvec3 translation(0.0), scale(1.0);
  glm::dvec4 rotation(0.0, 0.0, 0.0, 1.0);
  const auto read = [&](const char* key, auto& to) {
    if (!node.has(key)) return;
    const std::vector<double> numbers = numbersIn(node.at(key), static_cast<std::size_t>(to.length()));
    for (int k = 0; k < to.length(); ++k) to[k] = numbers[static_cast<std::size_t>(k)];
  };
  read("translation", translation);
  read("rotation", rotation);
  read("scale", scale);
  return matrixOf(translation, rotation, scale);
}

using Triangles = std::vector<std::array<unsigned, 3>>;

/// A primitive's triangles and the vertices that they use.
struct Corners {
  std::size_t there = 0;  ///< vertices that the primitive has
  std::vector<std::size_t> used;  ///< those in use, in the order of the file
  Triangles triangles;  ///< of the numbers of those in use
};

/// A mesh's vertices in use, before and after its pose.
struct Vertices {
  std::vector<glm::dvec3> positions, normals;  ///< without normals: empty
  std::vector<glm::dvec2> texCoords;  ///< as in the file, v = 0 being the top
  std::vector<glm::dvec4> colours;
};

/// A primitive as one node, or several, place it.
struct Shape {
  MeshData data;
  int material = 0;
};

class GltfReader {
 public:
  GltfReader(Scene& scene, std::span<const std::uint8_t> content)
      : scene_(scene), file_(scene.file, content), textures_(scene, gltfPictures(file_)) {}

  ModelViews read() {
    findTransforms();
    for (const std::size_t node : drawnNodes()) readNode(node);
    place();
    warn();
    return std::move(views_);
  }

 private:
  using Primitive = std::pair<std::size_t, std::size_t>;  ///< a mesh and the number of its primitive
  struct Placed {
    std::shared_ptr<const Shape> shape;
    glm::dmat4 worldFromMesh{1.0};
  };

  void findTransforms();
  std::vector<std::size_t> drawnNodes() const;
  void readNode(std::size_t index);
  void readMesh(const Value& node, std::size_t index, const std::string& nodeName);
  std::vector<glm::dmat4> instances(const Value& node) const;
  std::vector<double> weightsOf(const Value& node, const Value& mesh) const;
  GltfNumbers attribute(const Value& attributes, const std::string& name, std::string_view types,
                        std::size_t count) const;
  Vertices verticesOf(const Value& primitive, const Corners& corners, const std::vector<double>& weights,
                      unsigned texCoords) const;
  std::vector<bool> skin(Vertices& vertices, const Value& node, const Value& primitive, const Corners& corners,
                         const glm::dmat4& worldFromNode) const;
  Corners cornersOf(const Value& primitive);
  std::shared_ptr<Shape> shapeOf(const Value& node, const Value& primitive, const std::vector<double>& weights,
                                 const std::string& name, const glm::dmat4& worldFromNode, bool skinned);
  int materialFor(std::optional<std::size_t> index, const glm::vec3& tint);
  GltfMaterial& propertiesOf(std::optional<std::size_t> index);
  void readLight(const Value& node, const std::string& name, const glm::dmat4& world);
  void readCamera(const Value& node, const std::string& name, const glm::dmat4& world);
  void count(std::size_t triangles);
  void place();
  void warn() const;

  Scene& scene_;
  GltfFile file_;
  TextureLoader textures_;
  std::vector<glm::dmat4> worldFromNode_;
  std::map<std::optional<std::size_t>, GltfMaterial> properties_;
  /// Those in use, once per vertex colour.
  std::map<std::pair<std::optional<std::size_t>, std::array<float, 3>>, int> materials_;
  std::map<Primitive, std::shared_ptr<Shape>> shapes_;  ///< of meshes in the pose of their own weights, unskinned
  std::vector<Placed> placed_;
  ModelViews views_;
  std::size_t triangles_ = 0, notDrawn_ = 0, withoutPositions_ = 0, leftOverIndices_ = 0;
  std::string ranged_;  ///< lights that have a range, which contradicts 1/d^2
};

// ------------------------------------------------------------------------------------------------ nodes

void GltfReader::findTransforms() {
  const std::vector<int>& parents = file_.parents();
  std::vector<bool> known(parents.size(), false);
  worldFromNode_.assign(parents.size(), glm::dmat4(1.0));
  for (std::size_t i = 0; i < parents.size(); ++i) {
    std::vector<std::size_t> way;  // up to the first ancestor that is known
    for (int at = static_cast<int>(i); at >= 0 && !known[static_cast<std::size_t>(at)];
         at = parents[static_cast<std::size_t>(at)])
      way.push_back(static_cast<std::size_t>(at));
    for (auto step = way.rbegin(); step != way.rend(); ++step) {
      const glm::dmat4 local = localTransform(file_.at("nodes", *step));
      const int parent = parents[*step];
      worldFromNode_[*step] = parent < 0 ? local : worldFromNode_[static_cast<std::size_t>(parent)] * local;
      known[*step] = true;
    }
  }
}

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
  if (node.has("camera")) readCamera(node, name, worldFromNode_[index]);
  readLight(node, name, worldFromNode_[index]);
}

// ------------------------------------------------------------------------------------------------ meshes

/// Weights of morph targets: the node's, or else the mesh's.
std::vector<double> GltfReader::weightsOf(const Value& node, const Value& mesh) const {
  const Value& owner = node.has("weights") ? node : mesh;
  if (!owner.has("weights")) return {};
  const Value weights = owner.at("weights");
  if (!weights.json.is_array()) weights.fail("an array");
  return numbersIn(weights, weights.json.size());
}

void GltfReader::readMesh(const Value& node, std::size_t index, const std::string& nodeName) {
  const std::size_t meshIndex = file_.indexOf(node.at("mesh"), "meshes");
  const Value mesh = file_.at("meshes", meshIndex);
  if (!mesh.json.is_object() || !mesh.has("primitives") || !mesh.at("primitives").json.is_array())
    mesh.fail("an object with an array of primitives");
  const std::string name = mesh.has("name") ? mesh.at("name").text() : nodeName;
  const std::vector<double> weights = weightsOf(node, mesh);
  const std::vector<glm::dmat4> placesInNode = instances(node);
  const Value primitives = mesh.at("primitives");
  for (std::size_t p = 0; p < primitives.json.size(); ++p) {
    const Value primitive = primitives.at(p);
    if (!primitive.json.is_object() || !primitive.has("attributes") || !primitive.at("attributes").json.is_object())
      primitive.fail("an object with attributes");
    const bool skinned = node.has("skin") && primitive.at("attributes").has("JOINTS_0");
    const bool isShared = !skinned && !node.has("weights");
    std::shared_ptr<Shape> shape;
    if (const auto known = shapes_.find({meshIndex, p}); isShared && known != shapes_.end()) shape = known->second;
    else shape = shapeOf(node, primitive, weights, name, worldFromNode_[index], skinned);
    if (isShared) shapes_[{meshIndex, p}] = shape;
    if (!shape) continue;
    // A skin's joints place it, whatever its node (3.7.3.3).
    if (skinned) placed_.push_back({shape, glm::dmat4(1.0)});
    else
      for (const glm::dmat4& place : placesInNode) placed_.push_back({shape, worldFromNode_[index] * place});
  }
}

/// Of EXT_mesh_gpu_instancing; otherwise one, the node itself.
std::vector<glm::dmat4> GltfReader::instances(const Value& node) const {
  const std::optional<Value> extension = GltfFile::extension(node, "EXT_mesh_gpu_instancing");
  if (!extension) return {glm::dmat4(1.0)};
  if (!extension->has("attributes") || !extension->at("attributes").json.is_object())
    extension->fail("an object with attributes");
  const Value attributes = extension->at("attributes");
  std::optional<std::size_t> count;
  const auto read = [&](const char* name, std::string_view type) -> std::optional<GltfNumbers> {
    if (!attributes.has(name)) return std::nullopt;
    const std::size_t accessor = file_.indexOf(attributes.at(name), "accessors");
    if (!file_.at("accessors", accessor).has("bufferView")) attributes.at(name).fail("an accessor with a bufferView");
    GltfNumbers numbers = file_.numbers(accessor, type);
    if (count.value_or(numbers.count) != numbers.count)
      attributes.fail("attributes of one count, the number of instances");
    count = numbers.count;
    return numbers;
  };
  const auto translation = read("TRANSLATION", "VEC3"), rotation = read("ROTATION", "VEC4"),
             scale = read("SCALE", "VEC3");
  if (!count) return {glm::dmat4(1.0)};
  std::vector<glm::dmat4> result;
  for (std::size_t i = 0; i < *count; ++i)
    result.push_back(
        matrixOf(translation ? translation->vector(i) : glm::dvec3(0.0),
                 rotation ? glm::dvec4(rotation->vector(i), rotation->at(i, 3)) : glm::dvec4(0.0, 0.0, 0.0, 1.0),
                 scale ? scale->vector(i) : glm::dvec3(1.0)));
  return result;
}

/// An attribute of as many elements as there are vertices; without it none.
GltfNumbers GltfReader::attribute(const Value& attributes, const std::string& name, std::string_view types,
                                  std::size_t count) const {
  if (!attributes.has(name)) return {};
  const std::size_t accessor = file_.indexOf(attributes.at(name), "accessors");
  GltfNumbers numbers = file_.numbers(accessor, types);
  if (count > 0 && numbers.count != count)
    throwBadInput("{}: {}.{}: accessor {} holds {} elements, the mesh has {} vertices", file_.path().string(),
                  attributes.key, name, accessor, numbers.count, count);
  return numbers;
}

/// Morphed: the sum of its attributes and of its targets' by their weights. `texCoords`: which set.
Vertices GltfReader::verticesOf(const Value& primitive, const Corners& corners, const std::vector<double>& weights,
                                unsigned texCoords) const {
  Vertices vertices;
  const std::string texCoordName = fmt::format("TEXCOORD_{}", texCoords);
  const auto add = [&](const Value& attributes, double weight, bool isTarget) {
    const auto addTo = [&](auto& to, const std::string& name, std::string_view types) {
      const GltfNumbers numbers = attribute(attributes, name, types, corners.there);
      if (numbers.count == 0 || (isTarget && to.empty())) return;
      if (!isTarget) to.resize(corners.used.size());
      for (std::size_t i = 0; i < to.size(); ++i)
        for (std::size_t k = 0; k < numbers.width; ++k)
          to[i][static_cast<int>(k)] += weight * numbers.at(corners.used[i], k);
    };
    addTo(vertices.positions, "POSITION", "VEC3");
    addTo(vertices.normals, "NORMAL", "VEC3");
    addTo(vertices.texCoords, texCoordName, "VEC2");
    addTo(vertices.colours, "COLOR_0", "VEC3 VEC4");
    if (!isTarget && attribute(attributes, "COLOR_0", "VEC3 VEC4", corners.there).width == 3)
      for (glm::dvec4& colour : vertices.colours) colour.w = 1.0;
  };
  add(primitive.at("attributes"), 1.0, false);
  if (!primitive.has("targets")) return vertices;
  const Value targets = primitive.at("targets");
  if (!targets.json.is_array()) targets.fail("an array");
  for (std::size_t t = 0; t < targets.json.size() && t < weights.size(); ++t) {
    if (!targets.at(t).json.is_object()) targets.at(t).fail("an object {...}");
    if (weights[t] != 0.0) add(targets.at(t), weights[t], true);
  }
  return vertices;
}

/// Moves the vertices into the world by their joints. Returns of which the joints turn left into right.
std::vector<bool> GltfReader::skin(Vertices& vertices, const Value& node, const Value& primitive,
                                   const Corners& corners, const glm::dmat4& worldFromNode) const {
  const Value skin = file_.at("skins", file_.indexOf(node.at("skin"), "skins"));
  if (!skin.json.is_object() || !skin.has("joints") || !skin.at("joints").json.is_array() ||
      skin.at("joints").json.empty())
    skin.fail("an object with an array of joints");
  std::vector<glm::dmat4> worldFromMesh;
  for (std::size_t j = 0; j < skin.at("joints").json.size(); ++j)
    worldFromMesh.push_back(worldFromNode_[file_.indexOf(skin.at("joints").at(j), "nodes")]);
  if (skin.has("inverseBindMatrices")) {
    const GltfNumbers inverse = file_.numbers(file_.indexOf(skin.at("inverseBindMatrices"), "accessors"), "MAT4");
    if (inverse.count < worldFromMesh.size())
      throwBadInput("{}: {}: {} inverseBindMatrices of {} joints", file_.path().string(), skin.key, inverse.count,
                    worldFromMesh.size());
    for (std::size_t j = 0; j < worldFromMesh.size(); ++j)
      worldFromMesh[j] = worldFromMesh[j] * matrixOf([&](std::size_t k) { return inverse.at(j, k); });
  }

  const std::size_t count = corners.used.size();
  std::vector<glm::dmat4> matrices(count, glm::dmat4(0.0));
  std::vector<double> sums(count, 0.0);
  const Value attributes = primitive.at("attributes");
  for (int set = 0; attributes.has(fmt::format("JOINTS_{}", set)); ++set) {
    const GltfNumbers joints = attribute(attributes, fmt::format("JOINTS_{}", set), "VEC4", corners.there),
                      weights = attribute(attributes, fmt::format("WEIGHTS_{}", set), "VEC4", corners.there);
    if (weights.count == 0) attributes.fail(fmt::format("WEIGHTS_{0} beside JOINTS_{0}", set));
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 4; ++k) {
        const double weight = weights.at(corners.used[i], k), joint = joints.at(corners.used[i], k);
        if (!(weight > 0.0)) continue;
        if (!(joint >= 0.0 && joint < static_cast<double>(worldFromMesh.size())))
          throwBadInput("{}: {}: vertex {} names joint {}, the skin has {}", file_.path().string(), attributes.key,
                        corners.used[i], joint, worldFromMesh.size());
        matrices[i] += weight * worldFromMesh[static_cast<std::size_t>(joint)];
        sums[i] += weight;
      }
  }
  std::vector<bool> mirrored(count, false);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dmat4 m = sums[i] > 0.0 ? matrices[i] / sums[i] : worldFromNode;  // no joint moves it
    const glm::dmat3 linear(m);
    vertices.positions[i] = glm::dvec3(m * glm::dvec4(vertices.positions[i], 1.0));
    mirrored[i] = glm::determinant(linear) < 0.0;
    if (vertices.normals.empty()) continue;
    // As in model_mesh.cpp: the cofactor matrix is the inverse transpose times the determinant.
    const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                              glm::cross(linear[0], linear[1]));
    vertices.normals[i] = cofactor * vertices.normals[i] * (mirrored[i] ? -1.0 : 1.0);
  }
  return mirrored;
}

/// Of lists, strips and fans (3.7.2.1). No triangles of points and lines, which are counted.
Corners GltfReader::cornersOf(const Value& primitive) {
  Corners corners;
  const GltfNumbers positions = attribute(primitive.at("attributes"), "POSITION", "VEC3", 0);
  if (positions.count == 0) {
    ++withoutPositions_;
    return corners;
  }
  corners.there = positions.count;
  constexpr std::size_t kTriangles = 4, kFan = 6;  // between them: strips
  const std::size_t mode = primitive.has("mode") ? wholeNumber(primitive, "mode") : kTriangles;
  if (mode > kFan) primitive.at("mode").fail("a number from 0 to 6");
  if (mode < kTriangles) {
    ++notDrawn_;
    return corners;
  }
  std::vector<std::uint32_t> indices;
  if (primitive.has("indices")) {
    indices = file_.indices(file_.indexOf(primitive.at("indices"), "accessors"));
    for (std::size_t i = 0; i < indices.size(); ++i)
      if (indices[i] >= corners.there)
        throwBadInput("{}: {}: index {} refers to vertex {}, the mesh holds {}", file_.path().string(), primitive.key,
                      i, indices[i], corners.there);
  } else {
    indices.resize(corners.there);
    std::iota(indices.begin(), indices.end(), 0u);
  }
  if (mode == kTriangles) {
    leftOverIndices_ += indices.size() % 3;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
      corners.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  } else {
    for (std::size_t i = 0; i + 2 < indices.size(); ++i) {
      const std::array<unsigned, 3> t =
          mode == kFan ? std::array<unsigned, 3>{indices[i + 1], indices[i + 2], indices[0]}
                       : std::array<unsigned, 3>{indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) corners.triangles.push_back(t);  // strips are joined by such
    }
  }

  // Numbers of the vertices in use.
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  for (std::array<unsigned, 3>& t : corners.triangles)
    for (unsigned& i : t)
      i = static_cast<unsigned>(std::lower_bound(indices.begin(), indices.end(), i) - indices.begin());
  corners.used.assign(indices.begin(), indices.end());
  return corners;
}

/// The colour of a mesh's vertices, a factor on the base colour: its mean over the surface, and whether all vertices
/// share it.
std::pair<glm::vec3, bool> vertexColour(const Vertices& vertices, const Triangles& triangles) {
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

/// Whether any texture coordinate lies outside the picture by more than rounding.
bool leavesItsPicture(const MeshData& mesh) {
  constexpr float kRounding = 1e-4f;
  return std::any_of(mesh.texCoords.begin(), mesh.texCoords.end(), [&](const glm::vec2& uv) {
    return !(std::min(uv.x, uv.y) >= -kRounding && std::max(uv.x, uv.y) <= 1.0f + kRounding);
  });
}

/// With vertices of its own for each triangle, which are flat, if there are no normals.
MeshData dataOf(const Vertices& vertices, const Triangles& triangles, const TextureTransform& transform) {
  MeshData data;
  const bool isFlat = vertices.normals.empty();
  const auto add = [&](std::size_t i) {
    data.positions.push_back(vertices.positions[i]);
    if (!isFlat) {
      const double length = glm::length(vertices.normals[i]);  // of quantised ones anything
      data.normals.emplace_back(length > 0.0 ? vertices.normals[i] / length : glm::dvec3(0.0));
    }
    if (vertices.texCoords.empty()) return;
    const glm::dvec2 uv = transform.apply(vertices.texCoords[i]);
    data.texCoords.emplace_back(uv.x, 1.0 - uv.y);  // in a Scene v = 0 is the bottom
  };
  if (!isFlat) {
    for (std::size_t i = 0; i < vertices.positions.size(); ++i) add(i);
    data.triangles = triangles;
    return data;
  }
  for (const std::array<unsigned, 3>& triangle : triangles) {
    const auto first = static_cast<unsigned>(data.positions.size());
    for (const unsigned i : triangle) add(i);
    data.triangles.push_back({first, first + 1, first + 2});
  }
  return data;
}

/// Null if nothing of it is drawn.
std::shared_ptr<Shape> GltfReader::shapeOf(const Value& node, const Value& primitive,
                                           const std::vector<double>& weights, const std::string& name,
                                           const glm::dmat4& worldFromNode, bool skinned) {
  std::optional<std::size_t> material;
  if (primitive.has("material")) material = file_.indexOf(primitive.at("material"), "materials");
  GltfMaterial& gltf = propertiesOf(material);
  const TextureTransform transform = gltf.transform.value_or(TextureTransform{});
  Corners corners = cornersOf(primitive);
  if (corners.triangles.empty()) return nullptr;
  count(corners.triangles.size());
  Triangles& triangles = corners.triangles;
  Vertices vertices = verticesOf(primitive, corners, weights, transform.texCoord);
  if (skinned) {
    const std::vector<bool> mirrored = skin(vertices, node, primitive, corners, worldFromNode);
    for (std::array<unsigned, 3>& t : triangles)
      if (mirrored[t[0]]) std::swap(t[1], t[2]);
  }
  const auto shape = std::make_shared<Shape>();
  shape->data = dataOf(vertices, triangles, transform);
  shape->data.name = name;

  const auto [tint, same] = vertexColour(vertices, triangles);
  if (!same) gltf.lacks("vertex colours are their mean");
  const bool haveAlpha = std::any_of(vertices.colours.begin(), vertices.colours.end(),
                                     [](const glm::dvec4& colour) { return colour.w < 1.0; });
  if (haveAlpha && gltf.alpha != GltfMaterial::Alpha::opaque) gltf.lacks("vertices' alpha is not read");
  if (gltf.transform && vertices.texCoords.empty())
    gltf.lacks(fmt::format("a mesh without its texture coordinates (TEXCOORD_{})", transform.texCoord));
  if (gltf.clamped && leavesItsPicture(shape->data))
    gltf.lacks("its texture repeats where it should be clamped or mirrored");
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
  if (placed_.empty() && notDrawn_ > 0)
    throwBadInput("{}: nothing to draw: points and lines alone, {} primitives of them", scene_.file.string(),
                  notDrawn_);
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
  for (const Placed& placed : placed_) {
    const glm::dmat4 sceneFromMesh = sceneFromWorld * placed.worldFromMesh;
    appendMesh(scene_, placed.shape->data, sceneFromMesh, placed.shape->material);
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

void GltfReader::readLight(const Value& node, const std::string& nodeName, const glm::dmat4& world) {
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
  light.colour = glm::vec3(glm::dvec3(given.has("color") ? given.at("color").light() : glm::vec3(1.0f)) * intensity);
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
  views_.lights.push_back(light);
}

void GltfReader::readCamera(const Value& node, const std::string& name, const glm::dmat4& world) {
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
}

// ------------------------------------------------------------------------------------------------ warnings

void GltfReader::warn() const {
  const std::string file = file_.path().string();
  for (const auto& [index, gltf] : properties_)
    if (!gltf.notDone.empty()) logWarning("{}: material '{}': {}", file, gltf.name, gltf.notDone);
  if (const std::vector<std::string> unsupported = file_.unsupported(); !unsupported.empty())
    logWarning("{}: extensions that are not supported: {}", file, fmt::join(unsupported, ", "));
  if (notDrawn_ > 0) logWarning("{}: {} primitives of points or lines are not drawn", file, notDrawn_);
  if (withoutPositions_ > 0) logWarning("{}: {} primitives without positions are not drawn", file, withoutPositions_);
  if (leftOverIndices_ > 0)
    logWarning("{}: {} indices at the ends of primitives make no triangle", file, leftOverIndices_);
  if (const std::size_t animations = file_.count("animations"); animations > 0)
    logWarning("{}: {} animations are not played", file, animations);
  if (!ranged_.empty()) logWarning("{}: lights {}: range ignored, falloff is 1/d^2 without a limit", file, ranged_);
}

}  // namespace

ModelViews readGltf(Scene& scene, std::span<const std::uint8_t> content) { return GltfReader(scene, content).read(); }

}  // namespace lucerna
