// Allows a struct to be declared once and compiled by C++ (as GLM types) and by GLSL. std140: each vec3 is followed by
// a scalar.
#pragma once
#ifdef __cplusplus
#include <glm/glm.hpp>
namespace lucerna::shared {
using glm::ivec4;
using glm::uint;
using glm::mat4;
using glm::vec3;
using glm::vec4;
}  // namespace lucerna::shared
#define SHARED_BEGIN namespace lucerna::shared {
#define SHARED_END }
#else
#define SHARED_BEGIN
#define SHARED_END
#endif
