// Parts of patches that lie inside of something: a floor goes on under a column, a beam inside of the wall that it rests on.
//
// A patch has one exitance. Were hidden parts counted, it would be the mean with what nobody sees, and too dark wherever it is seen (Sponza at edges of a 37th of
// its size: a tenth of the sunlight seen from the gallery). So patches are cut to the parts that take part.
//
// A part is hidden where walks from it soon end on a back, in numbers: its openness is the mean, over eight directions, of the openness of what is seen there, 0 for a
// back. Inside of solids it falls to 0. In the open it does not, but for places close behind a sheet of one side, which get hardly any light either. What sees
// nothing at all in any of its directions sees out, so is inside of nothing: openness 1. Hidden is what has less than 0.3 of the most open part of its own patch; a
// patch whose most open part has less than 0.3 stays whole.
#pragma once

#include "gl/program.hpp"
#include "pathtracer/ray_scene.hpp"
#include "radiosity/patches.hpp"

namespace lucerna {

/// Sets `hidden` of patches; their area and centroid become those of the rest. `rays`: of sceneOf(mesh). Returns the area that was cut, scene units squared.
double cutHiddenParts(gl::ProgramLibrary& programs, const RayScene& rays, RadiosityMesh& mesh);

}  // namespace lucerna
