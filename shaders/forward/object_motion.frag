// See engine/forward/object_motion.hpp.
#include "shared/bindings.h"
in vec4 vNow;
in vec4 vBefore;
#if ALPHA_MASK
centroid in vec2 vTexCoord;
layout(binding = UNIT_MASK) uniform sampler2D maskTexture;
#endif
layout(location = 0) out vec4 motion;

void main() {
#if ALPHA_MASK
  if (texture(maskTexture, vTexCoord).r < 0.5) discard;
#endif
  motion = vec4(vBefore.xy / vBefore.w - vNow.xy / vNow.w, vBefore.w / vNow.w, 1.0);
}
