// Intermediate results drawn in the scene: the light in a propagation volume's cells as lobes, the cells that block
// light as boxes, cache records as disks, the boxes of a level of the hierarchy for rays.
#pragma once

#include "gl/lines.hpp"
#include "rays/bvh.hpp"
#include "render/renderer.hpp"

#include <array>
#include <string_view>
#include <vector>

namespace lucerna::demo {

/// The views that are drawn in the scene as lines.
enum class Glyphs { none, lobes, geometry, records, boxes };
constexpr std::array<std::string_view, 5> kGlyphNames{"nothing", "lobes of cells", "geometry volume", "cache records",
                                                      "boxes of the hierarchy"};

/// Lines relative to the renderer's origin(), empty if its technique has nothing of the kind, and for boxes. Lobes show
/// intensity by direction in the `most` brightest cells of a cascade; the largest is half a cell long. Records show at
/// most `most` of a cascade's records that are in the picture, as disks on their surfaces in the colour of their
/// irradiance; the choice stays the same while the camera moves. Reads textures back, so it waits for the GPU.
std::vector<gl::Lines::Line> glyphsOf(Glyphs glyphs, const Renderer& renderer, const Scene& scene, const Camera& camera,
                                      int cascade, int most);

/// The `most` largest boxes of a level of a hierarchy (0: the root's children), relative to `origin`: nodes amber,
/// leaves green.
std::vector<gl::Lines::Line> boxesOf(const Bvh& bvh, const glm::dvec3& origin, int level, int most);

}  // namespace lucerna::demo
