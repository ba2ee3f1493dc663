#include "scene/motion.hpp"

#include "base/error.hpp"
#include "scene/curve.hpp"
#include "scene/main_bounds.hpp"

#include <fmt/ranges.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <set>
#include <utility>

namespace lucerna {

namespace {

bool isSame(const DirectionalLight& a, const DirectionalLight& b) {
  return a.direction == b.direction && a.irradiance == b.irradiance && a.angularDiameter == b.angularDiameter;
}
bool isSame(const SpotLight& a, const SpotLight& b) {
  return a.position == b.position && a.direction == b.direction && a.intensity == b.intensity &&
         a.innerAngle == b.innerAngle && a.outerAngle == b.outerAngle && a.radius == b.radius;
}
bool isSame(const PointLight& a, const PointLight& b) {
  return a.position == b.position && a.intensity == b.intensity && a.radius == b.radius;
}
bool isSame(const Material& a, const Material& b) {
  return a.bsdf == b.bsdf && a.roughness == b.roughness && a.ior == b.ior && a.interior == b.interior &&
         a.diffuse == b.diffuse && a.specular == b.specular && a.emission == b.emission &&
         a.emissionScale == b.emissionScale;
}
bool isSame(const Medium& a, const Medium& b) {
  return a.scattering == b.scattering && a.absorption == b.absorption && a.anisotropy == b.anisotropy &&
         a.emission == b.emission && a.phase == b.phase;  // grids do not move
}
bool isSame(const Environment& a, const Environment& b) {
  return a.radiance == b.radiance && a.rotation == b.rotation && a.picture.has_value() == b.picture.has_value() &&
         (!a.picture || a.picture->pixels == b.picture->pixels);
}
template <class T>
bool isSame(const std::vector<T>& a, const std::vector<T>& b) {
  return std::ranges::equal(a, b, [](const T& x, const T& y) { return isSame(x, y); });
}
template <class T>
bool isSame(const std::optional<T>& a, const std::optional<T>& b) {
  return a.has_value() == b.has_value() && (!a || isSame(*a, *b));
}

bool isFiniteVertex(const Vertex& v) {
  return std::isfinite(v.position.x) && std::isfinite(v.position.y) && std::isfinite(v.position.z);
}

/// Poses meshes and returns those whose vertices are others than before.
std::vector<std::size_t> poseMeshes(Scene& scene, double seconds) {
  const SceneMotion& motion = *scene.motion;
  std::vector<std::vector<Vertex>> before;
  for (const std::size_t index : motion.meshes) {
    const Mesh& mesh = scene.meshes[index];
    std::copy_n(motion.restIndices.begin() + mesh.firstIndex, mesh.indexCount, scene.indices.begin() + mesh.firstIndex);
    const VertexRange range = vertexRange(scene, mesh);
    const auto from = scene.vertices.begin() + range.first;
    before.emplace_back(from, from + range.count);
    std::copy_n(motion.restVertices.begin() + range.first, range.count, from);
  }
  for (const SceneMotion::Part part : {SceneMotion::Part::meshes, SceneMotion::Part::objects})
    if (motion[part]) motion[part](scene, seconds);
  for (const SceneMotion::Move& move : motion.moves)
    for (const std::size_t mesh : move.meshes)
      transformMesh(scene, scene.meshes[mesh], glm::translate(glm::dmat4(1.0), move.offset(seconds)));
  std::vector<std::size_t> changed;
  for (std::size_t k = 0; k < motion.meshes.size(); ++k) {
    const Mesh& mesh = scene.meshes[motion.meshes[k]];
    const VertexRange range = vertexRange(scene, mesh);
    if (std::memcmp(before[k].data(), &scene.vertices[range.first], range.count * sizeof(Vertex)) == 0) continue;
    changed.push_back(motion.meshes[k]);
    updateBounds(scene, motion.meshes[k]);
  }
  if (motion.meshes.empty()) return changed;
  scene.bounds = motion.bounds;
  for (const Mesh& mesh : scene.meshes) scene.bounds.add(mesh.bounds);
  return changed;
}

}  // namespace

void SceneChange::add(const SceneChange& next) {
  const std::vector<std::size_t> before = std::move(meshes);
  meshes.clear();
  std::ranges::set_union(before, next.meshes, std::back_inserter(meshes));
  sun = sun || next.sun;
  lamps = lamps || next.lamps;
  materials = materials || next.materials;
  media = media || next.media;
  environment = environment || next.environment;
  views = views || next.views;
}

VertexRange vertexRange(const Scene& scene, const Mesh& mesh) {
  std::uint32_t low = ~0u, high = 0;
  for (std::uint32_t i = mesh.firstIndex; i < mesh.firstIndex + mesh.indexCount; ++i) {
    low = std::min(low, scene.indices[i]);
    high = std::max(high, scene.indices[i] + 1);
  }
  return low < high ? VertexRange{low, high - low} : VertexRange{};
}

void turnFaces(Scene& scene, const Mesh& mesh) {
  for (std::uint32_t i = mesh.firstIndex; i < mesh.firstIndex + mesh.indexCount; i += 3)
    std::swap(scene.indices[i + 1], scene.indices[i + 2]);
}

void transformMesh(Scene& scene, const Mesh& mesh, const glm::dmat4& matrix) {
  const glm::dmat3 linear(matrix);
  // As in model_mesh.cpp: the inverse transpose times the determinant.
  const bool mirrored = glm::determinant(linear) < 0.0;
  const glm::dmat3 cofactor =
      glm::dmat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1])) *
      (mirrored ? -1.0 : 1.0);
  const VertexRange range = vertexRange(scene, mesh);
  for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
    Vertex& vertex = scene.vertices[i];
    vertex.position = glm::vec3(matrix * glm::dvec4(vertex.position, 1.0));
    const glm::dvec3 normal = cofactor * glm::dvec3(vertex.normal);
    if (const double length = glm::length(normal); std::isfinite(length) && length > 0.0)
      vertex.normal = glm::vec3(normal / length);
  }
  if (mirrored) turnFaces(scene, mesh);
}

