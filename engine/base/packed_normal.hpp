#pragma once

#include <glm/glm.hpp>

#include <cstdint>

namespace lucerna {

/// A unit vector on an octahedron unfolded to a square [Cigolle2014], as GLSL's packSnorm2x16.
std::uint32_t packNormal(const glm::dvec3& normal);
glm::dvec3 unpackNormal(std::uint32_t packed);

}  // namespace lucerna
