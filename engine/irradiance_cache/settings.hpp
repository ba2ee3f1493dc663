// Settings of the irradiance cache. README.md in this folder has units and sources.
#pragma once

#include "base/named_values.hpp"
#include "cascades/cascades.hpp"

#include <array>
#include <string_view>

namespace lucerna {

/// Where a record's light comes from. `rays`: along paths. `gather`: from the lights' reflective shadow maps, and from
/// points of the scene that store the light of further bounces.
enum class CacheTransport { rays, gather };
constexpr std::array<std::string_view, 2> namesOf(CacheTransport) { return {"rays", "gather"}; }

/// Occlusion of light gathered from maps and emissive surfaces.
enum class GatherVisibility { none, rays };
constexpr std::array<std::string_view, 2> namesOf(GatherVisibility) { return {"none", "rays"}; }

struct IrradianceCacheSettings {
  static constexpr int kAllBounces = 0;

  CascadeSettings cascades;
  float blendBand = 0.5f;  ///< fraction of a cascade's reach over which it fades into the next
  CacheTransport transport = CacheTransport::rays;
  int bounces = kAllBounces;  ///< reflections before light reaches a surface
  GatherVisibility visibility = GatherVisibility::rays;  ///< for CacheTransport::gather
  int bounceCells = 16;  ///< likewise: along the longest side of the scene, of the bounce cache
  int rays = 16;  ///< for CacheTransport::rays: paths per record and frame, 1, 2, 4 ... 64
  int leastRays = 64;  ///< likewise: minimum number of paths of a record in its first frame
  int samples = 512;  ///< likewise: paths of a record while light and geometry are static
  /// Directions around the camera in which surfaces get records before they come into view, so that a turn does not
  /// flicker; 0: none.
  int prefetch = 1024;
  /// Largest relative change per frame of the shown irradiance while the camera moves or paths are added; 0: no limit.
  float mostChange = 0.0025f;
  int reflections = 4;  ///< rays per pixel of a coat, a mirror or glass, that find what it reflects; 0: none
  /// What paths hit is kept while the scene moves: a record is relit, and only paths that meet what moved are traced.
  bool keepsHits = true;
  static constexpr int kAllPaths = 0;
  int tracedPaths = kAllPaths;  ///< of kept ones, traced again per frame at most
  /// For CacheTransport::rays, in finished pictures: a cell where surfaces are close is split into this many parts a
  /// side; 1: none.
  int split = 1;
  float splitShare = 0.25f;  ///< paths of all parts, over those of all cells
  bool smooths = true;  ///< likewise: noise is told from structure; records that count little have fewer paths
  bool fullFloat = false;  ///< 32 bits instead of 16; also where lamps differ too much in strength for 16
};

}  // namespace lucerna
