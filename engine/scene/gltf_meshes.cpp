#include "scene/gltf_meshes.hpp"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
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

glm::dmat4 localTransform(const Value& node, const GltfNodePose* pose) {
  const bool isPosed = pose && (pose->translation || pose->rotation || pose->scale);
  if (node.has("matrix") && !isPosed) {
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
  if (isPosed) {
    translation = pose->translation.value_or(translation);
    rotation = pose->rotation.value_or(rotation);
    scale = pose->scale.value_or(scale);
  }
  return matrixOf(translation, rotation, scale);
}

}  // namespace

void GltfMeshes::setPose(std::map<std::size_t, GltfNodePose> pose) {
  pose_ = std::move(pose);
  const std::vector<int>& parents = file_->parents();
  std::vector<bool> known(parents.size(), false);
  worldFromNode_.assign(parents.size(), glm::dmat4(1.0));
  for (std::size_t i = 0; i < parents.size(); ++i) {
    std::vector<std::size_t> way;  // up to the first ancestor that is known
    for (int at = static_cast<int>(i); at >= 0 && !known[static_cast<std::size_t>(at)];
         at = parents[static_cast<std::size_t>(at)])
      way.push_back(static_cast<std::size_t>(at));
    for (auto step = way.rbegin(); step != way.rend(); ++step) {
      const auto posed = pose_.find(*step);
      const glm::dmat4 local =
          localTransform(file_->at("nodes", *step), posed == pose_.end() ? nullptr : &posed->second);
      const int parent = parents[*step];
      worldFromNode_[*step] = parent < 0 ? local : worldFromNode_[static_cast<std::size_t>(parent)] * local;
      known[*step] = true;
    }
  }
}

std::vector<double> GltfMeshes::weightsOf(std::size_t index) const {
  if (const auto posed = pose_.find(index); posed != pose_.end() && posed->second.weights)
    return *posed->second.weights;
  const Value node = file_->at("nodes", index);
  const Value mesh = file_->at("meshes", file_->indexOf(node.at("mesh"), "meshes"));
  const Value& owner = node.has("weights") ? node : mesh;
  if (!owner.has("weights")) return {};
  const Value weights = owner.at("weights");
  if (!weights.json.is_array()) weights.fail("an array");
  return numbersIn(weights, weights.json.size());
}

