// Media and boundaries packed for the shaders; the winding numbers.
#include "pathtracer/media.hpp"

#include "base/error.hpp"
#include "base/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

namespace lucerna {

namespace {

constexpr int kBlockEdge = 8;

bool equalChannels(const glm::vec3& v) { return v.x == v.y && v.y == v.z; }
double largest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

void checkCoefficient(const Medium& medium, const char* name, const glm::vec3& value) {
  for (int c = 0; c < 3; ++c)
    if (!(std::isfinite(value[c]) && value[c] >= 0.0f && value[c] < 1e30f))
      throwBadInput("medium {}: {} must be finite and 0 or more, and is {}", medium.name, name, value[c]);
}

/// The maximum over each block's cells and their neighbours: a bound of the interpolated values.
std::vector<float> blockBounds(const DensityGrid& grid, const glm::ivec3& blocks) {
  std::vector<float> bounds;
  for (int bz = 0; bz < blocks.z; ++bz)
    for (int by = 0; by < blocks.y; ++by)
      for (int bx = 0; bx < blocks.x; ++bx) {
        const glm::ivec3 first = glm::max(glm::ivec3(bx, by, bz) * kBlockEdge - 1, glm::ivec3(0));
        const glm::ivec3 last = glm::min(glm::ivec3(bx + 1, by + 1, bz + 1) * kBlockEdge, grid.size - 1);
        float bound = 0.0f;
        for (int z = first.z; z <= last.z; ++z)
          for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x)
              bound = std::max(bound,
                               grid.density[static_cast<std::size_t>(x) +
                                            static_cast<std::size_t>(grid.size.x) *
                                                (static_cast<std::size_t>(y) +
                                                 static_cast<std::size_t>(grid.size.y) * static_cast<std::size_t>(z))]);
        bounds.push_back(bound);
      }
  return bounds;
}

shared::DensityRecord packGrid(const Medium& medium, const glm::dvec3& origin, std::vector<float>& densities) {
  const DensityGrid& grid = *medium.grid;
  const glm::dvec3 extent = grid.max - grid.min;
  if (glm::any(glm::lessThan(grid.size, glm::ivec3(1))) || !glm::all(glm::greaterThan(extent, glm::dvec3(0.0))))
    throwBadInput("medium {}: a density grid needs one cell at least along each axis and a box of positive volume",
                  medium.name);
  const std::size_t cells = static_cast<std::size_t>(grid.size.x) * static_cast<std::size_t>(grid.size.y) *
                            static_cast<std::size_t>(grid.size.z);
  if (grid.density.size() != cells)
    throwBadInput("medium {}: the density grid has {} values for {} cells", medium.name, grid.density.size(), cells);
  for (const float d : grid.density)
    if (!(std::isfinite(d) && d >= 0.0f))
      throwBadInput("medium {}: a density is {}; it must be finite and 0 or more", medium.name, d);
  const glm::ivec3 blocks = (grid.size + kBlockEdge - 1) / kBlockEdge;
  const std::vector<float> bounds = blockBounds(grid, blocks);
  shared::DensityRecord record{};
  record.min = glm::vec3(grid.min - origin);
  record.cellsPerUnit = glm::vec3(glm::dvec3(grid.size) / extent);
  record.size = glm::ivec4(grid.size, kBlockEdge);
  record.blocks = glm::ivec4(blocks, 0);
  record.firstDensity = static_cast<int>(densities.size());
  densities.insert(densities.end(), grid.density.begin(), grid.density.end());
  record.firstBound = static_cast<int>(densities.size());
  densities.insert(densities.end(), bounds.begin(), bounds.end());
  return record;
}

double solidAngleOf(const BoundaryTriangle& triangle, const glm::dvec3& point) {
  const glm::dvec3 a = glm::dvec3(triangle.a) - point, b = glm::dvec3(triangle.b) - point,
                   c = glm::dvec3(triangle.c) - point;
  const double ra = glm::length(a), rb = glm::length(b), rc = glm::length(c);
  const double volume = glm::dot(a, glm::cross(b, c)),
               rest = ra * rb * rc + glm::dot(a, b) * rc + glm::dot(b, c) * ra + glm::dot(c, a) * rb;
  return volume != 0.0 || rest != 0.0 ? 2.0 * std::atan2(volume, rest) : 0.0;
}

/// How a closed boundary lies to another one.
enum class Lies { apart, within, across };

/// Points of `inner`, a little inside of it, against the winding number of `outer`.
Lies liesIn(const std::vector<BoundaryTriangle>& inner, const std::vector<BoundaryTriangle>& outer) {
  constexpr double kMostTerms = 2e7;
  constexpr int kSteps = 4;  // of a triangle's edges
  Bounds innerBounds, outerBounds;
  for (const auto& t : inner)
    for (const glm::vec3* p : {&t.a, &t.b, &t.c}) innerBounds.add(glm::dvec3(*p));
  for (const auto& t : outer)
    for (const glm::vec3* p : {&t.a, &t.b, &t.c}) outerBounds.add(glm::dvec3(*p));
  if (!overlap(innerBounds, outerBounds)) return Lies::apart;
  const double depth = 1e-4 * std::min(glm::length(innerBounds.extent()), glm::length(outerBounds.extent()));
  const auto tested = static_cast<std::size_t>(kMostTerms / (15.0 * static_cast<double>(outer.size())));
  const std::size_t stride = std::max<std::size_t>(inner.size() / std::max<std::size_t>(tested, 1), 1);
  Lies lies = Lies::apart;
  for (std::size_t i = 0; i < inner.size(); i += stride) {
    const glm::dvec3 a(inner[i].a), ab = glm::dvec3(inner[i].b) - a, ac = glm::dvec3(inner[i].c) - a,
                     normal = glm::cross(ab, ac);
    if (!(glm::length(normal) > 0.0)) continue;
    int inside = 0, all = 0;
    for (int u = 0; u <= kSteps; ++u)
      for (int v = 0; u + v <= kSteps; ++v) {
        const glm::dvec3 middle = (ab + ac) / 3.0, at = (double(u) * ab + double(v) * ac) / double{kSteps},
                         point = a + middle + 0.99 * (at - middle) - depth * glm::normalize(normal);
        double angle = 0.0;
        for (const BoundaryTriangle& t : outer) angle += solidAngleOf(t, point);
        inside += angle > 2.0 * std::numbers::pi;
        ++all;
      }
    if (inside > 0 && inside < all) return Lies::across;
    if (inside == all) lies = Lies::within;
  }
  return lies;
}

/// A dielectric or a medium's boundary, of all materials that are the same one.
struct Shell {
  std::tuple<int, bool, float, int> key;  ///< priority, dielectric, index, medium
  std::string material;
  std::vector<BoundaryTriangle> triangles;
};

/// Orders boundaries of the same priority: what lies within another one comes after it. Where two cross, the dielectric
/// comes after a medium alone, and the higher index after the lower one; media alone have no such order.
void orderByNesting(std::vector<Shell>& shells, const std::string& scene) {
  const std::size_t n = shells.size();
  std::vector<std::vector<bool>> holds(n, std::vector<bool>(n, false));
  const auto fail = [&](std::size_t i, std::size_t k) {
    throwBadInput(
        "{}: the boundaries of materials {} and {} cross, and both have priority {}: give one a higher \"priority\", "
        "and its medium applies where they overlap",
        scene, shells[i].material, shells[k].material, std::get<0>(shells[i].key));
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = i + 1; k < n; ++k) {
      if (std::get<0>(shells[i].key) != std::get<0>(shells[k].key)) continue;
      const Lies within = liesIn(shells[k].triangles, shells[i].triangles),
                 around = liesIn(shells[i].triangles, shells[k].triangles);
      const bool cross =
          within == Lies::across || around == Lies::across || (within == Lies::within && around == Lies::within);
      const auto& [priorityI, dielectricI, iorI, mediumI] = shells[i].key;
      const auto& [priorityK, dielectricK, iorK, mediumK] = shells[k].key;
      if (cross && dielectricI == dielectricK && iorI == iorK) fail(i, k);
      if (cross) holds[i][k] = true;
      else if (within == Lies::within) holds[i][k] = true;
      else if (around == Lies::within) holds[k][i] = true;
    }
  std::vector<Shell> ordered;
  std::vector<bool> placed(n, false);
  while (ordered.size() < n) {
    std::size_t next = n;
    for (std::size_t i = 0; i < n && next == n; ++i) {
      bool free = !placed[i];
      for (std::size_t k = 0; k < n; ++k) free = free && (placed[k] || !holds[k][i]);
      if (free) next = i;
    }
    if (next == n) {  // a circle of boundaries, each within the next
      std::vector<std::size_t> left;
      for (std::size_t i = 0; i < n; ++i)
        if (!placed[i]) left.push_back(i);
      fail(left[0], left[1]);
    }
    placed[next] = true;
    ordered.push_back(std::move(shells[next]));
  }
  shells = std::move(ordered);
}

/// The albedo below which a channel's collisions are drawn at the rate of its scattering alone, and absorption is a
/// weight: otherwise chance would decide whether light gets through, and most paths would end. Not in media that emit:
/// their light would be sought far beyond where it comes from.
constexpr float kAbsorbing = 0.25f;

}  // namespace

