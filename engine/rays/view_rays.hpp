// A camera in the constants that shaders/rays/view.glsl makes a picture's rays of.
#pragma once

#include "scene/scene.hpp"
#include "shared/path_tracer.h"

namespace lucerna {

/// `origin`: of the ray caster.
void setView(shared::PathConstants& constants, const Camera& camera, const glm::dvec3& origin, glm::ivec2 size);

}  // namespace lucerna
