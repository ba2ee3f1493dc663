// Parts of patches that lie inside something: a floor continues under a column, a beam inside the wall that it rests
// on.
//
// A patch has one exitance. Averaging in hidden area would darken the patch wherever it is visible (Sponza at edges of
// a 37th of its size: a tenth of the sunlight seen from the gallery). So hidden parts are cut.
//
// A part is hidden if walks from it soon end on a back. In numbers: its openness is the mean, over eight directions, of
// the openness of what is seen there, 0 for a back. Inside solids it falls to 0. In the open it does not, except close
// behind a one-sided sheet, where there is hardly any light either. A part that sees nothing at all in any of its
// directions sees out, so it is not inside anything: openness 1. Hidden parts have less than 0.3 of the most open part
// of their patch; a patch whose most open part has less than 0.3 stays whole.
#pragma once

#include "gl/program.hpp"
#include "radiosity/patches.hpp"
#include "rays/ray_scene.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace lucerna {

/// What a ray from a part of a patch meets.
class PartMet {
 public:
  explicit PartMet(std::uint32_t bits) : bits_(bits) {}
  bool isNothing() const { return bits_ == 0; }
  bool isBack() const { return (bits_ & kBack) != 0; }
  bool isFront() const { return !isNothing() && !isBack(); }
  std::uint32_t patch() const { return isBack() ? bits_ & ~kBack : (bits_ - 1) / kParts; }
  std::size_t part() const { return (bits_ - 1) % kParts; }  ///< of a front
  std::size_t place() const { return bits_ - 1; }  ///< of a front, among all parts of all patches

 private:
  static constexpr std::uint32_t kBack = 0x80000000u;  ///< shaders/radiosity/hidden_parts.comp
  static constexpr std::uint32_t kParts = kPatchParts * kPatchParts;
  std::uint32_t bits_;
};

enum class PatchSide { front, back };

/// `raysEach` cosine-distributed rays from each part of `patches`, on one side of them. `rays`: of sceneOf(mesh).
std::vector<PartMet> metFromParts(gl::ProgramLibrary& programs, const RayScene& rays, const RadiosityMesh& mesh,
                                  std::span<const std::uint32_t> patches, std::size_t raysEach, PatchSide side);
/// Openness of all parts of all patches, 0 to 1.
std::vector<float> opennessOfParts(gl::ProgramLibrary& programs, const RayScene& rays, const RadiosityMesh& mesh);
/// The parts of a patch that are hidden, a bit each; `mostOpen`: of the parts that they are compared with.
std::uint16_t hiddenOf(std::span<const float> openness, float mostOpen);

/// Sets `hidden` of patches; area and centroid become those of the rest. `rays`: of sceneOf(mesh). Returns the area
/// cut, scene units squared.
double cutHiddenParts(gl::ProgramLibrary& programs, const RayScene& rays, RadiosityMesh& mesh);

}  // namespace lucerna
