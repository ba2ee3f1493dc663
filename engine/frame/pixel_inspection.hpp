// What lit a pixel: the answer to a query about one pixel of a frame (no GL calls).
//
// Renderer::inspect draws that pixel again with shaders that record each term (flag INSPECTED), and asks the
// technique's own lookup for the texels, cells, records or patches it used. Frames without a query compile, allocate
// and compute none of this.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// One source of the pixel's light, or several of a kind combined.
struct PixelShare {
  std::string group;  ///< emission, direct, indirect, scattered twice, ...
  std::string name;  ///< "sun", "texel 17, 40 of the sun's map", ...
  glm::dvec3 radiance{0.0};
  std::vector<glm::dvec3> places;  ///< from the pixel's surface (a path: the camera) to the light, scene coordinates
  std::optional<double> weight;  ///< of a cell or record in the lookup; the form factor to a patch
  std::optional<std::array<glm::vec4, 3>> lobe;  ///< of a cell: coefficients of red, green and blue, as stored
  std::size_t count = 1;  ///< number of combined sources
};

struct PixelInspection {
  struct Surface {
    glm::dvec3 position{0.0}, normal{0.0}, albedo{0.0};
  };
  glm::ivec2 pixel{0};  ///< from the top left
  std::string technique;
  glm::dvec3 radiance{0.0};  ///< in the picture, linear, scene units
  std::optional<Surface> surface;  ///< the visible one; path tracing has none
  bool isFiltered = false;  ///< some shares were weighed by a filter of a 3D texture, with 8 bits
  std::vector<PixelShare> shares;  ///< brightest first; some are negative (cells with decreasing light)
  std::uint64_t samples = 0;  ///< for path tracing
  glm::dvec3 standardError{0.0};  ///< for path tracing, of `radiance`

  /// Adds a share; false, and nothing, where it is black.
  bool add(std::string group, std::string name, const glm::dvec3& radiance, std::vector<glm::dvec3> places = {});
  glm::dvec3 sum() const;
  /// Error(fault) where the shares do not add up to the pixel, but for half floats and the weights of filters.
  void checkSum() const;
  /// A share's part of the pixel, by luminance; 0 for a black pixel.
  double shareOf(const glm::dvec3& radiance) const;
  /// Radiance by group, brightest first.
  std::vector<std::pair<std::string, glm::dvec3>> groups() const;
  /// Sorts, and keeps the `most` brightest of each group; the others are combined by group and sign.
  void condense(std::size_t most);
};

}  // namespace lucerna
