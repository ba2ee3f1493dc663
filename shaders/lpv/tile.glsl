// The texels of a reflective shadow map that one invocation sums: a tile of TILE x TILE (4; 1: one atomic per light, as
// published). The rows are traversed alternately left and right, so that successive texels are neighbours and mostly
// fall into the same cell. Contributions are summed while the cell stays the same and only then added to it by atomics.
#include "lib/clamped_int.glsl"
const int kTile = TILE;
ivec3 texelOfTile(ivec3 tile, int i) {
  int y = i / kTile, x = i % kTile;
  return ivec3(kTile * tile.xy + ivec2((y & 1) == 0 ? x : kTile - 1 - x, y), tile.z);
}

// Words of a buffer that accumulates in place: integer steps with FILL_FIXED, otherwise floats.
#if FILL_FIXED
#define COUNT_TYPE ivec4
#define WORD_TYPE int
#define STEPS(value, steps) clampedInt(round((value) * (steps)), ivec4(-0x40000000), ivec4(0x40000000))
#else
#define COUNT_TYPE vec4
#define WORD_TYPE float
#define STEPS(value, steps) (value)
#endif
#define ADD_TO(word, count)          \
  {                                  \
    atomicAdd(words[word], count.x); \
    atomicAdd(words[word + 1], count.y); \
    atomicAdd(words[word + 2], count.z); \
    atomicAdd(words[word + 3], count.w); \
  }
