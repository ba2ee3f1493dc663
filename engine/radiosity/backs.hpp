// Which surfaces need a patch on each side.
//
// A patch has one side, so that closed bodies cost no patches inside. In other techniques surfaces emit and reflect on
// both sides. Here a triangle gets a second, opposite patch where its back matters: a back that a lamp or a patch that
// emits lights, the back of one that emits where it lights something, and backs that these see. So lamps and rooms may
// be wound either way. What is hidden inside of solids (hidden_parts.hpp) neither lights nor is lit. The sky makes no
// backs: under it every floor would have two sides.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "radiosity/patches.hpp"
#include "rays/ray_scene.hpp"

namespace lucerna {

/// Adds them after the others, and cuts patches close behind lamps among them; mesh: without hidden parts.
void addBacks(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, RadiosityMesh& mesh,
              const PatchSettings& settings);

/// cutHiddenParts() as if there were no backs but those of lamps: what is hidden in a wall that is open somewhere, and
/// so has backs, is hidden all the same, but a ceiling behind a lamp is not. `rays`: of sceneOf(mesh).
void cutHiddenPartsOfFronts(const gl::Context& context, gl::ProgramLibrary& programs, const RayScene& rays,
                            RadiosityMesh& mesh);

}  // namespace lucerna
