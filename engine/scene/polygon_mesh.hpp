// Meshes of polygons as readers of files give them, and how they enter a scene (no GL; private to engine/scene).
#pragma once

#include "scene/model_parts.hpp"

#include <span>
#include <string>
#include <vector>

namespace lucerna {

struct PolygonMesh {
  std::string name;
  int material = 0;  ///< index into Scene::materials
  std::vector<glm::dvec3> positions;  ///< of its vertices, as in the file
  std::vector<glm::vec3> normals, colours;  ///< each empty or one a vertex; a normal of 0 is made; colours are linear
  std::vector<glm::vec2> texCoords;  ///< the same; (0, 0) is the lower left corner of a picture
  std::vector<unsigned> corners;  ///< vertices of all faces, one face after another
  std::vector<std::size_t> ends;  ///< of each face among the corners; every face has at least three

  void endFace() { ends.push_back(corners.size()); }
};

/// The albedo of surfaces to which a file gives no material, and no highlight.
inline constexpr float kDefaultAlbedo = 0.6f;

/// Appends the triangles of the meshes.
/// - Coordinates far from the origin, as maps have them, lose their detail in single precision. Then an offset is taken
///   off in double (Scene::origin), and one warning says which.
/// - Normals that are missing are made: those of the faces around a corner, weighted by their angles [Thuermer1998], as
///   far as they stand within 60 degrees of the corner's own face.
/// - Vertex colours multiply the material's diffuse colour: exactly, by a small picture of them; where the material has
///   pictures of its own by their mean, with a warning.
void appendPolygons(Scene& scene, std::vector<PolygonMesh> meshes);

}  // namespace lucerna