PackedMedia packMedia(const std::vector<Medium>& media, const glm::dvec3& origin) {
  PackedMedia packed;
  for (const Medium& medium : media) {
    checkCoefficient(medium, "scattering", medium.scattering);
    checkCoefficient(medium, "absorption", medium.absorption);
    checkCoefficient(medium, "emission", medium.emission);
    shared::MediumRecord record{};
    const glm::dvec3 extinction = glm::dvec3(medium.scattering) + glm::dvec3(medium.absorption);
    for (int c = 0; c < 3; ++c) {
      const double g = medium.phase == PhaseFunction::rayleigh ? 0.0 : static_cast<double>(medium.anisotropy[c]);
      if (!(g > -1.0 && g < 1.0))
        throwBadInput("medium {}: g must lie between -1 and 1, both left out, and is {}", medium.name, g);
      // A channel that does not scatter has no g: it copies the others, so that all can be equal.
      record.albedo[c] =
          extinction[c] > 0.0 ? static_cast<float>(static_cast<double>(medium.scattering[c]) / extinction[c]) : 0.0f;
      const bool isWeight = record.albedo[c] < kAbsorbing && medium.emission == glm::vec3(0.0f);
      record.rate[c] = isWeight ? medium.scattering[c] : static_cast<float>(extinction[c]);
      record.oneMinusG[c] = static_cast<float>(1.0 - g);
      record.onePlusG[c] = static_cast<float>(1.0 + g);
    }
    for (int c = 0; c < 3; ++c)
      if (medium.scattering[c] == 0.0f) {
        const int other = medium.scattering[(c + 1) % 3] > 0.0f ? (c + 1) % 3 : (c + 2) % 3;
        record.oneMinusG[c] = record.oneMinusG[other];
        record.onePlusG[c] = record.onePlusG[other];
      }
    record.extinction = glm::vec3(extinction);
    record.emission = medium.emission;
    record.phase = medium.phase == PhaseFunction::rayleigh ? 1 : 0;
    record.greyExtinction = equalChannels(record.extinction) && record.rate == record.extinction;
    record.greyPhase = equalChannels(record.oneMinusG) && equalChannels(record.onePlusG);
    record.grid = -1;
    record.majorant = static_cast<float>(largest(extinction));
    if (medium.grid) {
      record.grid = static_cast<int>(packed.grids.size());
      packed.grids.push_back(packGrid(medium, origin, packed.densities));
      // A medium that only emits still needs points to look up its emission: about four per crossing of the box.
      if (record.majorant <= 0.0f && largest(medium.emission) > 0.0) {
        const double bound = *std::max_element(medium.grid->density.begin(), medium.grid->density.end());
        record.majorant =
            static_cast<float>(4.0 / (glm::length(medium.grid->max - medium.grid->min) * std::max(bound, 1e-30)));
      }
    }
    packed.media.push_back(record);
  }
  return packed;
}

