// For tests: draws a lamp of the hierarchy for each position and normal; and the probability of each draw without the
// normal, from its leaf. Random words are hashes of the number.
layout(local_size_x = 64) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
struct LightPick {
  uint light;
  float probability;
  float balance;
};
#include "rays/light_hierarchy.glsl"
layout(std430, binding = 0) readonly restrict buffer Inputs { vec4 inputs[]; };  // position; normal
layout(std430, binding = 1) writeonly restrict buffer Outputs { uvec4 outputs[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (2u * i >= uint(inputs.length())) return;
  vec3 position = inputs[2u * i].xyz;
  LightPick picked = drawLamp(pcg4d(uvec4(i, 0u, 0u, 0u)), position, inputs[2u * i + 1u].xyz);
  uint leaf = 0u;
  while (lampOfLeaf(leaf).x != picked.light) ++leaf;  // ends: every lamp has a leaf
  outputs[i] = uvec4(picked.light, floatBitsToUint(picked.probability), floatBitsToUint(picked.balance),
                     floatBitsToUint(lampProbability(leaf, position)));
}
