// For tests: form factors from points to triangles in isolation, one invocation per triangle.
layout(local_size_x = 64) in;
#include "radiosity/polygon.glsl"
// three per triangle, relative to the point; w unused
layout(std430, binding = 0) readonly restrict buffer Corners { vec4 corners[]; };
layout(std430, binding = 1) writeonly restrict buffer FormFactors { float formFactors[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < uint(formFactors.length()))
    formFactors[i] = pointToTriangle(corners[3u * i].xyz, corners[3u * i + 1u].xyz, corners[3u * i + 2u].xyz);
}
