// What a spot or an omnidirectional light sees (no GL, pure): the perspective views of its shadow map and its reflective shadow map.
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <vector>

namespace lucerna {

/// A light in one point: one view of a spot, the six faces of a cube map in OpenGL's order (+x, -x, +y, -y, +z, -z) of an
/// omnidirectional light. Both planes follow the scene: far just behind its farthest corner, near at 1/2000 of that; what is
/// nearer must be drawn with depth clamp, so that it casts its shadow all the same.
struct LightViews {
  glm::dvec3 position{0.0};
  glm::vec3 intensity{0.0f};               ///< W/sr, of a spot on its axis
  glm::dvec3 direction{0.0, 0.0, -1.0};    ///< a spot's axis
  double cosInner = -1.0, cosOuter = -1.0; ///< of a spot's half angles
  std::vector<glm::dmat4> clipFromWorld;   ///< 1 or 6
  double tangent = 1.0;                    ///< of half the opening angle of each view
  double near = 0.0, far = 1.0;
  std::size_t index = 0;                   ///< in the scene's list of its kind

  /// Where the light is in float, and a view's matrix for positions relative to there: rounded by what the light sees, not by where it stands.
  glm::vec3 place() const { return glm::vec3(position); }
  glm::mat4 clipFromPlace(std::size_t view) const;
  bool omnidirectional() const { return clipFromWorld.size() == 6; }
  /// Width of a texel at depth 1 along the view's axis, for a map of size x size texels a view.
  double texelWidth(int size) const { return 2.0 * tangent / size; }
  /// Upper bound of the sum of the texels' solid angles in shaders/rsm/rsm.frag, all views together, sr; tends to the views' own.
  double largestSolidAngle(int size) const;
};

LightViews lightViews(const SpotLight& light, const Bounds& scene);
LightViews lightViews(const PointLight& light, const Bounds& scene);

/// The views of the spots and of the omnidirectional lights of a scene, those with intensity > 0 alone.
std::vector<LightViews> spotViews(const Scene& scene);
std::vector<LightViews> pointViews(const Scene& scene);

/// The irradiance that a scene's lights typically make, the largest of all lights and channels: of the sun its own, of the others
/// I / r^2 with r a quarter of the scene's diagonal. Finite and above 0 (1 without lights). It is a unit in which to store light, no result.
float typicalIrradiance(const Scene& scene);

}  // namespace lucerna
