// The original's third program: draws a triangle file, each triangle in one colour [RAD2008 section 3.8], with colours
// interpolated between corners, or with pictures on the triangles [RAD2008 chapter 4].
//
// Shows e + b [RAD2008 eq 3-1], mapped to 0..255 by a logarithm as published, by a constant factor (for comparison), by
// the engine's filmic curve, as false colours, or as the 24-bit colours of the computation. Colours are chosen on the
// CPU, one per triangle or corner.
#pragma once

#include "base/image.hpp"
#include "base/named_values.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "radiosity/original/rad_file.hpp"
#include "scene/scene.hpp"

#include <glm/glm.hpp>

#include <span>
#include <string_view>
#include <vector>

namespace lucerna {

enum class RadMapping { logarithmic, linear, filmic, falseColours, bits24 };
constexpr std::array<std::string_view, 5> namesOf(RadMapping) { return {"log", "linear", "filmic", "false", "bits"}; }

/// flat: one colour per triangle. acrossEdges: a corner has the mean colour of all triangles that meet there, as
/// published; light bleeds over edges [RAD2008 figure 4.2b]. withinFaces: the area-weighted mean value of those that
/// face the same way.
enum class RadShading { flat, acrossEdges, withinFaces };
constexpr std::array<std::string_view, 3> namesOf(RadShading) { return {"flat", "across-edges", "within-faces"}; }

struct RadDisplay {
  RadMapping mapping = RadMapping::logarithmic;
  RadShading shading = RadShading::flat;  ///< other modes not with bits24, whose packed numbers have no mean
  double constant = 0.0;  ///< linear and filmic: factor on values, 1 is white; 0: exposureOf()
  bool backCorners = false;  ///< show back-facing triangles by their corners; else not at all
  bool mesh = false;  ///< edges over the faces
};

/// The factor that maps the 99th percentile (by area) of received radiosity to white: sources are orders of magnitude
/// above it. 1 if nothing is received.
double exposureOf(std::span<const RadTriangle> triangles);

/// Whether no triangle has received light, as in a file that no solver has written: only sources are bright.
bool isUnsolved(std::span<const RadTriangle> triangles);

/// The value that the logarithm shows as black: half of the value reached by 99 % of the lit area. 1 if nothing is lit.
double blackOf(std::span<const RadTriangle> triangles);

/// Colours as displayed (sRGB), 0..1, one per triangle. Pure. The logarithm is log(v / blackOf()) over that of the
/// greatest v.
std::vector<glm::vec3> displayColours(std::span<const RadTriangle> triangles, const RadDisplay& display);

/// The same for each triangle's corners p1, p2, p3. Corners meet where all three coordinates are equal.
std::vector<std::array<glm::vec3, 3>> cornerColours(std::span<const RadTriangle> triangles, const RadDisplay& display);

/// Pictures on the triangles; the displayed value is their texel times the colour, in display values [RAD2008 figure
/// 4.3].
struct RadTextures {
  std::vector<const Texture*> pictures;
  std::vector<int> ofTriangle;  ///< index into `pictures`, -1: none; one per triangle
  std::vector<std::array<glm::vec2, 3>> texCoords;  ///< of its corners, v = 0 is the bottom row
};

/// The pictures of the scene that `triangles` were generated from (radTrianglesOf, with the same longestEdge). Throws
/// Error(badInput) naming `file` if it holds other triangles.
RadTextures texturesOf(const Scene& scene, double longestEdge, std::span<const RadTriangle> triangles,
                       const std::string& file);

/// A view from above one corner into the scene, with all of it visible.
Camera overviewOf(std::span<const RadTriangle> triangles);

/// Diagonal of the corners' bounds.
double diagonalOf(std::span<const RadTriangle> triangles);

class RadView {
 public:
  RadView(gl::ProgramLibrary& programs, glm::ivec2 size);
  void show(std::span<const RadTriangle> triangles, const RadDisplay& display, const RadTextures& textures = {});
  void record(const Camera& camera) const;
  Bitmap read() const;
  const gl::Framebuffer& framebuffer() const { return framebuffer_; }

 private:
  struct Part {  ///< triangles of one picture, or of none
    int texture = -1;
    std::uint32_t firstIndex = 0, indexCount = 0;
  };

  gl::ProgramLibrary& programs_;
  const gl::Program* program_;
  const gl::Program* textured_ = nullptr;  ///< only if there is a picture
  gl::Buffer vertices_, indices_;
  gl::VertexArray vertexArray_;
  gl::Texture color_, depth_;
  gl::Framebuffer framebuffer_;
  std::vector<gl::Texture> textures_;
  std::vector<Part> parts_;
  RadDisplay display_;
  double extent_ = 1.0;
};

}  // namespace lucerna
