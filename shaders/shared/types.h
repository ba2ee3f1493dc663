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
// A uniform block ends at a multiple of 16 bytes; a buffer that ends before leaves its last members undefined.
#define SHARED_BLOCK(name) static_assert(sizeof(name) % 16 == 0, #name " ends in the middle of 16 bytes");
#else
#define SHARED_BEGIN
#define SHARED_END
#define SHARED_BLOCK(name)
#endif