void checkOuterMedium(const Scene& scene, const SceneFeatures& features) {
  if (scene.cameraMedium < 0) return;
  const Medium& medium = scene.media[static_cast<std::size_t>(scene.cameraMedium)];
  if (medium.grid) return;
  const std::string end = fmt::format(
      "give it an end by a body of a material with \"bsdf\": \"none\", \"interior\": \"{}\" in place of "
      "\"cameraMedium\"",
      medium.name);
  const glm::vec3 extinction = medium.scattering + medium.absorption;
  const bool isBlack = std::min({extinction.x, extinction.y, extinction.z}) > 0.0f;
  const bool isLitWithin = features.emission || features.spotLights || features.pointLights || features.volumeEmission;
  if (isBlack && (features.directionalLight || features.environment || features.background)) {
    const std::string why =
        fmt::format("medium {} has no end, so no light of the sun and the sky gets through it; {}", medium.name, end);
    if (!isLitWithin) throwBadInput("{}: the picture would be black: {}", scene.name, why);
    logWarning("{}", why);
  }
  for (int c = 0; c < 3; ++c)
    if (isLitWithin && medium.scattering[c] > 0.0f && medium.absorption[c] == 0.0f) {
      logWarning("medium {} has no end and absorbs nothing, so paths in it hardly ever end, nor may the picture; {}",
                 medium.name, end);
      return;
    }
}

