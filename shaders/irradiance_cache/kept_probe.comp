// For tests: colours of kept hits, packed and unpacked again, one invocation per colour.
layout(local_size_x = 64) in;
#include "lib/clamped_int.glsl"
#include "irradiance_cache/kept.glsl"
layout(std430, binding = 0) readonly restrict buffer Inputs { vec4 inputs[]; };
layout(std430, binding = 1) writeonly restrict buffer Outputs { vec4 outputs[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(inputs.length())) return;
  uint word = packColour(inputs[i].rgb);
  outputs[i] = vec4(unpackColour(word), uintBitsToFloat(word));
}
