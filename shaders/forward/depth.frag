// Cut-out meshes cast the shadow of their mask; opaque ones need no fragment work.
#include "shared/bindings.h"
#if ALPHA_MASK
centroid in vec2 vTexCoord;
layout(binding = UNIT_MASK) uniform sampler2D maskTexture;
#endif

void main() {
#if ALPHA_MASK
  if (texture(maskTexture, vTexCoord).r < 0.5) discard;
#endif
}