SceneMotion& motionOf(Scene& scene) {
  if (!scene.motion) scene.motion = std::make_shared<SceneMotion>();
  return *scene.motion;
}

void addMoves(Scene& scene, const std::vector<KeyFrameMove>& moves, const std::filesystem::path& file) {
  if (moves.empty()) return;
  SceneMotion& motion = motionOf(scene);
  for (const KeyFrameMove& keys : moves) {
    std::erase_if(motion.moves, [&](const SceneMotion::Move& other) { return other.name == keys.name; });
    SceneMotion::Move move{keys.name, {}, {}, {}, {}};
    const auto find = [&](const auto& things, std::vector<std::size_t>& found) {
      for (std::size_t i = 0; i < things.size(); ++i)
        if (things[i].name == keys.name) found.push_back(i);
    };
    find(scene.meshes, move.meshes);
    find(scene.spots, move.spots);
    find(scene.points, move.points);
    if (move.meshes.empty() && move.spots.empty() && move.points.empty()) {
      constexpr std::size_t kMost = 12;
      std::set<std::string> names;
      const auto list = [&](const auto& things) {
        for (const auto& thing : things)
          if (!thing.name.empty() && names.size() < kMost) names.insert(fmt::format("'{}'", thing.name));
      };
      list(scene.spots), list(scene.points), list(scene.meshes);
      throwBadInput("{}:{}: no mesh and no lamp of the scene is named '{}'; there are {}{}", file.string(), keys.line,
                    keys.name, fmt::join(names, ", "), names.size() < kMost ? "" : ", ...");
    }
    Curve curve;
    curve.interpolation = Curve::Interpolation::cubic;
    curve.width = 3;
    curve.times = keys.times;
    for (const glm::dvec3& offset : keys.offsets)
      curve.values.insert(curve.values.end(), {offset.x, offset.y, offset.z});
    move.offset = [curve = std::move(curve)](double seconds) {
      std::array<double, 3> value{};
      curve.at(seconds, value);
      return glm::dvec3(value[0], value[1], value[2]);
    };
    motion.end = std::max(motion.end, keys.times.back());
    motion.names.push_back(keys.name);
    motion.moves.push_back(std::move(move));
  }
}

