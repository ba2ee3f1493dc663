// A camera in the constants that shaders/rays/view.glsl makes a picture's rays of.
#pragma once

#include "scene/scene.hpp"
#include "shared/path_tracer.h"

namespace lucerna {

/// `origin`: of the ray caster. `offset`: pixels by which all rays are moved, to the right and up.
void setView(shared::PathConstants& constants, const Camera& camera, const glm::dvec3& origin, glm::ivec2 size,
             const glm::dvec2& offset = glm::dvec2(0.0));

}  // namespace lucerna
