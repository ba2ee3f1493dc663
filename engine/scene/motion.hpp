// What of a scene changes over time, and the scene at a time (no GL).
//
// Time is in seconds; files are loaded as they are at time 0. What moves is given by curves in the scene's JSON
// (scene_file.cpp), by animations of glTF files (gltf_animations.cpp) and by key frames of what is carried. The pose at
// a time depends on that time alone, not on the poses before.
#pragma once

#include "scene/key_frames.hpp"
#include "scene/scene.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace lucerna {

/// What differs between two times.
struct SceneChange {
  std::vector<std::size_t> meshes;  ///< whose vertices are others, rising
  bool sun = false, lamps = false, materials = false, media = false;
  bool environment = false;  ///< or the background
  bool views = false;  ///< cameras, exposure

  bool anyLight() const { return sun || lamps || environment; }
  bool any() const { return !meshes.empty() || anyLight() || materials || media || views; }
  void add(const SceneChange& next);
};

struct SceneMotion {
  /// Parts of a scene, in the order in which they are posed.
  enum class Part { meshes, objects, sun, spots, points, media, environment, views, count };
  /// Sets its part of the scene as it is at a time; a part that nothing moves has none. Meshes are as loaded before.
  using Pose = std::function<void(Scene& scene, double seconds)>;

  /// What is carried, after curves and animations have placed it.
  struct Move {
    std::string name;
    std::function<glm::dvec3(double seconds)> offset;
    std::vector<std::size_t> meshes, spots, points;
  };

  std::array<Pose, static_cast<std::size_t>(Part::count)> parts;
  std::vector<Move> moves;  ///< one a name
  double end = 0.0;  ///< of the last key, seconds
  std::vector<std::string> names;  ///< of what moves, for people
  Bounds bounds;  ///< of the scene at 64 times from 0 to `end`
  std::vector<Vertex> restVertices;  ///< the scene's as loaded
  std::vector<std::uint32_t> restIndices;
  std::vector<SpotLight> restSpots;
  std::vector<PointLight> restPoints;
  std::vector<std::size_t> meshes;  ///< that move, rising

  Pose& operator[](Part part) { return parts[static_cast<std::size_t>(part)]; }
  const Pose& operator[](Part part) const { return parts[static_cast<std::size_t>(part)]; }
};

/// A mesh's vertices. Readers give each mesh vertices of its own, one after another.
struct VertexRange {
  std::uint32_t first = 0, count = 0;
};
VertexRange vertexRange(const Scene& scene, const Mesh& mesh);

/// Moves a mesh's vertices and turns its normals; a mirrored one keeps the sides of its faces. A matrix that flattens
/// keeps the normals that it cannot turn.
void transformMesh(Scene& scene, const Mesh& mesh, const glm::dmat4& matrix);

/// Turns a mesh's faces over.
void turnFaces(Scene& scene, const Mesh& mesh);

/// What the bounds of a mesh are now. Throws Error(badInput) naming file, mesh and the scene's time if a position is
/// not finite.
void updateBounds(Scene& scene, std::size_t mesh);

/// The motion of a scene that is being loaded, made if there is none yet.
SceneMotion& motionOf(Scene& scene);

/// Moves meshes and lamps by their names, instead of other keys of the same name; finishMotion() comes next. Throws
/// Error(badInput) naming `file` and line if nothing has a name.
void addMoves(Scene& scene, const std::vector<KeyFrameMove>& moves, const std::filesystem::path& file);

/// Ends loading, also once more after a change of the motion: notes what is at rest, and the bounds. The scene is then
/// as at time 0.
void finishMotion(Scene& scene);

/// Poses a scene as it is at a time. Bounds hold the scene at that time and those of the motion, so that they do not
/// change from frame to frame. Throws Error(badInput) naming file, mesh and time if a position is not finite.
SceneChange poseAt(Scene& scene, double seconds);

/// A scene as it is at a time.
Scene loadScene(const std::filesystem::path& file, double seconds);

}  // namespace lucerna