void finishMotion(Scene& scene) {
  if (!scene.motion) return findMainBounds(scene);
  SceneMotion& motion = *scene.motion;
  if (!motion.restVertices.empty()) {
    scene.vertices = motion.restVertices;
    scene.indices = motion.restIndices;
    scene.spots = motion.restSpots;
    scene.points = motion.restPoints;
  }
  for (const SceneMotion::Move& move : motion.moves)
    motion.meshes.insert(motion.meshes.end(), move.meshes.begin(), move.meshes.end());
  std::ranges::sort(motion.meshes);
  motion.meshes.erase(std::unique(motion.meshes.begin(), motion.meshes.end()), motion.meshes.end());
  motion.restVertices = scene.vertices;
  motion.restIndices = scene.indices;
  motion.restSpots = scene.spots;
  motion.restPoints = scene.points;
  motion.bounds = scene.bounds;
  std::vector<SweptBounds> swept;
  for (const Mesh& mesh : scene.meshes) swept.push_back({mesh.bounds, mesh.bounds});
  constexpr int kTimes = 64;
  if (!motion.meshes.empty())
    for (int k = 0; k <= kTimes; ++k) {
      poseMeshes(scene, motion.end * k / kTimes);
      motion.bounds.add(scene.bounds);
      for (std::size_t m = 0; m < swept.size(); ++m) swept[m].swept.add(scene.meshes[m].bounds);
    }
  scene.mainBounds = boundsWithoutFarMeshes(swept, scene.cameras);
  poseAt(scene, 0.0);
}

void updateBounds(Scene& scene, std::size_t index) {
  Mesh& mesh = scene.meshes[index];
  mesh.bounds = {};
  const VertexRange range = vertexRange(scene, mesh);
  for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
    if (!isFiniteVertex(scene.vertices[i]))
      throwBadInput("{}: mesh '{}' at {:g} s: a position is not finite (up to 3.4e38)", scene.file.string(), mesh.name,
                    scene.time);
    mesh.bounds.add(glm::dvec3(scene.vertices[i].position));
  }
}

SceneChange poseAt(Scene& scene, double seconds) {
  SceneChange change;
  scene.time = seconds;
  if (!scene.motion) return change;
  const SceneMotion& motion = *scene.motion;
  change.meshes = poseMeshes(scene, seconds);
  /// Poses a part and tells whether that changed what it moves.
  const auto pose = [&](SceneMotion::Part part, const auto& moved) {
    if (!motion[part]) return false;
    const auto before = moved;
    motion[part](scene, seconds);
    return !isSame(before, moved);
  };
  using Part = SceneMotion::Part;
  change.sun = pose(Part::sun, scene.sun);
  /// Lamps, some of which are carried from where their part has placed them, or from where they were loaded.
  const auto poseLamps = [&](Part part, auto& lamps, const auto& rest, auto carried) {
    const auto before = lamps;
    for (const SceneMotion::Move& move : motion.moves)
      for (const std::size_t i : move.*carried) lamps[i].position = rest[i].position;
    if (motion[part]) motion[part](scene, seconds);
    for (const SceneMotion::Move& move : motion.moves)
      for (const std::size_t i : move.*carried) lamps[i].position += move.offset(seconds);
    return !isSame(before, lamps);
  };
  change.lamps = poseLamps(Part::spots, scene.spots, motion.restSpots, &SceneMotion::Move::spots);
  change.lamps = poseLamps(Part::points, scene.points, motion.restPoints, &SceneMotion::Move::points) || change.lamps;
  const std::vector<Material> materials = motion[Part::media] ? scene.materials : std::vector<Material>{};
  change.media = pose(Part::media, scene.media);
  change.materials = motion[Part::media] && !isSame(materials, scene.materials);
  change.environment = pose(Part::environment, scene.environment);
  if (motion[Part::views]) {
    const glm::vec3 background = scene.background;
    motion[Part::views](scene, seconds);
    change.views = true;
    change.environment = change.environment || scene.background != background;
  }
  return change;
}

}  // namespace lucerna
