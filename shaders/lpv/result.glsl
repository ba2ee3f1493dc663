// Where the result is written: a buffer, all red, then green, then blue, from which the engine copies it to the
// textures that the lookup filters. llvmpipe takes forty times as long to store a texel to an image as to store it to a
// buffer and copy it.
#include "lpv/storage.glsl"
#if GRID_FULL_FLOAT
layout(std430, binding = 1) writeonly buffer Result { vec4 texels[]; };
vec4 asTexel(vec4 value) { return toTexel(value); }
#else
layout(std430, binding = 1) writeonly buffer Result { uvec2 texels[]; };
uvec2 asTexel(vec4 value) {
  vec4 rounded = toTexel(value);
  return uvec2(packHalf2x16(rounded.xy), packHalf2x16(rounded.zw));
}
#endif
