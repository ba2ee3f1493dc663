// The block to which shading writes what lit the queried pixel. Only the visible surface may write: the depth test runs
// first.
#include "shared/asked.h"
layout(early_fragment_tests) in;
layout(std430, binding = ASKED_BINDING) writeonly buffer Asked { vec4 asked[]; };
