// Surfaces with direct light and emission alone.
#define INDIRECT 0
#include "forward/surface.glsl"