std::vector<glm::dmat4> GltfMeshes::instances(const Value& node) const {
  const std::optional<Value> extension = GltfFile::extension(node, "EXT_mesh_gpu_instancing");
  if (!extension) return {glm::dmat4(1.0)};
  if (!extension->has("attributes") || !extension->at("attributes").json.is_object())
    extension->fail("an object with attributes");
  const Value attributes = extension->at("attributes");
  std::optional<std::size_t> count;
  const auto read = [&](const char* name, std::string_view type) -> std::optional<GltfNumbers> {
    if (!attributes.has(name)) return std::nullopt;
    const std::size_t accessor = file_->indexOf(attributes.at(name), "accessors");
    if (!file_->at("accessors", accessor).has("bufferView")) attributes.at(name).fail("an accessor with a bufferView");
    GltfNumbers numbers = file_->numbers(accessor, type);
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
GltfNumbers GltfMeshes::attribute(const Value& attributes, const std::string& name, std::string_view types,
                                  std::size_t count) const {
  if (!attributes.has(name)) return {};
  const std::size_t accessor = file_->indexOf(attributes.at(name), "accessors");
  GltfNumbers numbers = file_->numbers(accessor, types);
  if (count > 0 && numbers.count != count)
    throwBadInput("{}: {}.{}: accessor {} holds {} elements, the mesh has {} vertices", file_->path().string(),
                  attributes.key, name, accessor, numbers.count, count);
  return numbers;
}

GltfVertices GltfMeshes::verticesOf(const Value& primitive, const GltfCorners& corners,
                                    const std::vector<double>& weights, unsigned texCoords) const {
  GltfVertices vertices;
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

std::vector<bool> GltfMeshes::skin(GltfVertices& vertices, std::size_t index, const Value& primitive,
                                   const GltfCorners& corners) const {
  const Value node = file_->at("nodes", index);
  const Value skin = file_->at("skins", file_->indexOf(node.at("skin"), "skins"));
  if (!skin.json.is_object() || !skin.has("joints") || !skin.at("joints").json.is_array() ||
      skin.at("joints").json.empty())
    skin.fail("an object with an array of joints");
  std::vector<glm::dmat4> worldFromMesh;
  for (std::size_t j = 0; j < skin.at("joints").json.size(); ++j)
    worldFromMesh.push_back(worldFromNode_[file_->indexOf(skin.at("joints").at(j), "nodes")]);
  if (skin.has("inverseBindMatrices")) {
    const GltfNumbers inverse = file_->numbers(file_->indexOf(skin.at("inverseBindMatrices"), "accessors"), "MAT4");
    if (inverse.count < worldFromMesh.size())
      throwBadInput("{}: {}: {} inverseBindMatrices of {} joints", file_->path().string(), skin.key, inverse.count,
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
        if (!std::isfinite(weight))
          throwBadInput("{}: {}: vertex {} has no finite weight in WEIGHTS_{}", file_->path().string(), attributes.key,
                        corners.used[i], set);
        if (!(weight > 0.0)) continue;
        if (!(joint >= 0.0 && joint < static_cast<double>(worldFromMesh.size())))
          throwBadInput("{}: {}: vertex {} names joint {}, the skin has {}", file_->path().string(), attributes.key,
                        corners.used[i], joint, worldFromMesh.size());
        matrices[i] += weight * worldFromMesh[static_cast<std::size_t>(joint)];
        sums[i] += weight;
      }
  }
  std::vector<bool> mirrored(count, false);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dmat4 m = sums[i] > 0.0 ? matrices[i] / sums[i] : worldFromNode_[index];  // no joint moves it
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

GltfCorners GltfMeshes::cornersOf(const Value& primitive) {
  GltfCorners corners;
  const GltfNumbers positions = attribute(primitive.at("attributes"), "POSITION", "VEC3", 0);
  if (positions.count == 0) {
    ++withoutPositions;
    return corners;
  }
  corners.there = positions.count;
  constexpr std::size_t kTriangles = 4, kFan = 6;  // between them: strips
  const std::size_t mode = primitive.has("mode") ? wholeNumber(primitive, "mode") : kTriangles;
  if (mode > kFan) primitive.at("mode").fail("a number from 0 to 6");
  if (mode < kTriangles) {
    ++notDrawn;
    return corners;
  }
  std::vector<std::uint32_t> indices;
  if (primitive.has("indices")) {
    indices = file_->indices(file_->indexOf(primitive.at("indices"), "accessors"));
    for (std::size_t i = 0; i < indices.size(); ++i)
      if (indices[i] >= corners.there)
        throwBadInput("{}: {}: index {} refers to vertex {}, the mesh holds {}", file_->path().string(), primitive.key,
                      i, indices[i], corners.there);
  } else {
    indices.resize(corners.there);
    std::iota(indices.begin(), indices.end(), 0u);
  }
  if (mode == kTriangles) {
    leftOverIndices += indices.size() % 3;
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

MeshData GltfMeshes::dataOf(const GltfVertices& vertices, const GltfTriangles& triangles,
                            const TextureTransform& transform) {
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

GltfShape GltfMeshes::shapeOf(std::size_t index, const Value& primitive, const TextureTransform& transform) {
  GltfShape shape;
  shape.corners = cornersOf(primitive);
  if (shape.corners.triangles.empty()) return shape;
  shape.vertices = verticesOf(primitive, shape.corners, weightsOf(index), transform.texCoord);
  GltfTriangles& triangles = shape.corners.triangles;
  if (isSkinned(file_->at("nodes", index), primitive)) {
    const std::vector<bool> mirrored = skin(shape.vertices, index, primitive, shape.corners);
    for (std::array<unsigned, 3>& t : triangles)
      if (mirrored[t[0]]) std::swap(t[1], t[2]);
  }
  shape.data = dataOf(shape.vertices, triangles, transform);
  return shape;
}

}  // namespace lucerna
