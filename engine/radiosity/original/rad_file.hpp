// The triangle file of the radiosity original, read and written byte for byte (no GL).
//
// A file is the count of triangles (4 bytes) and then the triangles, 72 bytes each, little endian as on the published
// machine [RAD2008 section 3.3]. A scene is a bag of independent triangles; those with e > 0 are its sources.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace lucerna {

/// Own and received radiosity are 24-bit integers: the red, green and blue bytes of a pixel.
inline constexpr std::uint32_t kRadMost = 0xffffff;

struct RadTriangle {
  std::array<float, 3> p1{}, p2{}, p3{};  ///< corners, scene units, counterclockwise about n
  std::array<float, 3> n{};  ///< unit normal
  std::array<float, 3> c{};  ///< colour, 0..1; not used by the computation
  float ro = 0.0f;  ///< reflectance, 0..1
  std::uint32_t e = 0;  ///< own emission
  std::uint32_t b = 0;  ///< received radiosity
};
static_assert(sizeof(RadTriangle) == 72);

/// Vectors of the file, and back.
inline glm::dvec3 vec(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
inline std::array<float, 3> toFloats(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// The displayed value of a triangle [RAD2008 eq 3-1].
inline double shownRadiosity(const RadTriangle& t) { return static_cast<double>(t.e) + static_cast<double>(t.b); }

/// Twice the area is the length of a triangle's cross product; zero for slivers that are lines in float.
double areaOf(const RadTriangle& triangle);

/// Checks every triangle: finite corners and normals, a normal of length 1 (within 1 %) if there is an area,
/// reflectance 0..1, e and b in 24 bits. Throws Error(badInput) naming the file and the triangle, counted from 0.
/// Triangles without area are not an error: returns their count; they stay in files, and are neither drawn nor
/// computed.
std::size_t checkRadTriangles(std::span<const RadTriangle> triangles, const std::string& file);

/// The file's bytes as triangles, without further checks: encodeRadFile returns the same bytes.
/// Throws Error(badInput) if the size does not fit the count (naming both), the byte order is the other one, or there
/// is no triangle.
std::vector<RadTriangle> decodeRadFile(std::span<const std::uint8_t> bytes, const std::string& file);
std::vector<std::uint8_t> encodeRadFile(std::span<const RadTriangle> triangles);

/// Reads a file; throws like decodeRadFile, and if the file changes while it is read.
std::vector<RadTriangle> readRadFile(const std::filesystem::path& file);

/// Writes a file completely or not at all; it is on disk on return.
void writeRadFile(const std::filesystem::path& file, std::span<const RadTriangle> triangles);

}  // namespace lucerna
