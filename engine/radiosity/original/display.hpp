// The original's third program: a triangle file drawn, each triangle in one colour [RAD2008 section 3.8].
//
// Shows e + b [RAD2008 eq 3-1], mapped to 0..255 by a logarithm as published, by a constant factor (for comparison), by
// the engine's filmic curve, as false colours, or as the 24-bit colours of the computation. Colours are chosen on the
// CPU, one per triangle.
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

struct RadDisplay {
  RadMapping mapping = RadMapping::logarithmic;
  double constant = 0.0;  ///< linear and filmic: factor on values, 1 is white; 0: exposureOf()
  bool backCorners = false;  ///< show back-facing triangles by their corners; else not at all
  bool mesh = false;  ///< edges over the faces
};

/// The factor that maps the 99th percentile (by area) of received radiosity to white: sources are orders of magnitude
/// above it. 1 if nothing is received.
double exposureOf(std::span<const RadTriangle> triangles);

/// Colours as displayed (sRGB), 0..1, one per triangle. Pure. The logarithm is log(1 + v) / log(1 + the greatest v).
std::vector<glm::vec3> displayColours(std::span<const RadTriangle> triangles, const RadDisplay& display);

/// From above one corner into the scene, all of it in view.
Camera overviewOf(std::span<const RadTriangle> triangles);

/// Of the corners' bounds.
double diagonalOf(std::span<const RadTriangle> triangles);

class RadView {
 public:
  RadView(gl::ProgramLibrary& programs, glm::ivec2 size);
  void show(std::span<const RadTriangle> triangles, const RadDisplay& display);
  void record(const Camera& camera) const;
  Bitmap read() const;
  const gl::Framebuffer& framebuffer() const { return framebuffer_; }
  std::size_t gpuBytes() const { return vertices_.bytes() + color_.bytes() + depth_.bytes(); }

 private:
  const gl::Program* program_;
  gl::Buffer vertices_;
  gl::VertexArray vertexArray_;
  gl::Texture color_, depth_;
  gl::Framebuffer framebuffer_;
  RadDisplay display_;
  GLsizei count_ = 0;
  double extent_ = 1.0;
};

}  // namespace lucerna
