// Solves any scene with the published program (solver.hpp), as a solution that can be displayed and compared with
// others.
//
// The program has one channel, so it runs once each for red, green and blue, on the same triangles. Its files have no
// lights other than emissive triangles. Light that a triangle receives from the sun, lamps and sky (direct_light.hpp)
// is therefore reflected as the triangle's own emission.
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
  std::uint32_t mostSweeps = 7;  ///< per channel, unless nothing changes before; the published scene took as many
};

struct PublishedScene {
  RadiositySolution solution;  ///< scene units. fromEmitters is 0: the program does not separate it from other light
  std::array<std::uint32_t, 3> sweeps{};  ///< of red, green and blue
  std::size_t hemicubes = 0;
  std::size_t overflows = 0;  ///< exitances above 24 bits, whose upper bits were lost
  double exitanceOfStep = 0.0;  ///< W/m^2 per step of e and b
};

/// `goOn` is called after each triangle with a lower bound of the completed share of the work; false stops, and the
/// solution then holds the results so far. progress.errorBound bounds the error of the linear system as the program
/// sees it, with its own form factors instead of the correct ones. Throws Error(badInput) if there is no light at all,
/// or a reflectance is above 1.
PublishedScene solveAsPublished(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                                const PublishedSceneSettings& settings, const std::function<bool(double)>& goOn);

}  // namespace lucerna
