// Solution files (no GL): their settings, comparison with the requested ones, writing and reading.
#include "radiosity/solution.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"
#include "base/log.hpp"
#include "scene/fingerprint.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <span>
#include <sstream>

namespace lucerna {

namespace {

constexpr char kSolutionMagic[8] = {'L', 'U', 'C', 'L', 'I', 'G', 'H', 'T'};
constexpr std::uint32_t kSolutionVersion = 5;  // 5: solvers without overshooting, numbered anew

struct FileHeader {
  char magic[8];
  std::uint32_t version, solver, deviations, settingsBytes;
  std::uint64_t scene, points, patches, lightVertices, checksum;
  double products, residual, errorBound, energyBalance, extent;
};
struct FilePatch {
  std::uint32_t point[3], light[3];
  float texCoord[6], normal[9];
  std::int32_t material;
  std::uint32_t triangle;
  float fronts, backs;
  double centroid[3], faceNormal[3], area, reflectance[3], emission[3], direct[3], fromEmitters[3], fromSky[3],
      irradiance[3], exitance[3];
};

std::uint64_t fingerprint(const Scene& scene) {
  Hash hash;
  addScene(hash, scene);
  return hash.value();
}

/// "KEY=VALUE" each.
std::vector<std::string> wordsOf(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::uint32_t bitsOf(const RadiosityDeviations& deviations) {
  std::uint32_t bits = 0, bit = 1;
  for (const RadiosityDeviation& d : allRadiosityDeviations()) bits |= deviations.*d.member ? bit : 0, bit *= 2;
  return bits;
}

}  // namespace

std::string textOf(const RadiositySolutionSettings& s) {
  std::string text = s.wholeTriangles ? "patches=triangles" : fmt::format("radiosity.edge={}", s.patches.longestEdge);
  text += fmt::format(
      " radiosity.resolution={} radiosity.exact-pixels={} radiosity.part-distance={} radiosity.parts={} "
      "radiosity.seed={} radiosity.repair={} radiosity.refinements={}",
      s.hemicubes.resolution, s.hemicubes.exactPixels, s.hemicubes.nearDistance, s.hemicubes.mostParts,
      s.hemicubes.seed, s.repair ? "on" : "off", s.refinements);
  if (s.hemicubes.rolls != 1) text += fmt::format(" radiosity.rolls={}", s.hemicubes.rolls);
  if (s.refinements > 0) text += fmt::format(" radiosity.steep={}", s.steep);
  return text;
}

void checkSettings(const std::filesystem::path& file, const RadiositySolution& solution,
                   const RadiositySolutionSettings& asked) {
  const std::vector<std::string> had = wordsOf(solution.settings), now = wordsOf(textOf(asked)),
                                 usual = wordsOf(textOf({}));
  std::string wrong, other;
  for (const std::string& word : now) {
    const std::string key = word.substr(0, word.find('=') + 1);
    const auto before = std::find_if(had.begin(), had.end(), [&](const std::string& w) { return w.starts_with(key); });
    if (before != had.end() && *before == word) continue;
    const bool isDefault = std::find(usual.begin(), usual.end(), word) != usual.end();
    const std::string was = before != had.end() ? *before : "without " + key.substr(0, key.size() - 1);
    (isDefault ? other : wrong) += fmt::format("{}{}{}", (isDefault ? other : wrong).empty() ? "" : ", ", was,
                                               isDefault ? "" : fmt::format(" (asked for: {})", word));
  }
  if (!(solution.progress.errorBound <= asked.error)) {
    const bool isDefault = asked.error == RadiositySolutionSettings{}.error;
    (isDefault ? other : wrong) +=
        fmt::format("{}an error of {:.3g} (asked for: radiosity.error={:.3g})",
                    (isDefault ? other : wrong).empty() ? "" : ", ", solution.progress.errorBound, asked.error);
  }
  if (!wrong.empty())
    throwBadInput("{}: solved with {}: leave that out, or name another file for a new solution", file.string(), wrong);
  if (!other.empty()) logWarning("{}: shown as solved, with {}", file.string(), other);
}

void saveSolution(const std::filesystem::path& file, const Scene& scene, const RadiositySolution& s) {
  std::vector<FilePatch> patches(s.mesh.patches.size());
  if (!patches.empty()) std::memset(static_cast<void*>(patches.data()), 0, patches.size() * sizeof(FilePatch));
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Patch& from = s.mesh.patches[i];
    FilePatch& to = patches[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      to.point[k] = from.point[k];
      to.light[k] = from.light[k];
      for (int c = 0; c < 2; ++c) to.texCoord[2 * k + static_cast<std::size_t>(c)] = from.texCoord[k][c];
      for (int c = 0; c < 3; ++c) to.normal[3 * k + static_cast<std::size_t>(c)] = from.normal[k][c];
      to.centroid[k] = from.centroid[axis];
      to.faceNormal[k] = from.faceNormal[axis];
      to.reflectance[k] = from.reflectance[axis];
      to.emission[k] = from.emission[axis];
      to.direct[k] = s.direct[i][axis];
      to.fromEmitters[k] = s.fromEmitters[i][axis];
      to.fromSky[k] = s.fromSky[i][axis];
      to.irradiance[k] = s.irradiance[i][axis];
      to.exitance[k] = s.exitance[i][axis];
    }
    to.material = from.material;
    to.triangle = from.triangle;
    to.area = from.area;
    to.fronts = s.fronts[i];
    to.backs = s.backs[i];
  }
  FileHeader header{};
  std::memcpy(header.magic, kSolutionMagic, sizeof kSolutionMagic);
  header.version = kSolutionVersion;
  header.solver = static_cast<std::uint32_t>(s.solver);
  header.deviations = bitsOf(s.deviations);
  header.settingsBytes = static_cast<std::uint32_t>(s.settings.size());
  header.scene = fingerprint(scene);
  header.points = s.mesh.points.size();
  header.patches = patches.size();
  header.lightVertices = s.mesh.lightVertices;
  header.products = s.progress.products;
  header.residual = s.progress.residual;
  header.errorBound = s.progress.errorBound;
  header.energyBalance = s.progress.energyBalance;
  header.extent = s.mesh.extent;
  std::vector<std::uint8_t> bytes;
  const auto put = [&](const void* data, std::size_t size) {
    bytes.insert(bytes.end(), static_cast<const std::uint8_t*>(data), static_cast<const std::uint8_t*>(data) + size);
  };
  Hash checksum;
  checksum.bytes(s.settings.data(), s.settings.size());
  checksum.bytes(s.mesh.points.data(), s.mesh.points.size() * sizeof(glm::dvec3));
  checksum.bytes(patches.data(), patches.size() * sizeof(FilePatch));
  header.checksum = checksum.value();
  put(&header, sizeof header);
  put(s.settings.data(), s.settings.size());
  put(s.mesh.points.data(), s.mesh.points.size() * sizeof(glm::dvec3));
  put(patches.data(), patches.size() * sizeof(FilePatch));
  writeFileAtomically(file, std::span<const std::uint8_t>(bytes));
}

RadiositySolution loadSolution(const std::filesystem::path& file, const Scene& scene) {
  // The header, and whether the file is complete, undamaged and of this scene.
  const std::vector<std::uint8_t> bytes = readFileBytes(file);
  FileHeader header{};
  if (bytes.size() < sizeof header || std::memcmp(bytes.data(), kSolutionMagic, sizeof kSolutionMagic) != 0)
    throwBadInput("{}: not a radiosity solution", file.string());
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.version != kSolutionVersion)
    throwBadInput("{}: a solution of version {}, this program reads {}: solve it again", file.string(), header.version,
                  kSolutionVersion);
  if (header.scene != fingerprint(scene))
    throwBadInput("{}: the solution of another scene, or of this one before it was changed: solve it again",
                  file.string());
  const std::size_t most = bytes.size() / sizeof(glm::dvec3) + 1;
  if (header.points > most || header.patches > most ||
      bytes.size() != sizeof header + header.settingsBytes + header.points * sizeof(glm::dvec3) +
                          header.patches * sizeof(FilePatch))
    throwBadInput("{}: {} bytes do not fit {} points and {} patches: was it truncated?", file.string(), bytes.size(),
                  header.points, header.patches);
  const std::uint8_t* at = bytes.data() + sizeof header;
  if (Hash::of(at, bytes.size() - sizeof header) != header.checksum)
    throwBadInput("{}: is damaged: wrong checksum", file.string());
  // The checksum detects damage; this detects files that something else wrote.
  if (header.points == 0 || header.patches == 0) throwBadInput("{}: a solution without patches", file.string());
  if (header.lightVertices > 3 * header.patches)
    throwBadInput("{}: {} light vertices for {} patches", file.string(), header.lightVertices, header.patches);
  if (header.solver > static_cast<std::uint32_t>(RadiositySolver::conjugateGradients))
    throwBadInput("{}: no such solver: {}", file.string(), header.solver);
  for (const double figure : {header.products, header.residual, header.errorBound, header.energyBalance, header.extent})
    if (!std::isfinite(figure)) throwBadInput("{}: a figure of its header is not finite", file.string());
  // Settings and points.
  RadiositySolution s;
  s.settings.assign(reinterpret_cast<const char*>(at), header.settingsBytes);
  at += header.settingsBytes;
  s.mesh.points.resize(header.points);
  std::memcpy(static_cast<void*>(s.mesh.points.data()), at, header.points * sizeof(glm::dvec3));
  for (const glm::dvec3& p : s.mesh.points)
    if (!std::isfinite(p.x + p.y + p.z)) throwBadInput("{}: a corner that is not finite", file.string());
  s.mesh.lightVertices = header.lightVertices;
  s.mesh.extent = header.extent;
  at += header.points * sizeof(glm::dvec3);
  // Patches, each with its part of the solution.
  const auto vector = [](const double* v) { return glm::dvec3(v[0], v[1], v[2]); };
  for (std::size_t i = 0; i < header.patches; ++i) {
    FilePatch from;
    std::memcpy(&from, at + i * sizeof from, sizeof from);
    Patch& to = s.mesh.patches.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      if (from.point[k] >= header.points || from.light[k] >= header.lightVertices)
        throwBadInput("{}: patch {} has no such corner", file.string(), i);
      to.point[k] = from.point[k];
      to.light[k] = from.light[k];
      to.texCoord[k] = {from.texCoord[2 * k], from.texCoord[2 * k + 1]};
      to.normal[k] = {from.normal[3 * k], from.normal[3 * k + 1], from.normal[3 * k + 2]};
    }
    if (from.material < 0 || static_cast<std::size_t>(from.material) >= scene.materials.size())
      throwBadInput("{}: patch {} has no such material", file.string(), i);
    to.material = from.material;
    if (from.triangle >= scene.triangleCount()) throwBadInput("{}: patch {} has no such triangle", file.string(), i);
    to.triangle = from.triangle;
    to.area = from.area;
    to.centroid = vector(from.centroid);
    to.faceNormal = vector(from.faceNormal);
    to.reflectance = vector(from.reflectance);
    to.emission = vector(from.emission);
    s.direct.push_back(vector(from.direct));
    s.fromEmitters.push_back(vector(from.fromEmitters));
    s.fromSky.push_back(vector(from.fromSky));
    s.irradiance.push_back(vector(from.irradiance));
    s.exitance.push_back(vector(from.exitance));
    s.fronts.push_back(from.fronts);
    s.backs.push_back(from.backs);
    double sum = from.area + from.fronts + from.backs;
    for (const auto& values : {from.centroid, from.faceNormal, from.reflectance, from.emission, from.direct,
                               from.fromEmitters, from.fromSky, from.irradiance, from.exitance})
      for (int c = 0; c < 3; ++c) sum += values[c];
    for (const float value : from.texCoord) sum += value;
    for (const float value : from.normal) sum += value;
    if (!std::isfinite(sum) || !(from.area >= 0.0) || !(from.fronts >= 0.0f && from.backs >= 0.0f))
      throwBadInput("{}: patch {} has a value that is not finite, or an area or share below 0", file.string(), i);
  }
  s.progress = {header.products, header.residual, header.errorBound, header.energyBalance, false};
  s.solver = static_cast<RadiositySolver>(header.solver);
  std::uint32_t bit = 1;
  for (const RadiosityDeviation& d : allRadiosityDeviations())
    s.deviations.*d.member = (header.deviations & bit) != 0, bit *= 2;
  s.reached = true;
  return s;
}

}  // namespace lucerna
