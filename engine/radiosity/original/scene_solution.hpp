// Any scene solved by the published program (solver.hpp), as a solution that can be shown and judged beside others.
//
// The program counts in one channel: it runs once for red, green and blue each, on the same triangles. Its files have
// no lights but triangles that emit. So what sun, lamps and sky give a triangle (direct_light.hpp) is reflected as its
// own emission.
#pragma once

#include "gl/context.hpp"
#include "radiosity/original/solver.hpp"
#include "radiosity/solution.hpp"

#include <array>
#include <functional>

namespace lucerna {

struct PublishedSceneSettings {
  double longestEdge = 0.0;  ///< scene units; 0: triangles stay whole
  int view = 100;  ///< pixels per side of a hemicube; published 100, 200 and 500 [RAD2008 table 4.1]
  std::uint32_t lightPower = 1'000'000;  ///< e of the brightest triangle in its brightest channel, 1..kRadMost
  std::uint32_t mostSweeps = 7;  ///< of a channel, unless nothing changes before: as the published scene took
};

struct PublishedScene {
  RadiositySolution solution;  ///< scene units. fromEmitters is 0: the program does not tell it from other light
  std::array<std::uint32_t, 3> sweeps{};  ///< of red, green and blue
  std::size_t hemicubes = 0;
  std::size_t overflows = 0;  ///< exitances above 24 bits, whose upper bits were lost
  double exitanceOfStep = 0.0;  ///< W/m^2 that one step of e and b stands for
};

/// `goOn` is called after each triangle with the share of the work that is done at least; false stops, and the
/// solution then holds what there is. progress.errorBound bounds the linear system as the program sees it: its form
/// factors, not the right ones. Throws Error(badInput): no light at all, a reflectance above 1.
PublishedScene solveAsPublished(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                                const PublishedSceneSettings& settings, const std::function<bool(double)>& goOn);

}  // namespace lucerna
