// The block to which shading writes what lit the inspected pixel. Only the visible surface may write: the depth test
// runs first. Only that pixel may: drivers may shade others for it, outside of the scissor, whose colours are dropped
// but whose writes are not.
#include "shared/inspected.h"
layout(early_fragment_tests) in;
// unordered Asked: of all draws only the visible fragment of the inspected pixel writes
layout(std430, binding = INSPECTED_BINDING) writeonly buffer Asked { vec4 asked[]; };
uniform ivec2 inspectedPixel;  // from the picture's lower left corner
bool isVisible = true;     // false: cut out
void record(int term, vec4 value) {
  if (isVisible && ivec2(gl_FragCoord.xy) == inspectedPixel && term < asked.length()) asked[term] = value;
}
