// The perspective views of a spot or omnidirectional light (no GL, pure), for its shadow map and reflective shadow map.
#pragma once

#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <vector>

namespace lucerna {

/// A point-like light: one view for a spot, the six faces of a cube map in OpenGL's order (+x, -x, +y, -y, +z, -z) for
/// an omnidirectional light. Both planes follow the scene: far just behind its farthest corner, near at 1/2000 of that.
/// Nearer geometry must be drawn with depth clamp, so that it still casts its shadow.
struct LightViews {
  glm::dvec3 position{0.0};
  glm::vec3 intensity{0.0f};  ///< W/sr; for a spot, on its axis
  double radius = 0.0;  ///< of its ball
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< a spot's axis
  double cosInner = -1.0, cosOuter = -1.0;  ///< of a spot's half angles
  std::vector<glm::dmat4> clipFromWorld;  ///< one or six matrices
  double tangent = 1.0;  ///< of half the opening angle of each view
  double near = 0.0, far = 1.0;
  std::size_t index = 0;  ///< in the scene's list of lights of its kind
  bool isPoint = false;  ///< an omnidirectional light, even if one view holds the scene

  /// The light's position in float, and a view's matrix for positions relative to it. Rounding then depends on the
  /// scene around the light, not on the light's position.
  glm::vec3 place() const { return glm::vec3(position); }
  glm::mat4 clipFromPlace(std::size_t view) const;
  bool omnidirectional() const { return clipFromWorld.size() == 6; }
  /// Width of a texel at depth 1 along the view's axis, for a map of size x size texels per view.
  double texelWidth(int size) const { return 2.0 * tangent / size; }
  /// Upper bound of the sum of the texels' solid angles in shaders/rsm/rsm.frag, over all views, sr; converges to the
  /// views' solid angle.
  double largestSolidAngle(int size) const;
};

LightViews lightViews(const SpotLight& light, const Scene& scene);
LightViews lightViews(const PointLight& light, const Scene& scene);

/// The views of a scene's spots and omnidirectional lights, only those with intensity > 0. An omnidirectional light
/// well outside of the scene is among the first: one view holds all of the scene, which would be few texels of a cube's
/// face.
std::vector<LightViews> spotViews(const Scene& scene);
std::vector<LightViews> pointViews(const Scene& scene);

/// Typical irradiance from a scene's lights, the largest of all lights and channels: the sun's own; for the others I /
/// r^2 with r a quarter of the scene's diagonal. Finite and above 0 (1 without lights). Storage normalisation only;
/// does not affect the result.
float typicalIrradiance(const Scene& scene);

}  // namespace lucerna
