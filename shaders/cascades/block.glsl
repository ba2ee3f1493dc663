// The uniform block of the cascades and the format of their 3D textures, in which all cascades are stacked along z:
// cascade k has the layers k * cells .. (k + 1) * cells - 1.
#include "shared/bindings.h"
#include "shared/cascades.h"
layout(std140, binding = BLOCK_CASCADES) uniform CascadeBlock { CascadeConstants grids; };

#if GRID_FULL_FLOAT
#define GRID_FORMAT rgba32f
#else
#define GRID_FORMAT rgba16f
#endif
