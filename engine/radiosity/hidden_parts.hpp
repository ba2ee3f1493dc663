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

namespace lucerna {

/// Sets `hidden` of patches; area and centroid become those of the rest. `rays`: of sceneOf(mesh). Returns the area
/// cut, scene units squared.
double cutHiddenParts(gl::ProgramLibrary& programs, const RayScene& rays, RadiosityMesh& mesh);

}  // namespace lucerna
