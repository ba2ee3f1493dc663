// The studio in which models without light of their own are shown, the same by every command: a view that we choose, a
// sun over its right shoulder, a grey floor that receives shadows, and a sky that begins in the floor's own colour, so
// that no horizon is seen (no GL).
//
// Sun and floor are fixed, and the exposure belongs to their light (incident-light metering): white is just below
// white and black stays black, whatever fills the picture.
#pragma once

#include "scene/scene.hpp"

namespace lucerna {

constexpr float kFloorAlbedo = 0.4f;

/// A view of all vertices as they are, from a direction that shows three sides, or into an open box through its
/// opening: they fill `kStudioFill` of a 16:9 picture's height or width. A closed room with light of its own, whose
/// walls face inwards, is seen from within. Bounds must be those of the vertices.
Camera studioView(const Scene& scene);
constexpr double kStudioFill = 2.0 / 3.0;

/// Along which the sun's light travels for a view: over the right shoulder, so that all visible sides of a box are lit.
glm::dvec3 studioSun(const Camera& camera);

/// Latitude-longitude picture of radiance for such a sun: below the horizon that of the unshadowed floor, above it
/// smoothly half of that in the zenith. The floor is lit by sun and sky, which is lit by the floor, in closed form.
Image studioSky(const DirectionalLight& sun, int height = 128);

/// Share of the sun in the light of the unshadowed floor; the rest is the sky's.
glm::vec3 studioSunShare();

/// Whether what emits is outside of everything, as pilot lamps of a model are: the middle of the scene is not enclosed,
/// and less than a third of the emitted light meets a surface.
bool glowsOutwards(const Scene& scene);

/// A horizontal disc just below the scene's lowest point. Changes vertices, meshes, materials and bounds, also those of
/// its motion. Comes last: exposures depend on the bounds.
void addFloor(Scene& scene);

}  // namespace lucerna
