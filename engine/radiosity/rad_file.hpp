// The triangle file of the radiosity original, read and written byte for byte (no GL).
//
// A file is the count of triangles (4 bytes) and then the triangles, 72 bytes each, little endian as on the published machine
// [RAD2008 section 3.3]. A scene is a bag of independent triangles; those with e > 0 are its sources.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lucerna {

/// Radiosity, own and received, counts in whole numbers of 24 bits: what a pixel's red, green and blue bytes hold.
inline constexpr std::uint32_t kRadMost = 0xffffff;

struct RadTriangle {
  std::array<float, 3> p1{}, p2{}, p3{};  ///< corners, scene units, counterclockwise about n
  std::array<float, 3> n{};               ///< unit normal
  std::array<float, 3> c{};               ///< colour, 0..1; takes no part in the computation
  float ro = 0.0f;                        ///< reflectance, 0..1
  std::uint32_t e = 0;                    ///< own emission
  std::uint32_t b = 0;                    ///< received radiosity
};
static_assert(sizeof(RadTriangle) == 72);

/// What is shown of a triangle [RAD2008 eq 3-1].
inline double shownRadiosity(const RadTriangle& t) { return static_cast<double>(t.e) + static_cast<double>(t.b); }

/// Twice the area is the length of a triangle's cross product; zero for slivers that floats cannot tell from a line.
double areaOf(const RadTriangle& triangle);

/// Checks that every triangle can be computed with: finite corners and normals, a normal of length 1 (within 1 %) where there is an area,
/// reflectance 0..1, e and b in 24 bits. Throws Error(badInput) naming the file and the triangle, counted from 0. Triangles without area are
/// no fault: returns how many there are; they are kept in files, and neither drawn nor computed.
std::size_t checkRadTriangles(std::span<const RadTriangle> triangles, const std::string& file);

/// The file's bytes as triangles, nothing else checked: what encodeRadFile makes of them is the same bytes.
/// Throws Error(badInput) when the size does not fit the count (naming both), the byte order is the other one, or there is no triangle.
std::vector<RadTriangle> decodeRadFile(std::span<const std::uint8_t> bytes, const std::string& file);
std::vector<std::uint8_t> encodeRadFile(std::span<const RadTriangle> triangles);

/// Reads a file; throws like decodeRadFile, and when the file changes while it is read.
std::vector<RadTriangle> readRadFile(const std::filesystem::path& file);

/// Writes a file whole or not at all, and on the disk when it returns.
void writeRadFile(const std::filesystem::path& file, std::span<const RadTriangle> triangles);

}  // namespace lucerna