PackedBoundaries rankBoundaries(const Scene& scene, bool diffuseOnly) {
  using Key = std::tuple<int, bool, float, int>;  // priority, dielectric, index, medium
  const auto bounds = [&](const Material& m) {
    return m.bsdf == Bsdf::none || (m.bsdf == Bsdf::dielectric && !diffuseOnly);
  };
  const auto keyOf = [](const Material& m) {
    const bool dielectric = m.bsdf == Bsdf::dielectric;
    return Key{m.priority, dielectric, dielectric ? m.ior : 1.0f, m.interior};
  };
  std::vector<Shell> shells;
  for (const Material& material : scene.materials) {
    if (!bounds(material)) continue;
    if (!(std::isfinite(material.ior) && material.ior > 0.0f))
      throwBadInput("material {}: an index of refraction must be above 0, and is {}", material.name, material.ior);
    if (material.interior < -1 || material.interior >= static_cast<int>(scene.media.size()))
      throwBadInput("material {}: no such medium: {}", material.name, material.interior);
    const Key key = keyOf(material);
    if (std::none_of(shells.begin(), shells.end(), [&](const Shell& s) { return s.key == key; }))
      shells.push_back({key, material.name, {}});
  }
  std::sort(shells.begin(), shells.end(), [](const Shell& a, const Shell& b) { return a.key < b.key; });
  if (shells.size() > static_cast<std::size_t>(kMaxBoundaryRanks))
    throwBadInput("{}: {} different dielectrics and boundaries of media, at most {} are supported", scene.name,
                  shells.size(), kMaxBoundaryRanks);
  const auto shellOf = [&](const Material& material) {
    return std::find_if(shells.begin(), shells.end(), [&](const Shell& s) { return s.key == keyOf(material); });
  };
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    if (!bounds(material)) continue;
    std::vector<BoundaryTriangle>& triangles = shellOf(material)->triangles;
    const auto corner = [&](std::uint32_t i) { return scene.vertices[scene.indices[i]].position; };
    for (std::uint32_t i = mesh.firstIndex; i + 2 < mesh.firstIndex + mesh.indexCount; i += 3)
      triangles.push_back({corner(i), corner(i + 1), corner(i + 2), 0});
  }
  orderByNesting(shells, scene.name);

  PackedBoundaries packed;
  for (std::size_t rank = 0; rank < shells.size(); ++rank) {
    const auto& [priority, dielectric, ior, medium] = shells[rank].key;
    shared::InteriorRecord interior{};
    interior.ior = ior;
    interior.medium = medium;
    interior.clearance = -1;
    packed.interiors.push_back(interior);
    if (dielectric) packed.dielectricRanks[static_cast<int>(rank / 8)] |= 15u << (4 * (rank % 8));
    for (BoundaryTriangle& triangle : shells[rank].triangles) {
      triangle.rank = static_cast<int>(rank);
      packed.triangles.push_back(triangle);
    }
  }
  for (const Material& material : scene.materials)
    packed.rankOfMaterial.push_back(
        bounds(material) ? static_cast<int>(shellOf(material) - shells.begin()) : -1);
  return packed;
}

std::vector<Bounds> boundsOfRanks(const PackedBoundaries& boundaries) {
  std::vector<Bounds> bounds(boundaries.interiors.size());
  for (const BoundaryTriangle& t : boundaries.triangles)
    for (const glm::vec3* p : {&t.a, &t.b, &t.c}) bounds[static_cast<std::size_t>(t.rank)].add(glm::dvec3(*p));
  return bounds;
}

bool overlap(const Bounds& a, const Bounds& b) {
  return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

bool boundariesMayTouch(const Scene& scene, const PackedBoundaries& boundaries) {
  const auto rankOf = [&](const Mesh& mesh) {
    return boundaries.rankOfMaterial[static_cast<std::size_t>(mesh.material)];
  };
  for (const Mesh& a : scene.meshes) {
    if (rankOf(a) < 0) continue;
    for (const Mesh& b : scene.meshes)
      if (rankOf(b) != rankOf(a) && overlap(a.bounds, b.bounds)) return true;
  }
  return false;
}

Surroundings surroundingsOf(const PackedBoundaries& boundaries, const glm::dvec3& point) {
  std::array<double, kMaxBoundaryRanks> solidAngle{};
  for (const BoundaryTriangle& triangle : boundaries.triangles)
    solidAngle[static_cast<std::size_t>(triangle.rank)] += solidAngleOf(triangle, point);
  Surroundings result;
  for (std::size_t rank = 0; rank < boundaries.interiors.size(); ++rank) {
    const double winding = solidAngle[rank] / (4.0 * std::numbers::pi);
    const double whole = std::round(winding);
    result.openness = std::max(result.openness, std::abs(winding - whole));
    result.inside[static_cast<int>(rank / 8)] |= static_cast<std::uint32_t>(std::clamp(whole, 0.0, 15.0))
                                                 << (4 * (rank % 8));
  }
  return result;
}

float iorInside(const PackedBoundaries& boundaries, const InsideCounts& inside) {
  for (int rank = static_cast<int>(boundaries.interiors.size()) - 1; rank >= 0; --rank)
    if (inside[rank / 8] & boundaries.dielectricRanks[rank / 8] & (15u << (4 * (rank % 8))))
      return boundaries.interiors[static_cast<std::size_t>(rank)].ior;
  return 1.0f;
}

}  // namespace lucerna
