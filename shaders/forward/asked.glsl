// The block into which shading writes what lit the pixel that is asked for. Only the surface that is seen may write:
// the depth test comes first.
#include "shared/asked.h"
layout(early_fragment_tests) in;
layout(std430, binding = ASKED_BINDING) writeonly buffer Asked { vec4 asked[]; };
