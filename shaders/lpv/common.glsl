// The light propagation volume's uniform block and storage format. All cascades share one 3D texture, stacked along z:
// cascade k has the layers k * cells .. (k + 1) * cells - 1. The geometry volume's cells are centred on the grid's
// corners, so it has cells + 1 per side.
#include "shared/bindings.h"
#include "shared/lpv.h"
layout(std140, binding = BLOCK_LPV) uniform LpvBlock { LpvConstants lpv; };

#if LPV_FULL_FLOAT
#define LPV_FORMAT rgba32f
#else
#define LPV_FORMAT rgba16f
#endif
