// The texels of a reflective shadow map that one invocation adds up: a tile of TILE x TILE (4; 1: an atomic a light, as
// published), to and fro, so that those that follow each other are neighbours and mostly fall into the same cell. What
// they bring is summed as long as they do, and only then added to the cell by atomics.
const int kTile = TILE;
ivec3 texelOfTile(ivec3 tile, int i) {
  int y = i / kTile, x = i % kTile;
  return ivec3(kTile * tile.xy + ivec2((y & 1) == 0 ? x : kTile - 1 - x, y), tile.z);
}

// Words of a buffer that counts in place of what it will hold: FILL_FIXED in integer steps, else in floats.
#if FILL_FIXED
#define COUNT_TYPE ivec4
#define WORD_TYPE int
#define STEPS(value, steps) ivec4(round((value) * (steps)))
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
