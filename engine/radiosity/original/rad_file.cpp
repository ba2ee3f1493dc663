#include "radiosity/original/rad_file.hpp"

#include "base/error.hpp"
#include "base/files.hpp"

#include <glm/glm.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace lucerna {

static_assert(std::endian::native == std::endian::little,
              "the file is little endian; a big-endian machine must swap its words here");

namespace {

constexpr std::size_t kHead = 4;

std::uint64_t sizeFor(std::uint64_t count) { return kHead + count * sizeof(RadTriangle); }

bool isFinite(const std::array<float, 3>& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

/// Detects changes of a file.
std::array<std::int64_t, 4> stampOf(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return {};
  return {static_cast<std::int64_t>(status.st_ino), static_cast<std::int64_t>(status.st_size),
          static_cast<std::int64_t>(status.st_mtim.tv_sec), static_cast<std::int64_t>(status.st_mtim.tv_nsec)};
}

}  // namespace

double areaOf(const RadTriangle& t) {
  const glm::dvec3 a = vec(t.p1), u = vec(t.p2) - a, v = vec(t.p3) - a;
  const double area = 0.5 * glm::length(glm::cross(u, v));
  // Corners are floats: an area below the rounding of the longest side counts as zero.
  const double longest = std::max({glm::length(u), glm::length(v), glm::length(u - v)});
  return area > 1e-7 * longest * longest ? area : 0.0;
}

std::size_t checkRadTriangles(std::span<const RadTriangle> triangles, const std::string& file) {
  std::size_t zeroArea = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const RadTriangle& t = triangles[i];
    if (!isFinite(t.p1) || !isFinite(t.p2) || !isFinite(t.p3))
      throwBadInput("{}: triangle {}: a corner is not a finite number", file, i);
    if (!(t.ro >= 0.0f && t.ro <= 1.0f))
      throwBadInput("{}: triangle {}: reflectance {}, expected 0 to 1", file, i, t.ro);
    if (t.e > kRadMost)
      throwBadInput("{}: triangle {}: own emission e is {}, expected at most {} (24 bits)", file, i, t.e, kRadMost);
    if (t.b > kRadMost)
      throwBadInput("{}: triangle {}: received radiosity b is {}, expected at most {} (24 bits)", file, i, t.b,
                    kRadMost);
    if (areaOf(t) == 0.0) {
      ++zeroArea;
      continue;
    }
    const double length = isFinite(t.n) ? glm::length(vec(t.n)) : NAN;
    if (!(std::abs(length - 1.0) <= 0.01))
      throwBadInput("{}: triangle {}: its normal has length {:.6g}, expected 1", file, i, length);
  }
  if (zeroArea == triangles.size()) throwBadInput("{}: none of its {} triangles has an area", file, triangles.size());
  return zeroArea;
}

std::vector<RadTriangle> decodeRadFile(std::span<const std::uint8_t> bytes, const std::string& file) {
  if (bytes.size() < kHead)
    throwBadInput("{}: has {} bytes; a triangle file begins with the count of triangles, {} bytes", file, bytes.size(),
                  kHead);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data(), kHead);
  if (sizeFor(count) != bytes.size()) {
    if (const std::uint32_t turned = __builtin_bswap32(count); sizeFor(turned) == bytes.size())
      throwBadInput("{}: is in the other byte order ({} triangles, big endian); expected little endian", file, turned);
    throwBadInput("{}: its count is {} triangles, {} bytes, but the file has {}", file, count, sizeFor(count),
                  bytes.size());
  }
  if (count == 0) throwBadInput("{}: has no triangles", file);
  std::vector<RadTriangle> triangles(count);
  std::memcpy(triangles.data(), bytes.data() + kHead, bytes.size() - kHead);
  return triangles;
}

std::vector<std::uint8_t> encodeRadFile(std::span<const RadTriangle> triangles) {
  CHECK(triangles.size() <= 0xffffffffu, "{} triangles", triangles.size());
  const auto count = static_cast<std::uint32_t>(triangles.size());
  std::vector<std::uint8_t> bytes(kHead + triangles.size_bytes());
  std::memcpy(bytes.data(), &count, kHead);
  std::memcpy(bytes.data() + kHead, triangles.data(), triangles.size_bytes());
  return bytes;
}

std::vector<RadTriangle> readRadFile(const std::filesystem::path& file) {
  const std::string extension = lowerExtension(file);
  for (const char* scene : {".obj", ".json", ".gltf", ".glb", ".ply", ".stl", ".fbx", ".dae", ".3ds", ".off"})
    if (extension == scene)
      throwBadInput("{}: a scene ({}), not a file of triangles; lucerna radiosity generate FILE {} makes one of it",
                    file.string(), extension.substr(1), file.string());
  const auto before = stampOf(file);
  const std::vector<std::uint8_t> bytes = readFileBytes(file);
  if (stampOf(file) != before)
    throwBadInput("{}: changed while it was read; try again when nothing writes to it", file.string());
  return decodeRadFile(bytes, file.string());
}

void writeRadFile(const std::filesystem::path& file, std::span<const RadTriangle> triangles) {
  writeFileDurably(file, encodeRadFile(triangles));
}

}  // namespace lucerna
