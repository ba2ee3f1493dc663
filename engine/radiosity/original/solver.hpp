// The radiosity original: renders the scene from every triangle in five views, read back and summed on the CPU [RAD2008
// chapter 3].
//
// From a triangle's centroid five views of 90 degrees are drawn, each triangle in the colour whose red, green and blue
// bytes are the number e + b ro of its exitance [RAD2008 eq 3-2]. glReadPixels copies them to the CPU, which multiplies
// each pixel by a map (map.hpp) and sums: that is the triangle's received radiosity b. A sweep over all triangles is
// one iteration; the solution is done when a sweep changes nothing. Units: the file's (rad_file.hpp). Nothing is
// accelerated here; see the corrected solver.
#pragma once

#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "radiosity/original/map.hpp"
#include "radiosity/original/rad_file.hpp"
#include "radiosity/settings.hpp"

#include <glm/glm.hpp>

#include <functional>
#include <span>
#include <vector>

namespace lucerna {

/// Everything that a stopped run needs to resume.
struct OriginalProgress {
  std::vector<float> received;  ///< b of every triangle: at the sweep's start (Jacobi), now (Gauss-Seidel); 24-bit
                                ///< numbers are exact floats
  std::vector<float> next;  ///< b of the first `done` triangles after this sweep (Jacobi)
  std::size_t done = 0;  ///< triangles of the current sweep
  double change = 0.0;  ///< sum of |change of b| over them; after a whole sweep: the sweep's
  std::uint32_t sweeps = 0;  ///< complete ones
};

class OriginalRadiosity {
 public:
  struct Settings {
    int view = 500;  ///< pixels per side, 2 to 4096
    bool gaussSeidel = false;  ///< new values are used at once; otherwise from the next sweep on
    RadiosityDeviations deviations = publishedRadiosity();
    double nearPlane = 0.0;  ///< scene units; 0: 1e-4 of the scene's diagonal
    unsigned seed = 1;  ///< for the roll, if radiosity.fixed-orientation is off
  };

  /// `triangles` must have passed checkRadTriangles and must outlive this.
  OriginalRadiosity(gl::ProgramLibrary& programs, std::span<const RadTriangle> triangles, const Settings& settings);

  /// The file's state: its b, with no sweep begun.
  OriginalProgress start() const;

  /// Continues the sweep in `progress` to its end (true), or until `goOn`, called after every triangle, returns false
  /// (false).
  bool sweep(OriginalProgress& progress, const std::function<bool(const OriginalProgress&)>& goOn);

  /// A triangle's exitance when it receives `received`: the value of its pixels.
  float sentBy(std::size_t triangle, float received) const;
  /// Sets the values that gather() sees; sweep() does so itself.
  void setReceived(std::span<const float> received);
  /// The received radiosity of one triangle in the current scene.
  float gather(std::size_t triangle);
  /// The same from a point, towards `normal`, not rounded; `up` is any direction across the normal.
  double gatherAt(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& up);

  /// The triangles of the file with these values as b, rounded down.
  std::vector<RadTriangle> withReceived(std::span<const float> received) const;
  /// Absorbed over emitted flux, less 1: zero in a solved closed scene. NaN if nothing is emitted.
  double energyBalance(std::span<const float> received) const;

  const Settings& settings() const { return settings_; }
  double nearPlane() const { return near_; }
  std::size_t hemicubes() const { return hemicubes_; }  ///< drawn so far
  std::size_t drawnTriangles() const { return drawnTriangles_; }  ///< in all views so far
  std::size_t overflows() const { return overflows_; }  ///< exitances above 24 bits, whose upper bits were lost
  std::size_t gpuBytes() const { return vertices_.bytes() + color_.bytes() + depth_.bytes(); }

 private:
  void writeVertices(std::size_t triangle, float sent);
  double readAndSum(const std::vector<float>& map, int firstRow, int rows);

  Settings settings_;
  std::span<const RadTriangle> triangles_;
  MultiplierMap map_;
  const gl::Program* program_;
  gl::Buffer vertices_;
  gl::VertexArray vertexArray_;
  gl::Texture color_, depth_;
  gl::Framebuffer framebuffer_;
  std::vector<glm::vec4> corners_;  ///< three per triangle: position, exitance
  std::vector<std::uint8_t> bytes_;
  std::vector<float> floats_;
  double near_ = 0.0, far_ = 0.0;
  std::size_t hemicubes_ = 0, drawnTriangles_ = 0;
  mutable std::size_t overflows_ = 0;
};

}  // namespace lucerna
