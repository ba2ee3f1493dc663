// Faces in their colour, multiplied by a texture if they have one [RAD2008 figure 4.3]. Edges of the mesh have their
// own colour, blended manually with the face's.
#include "shared/bindings.h"
in vec3 shown;
uniform vec4 edge;  // colour and opacity
layout(location = 0) out vec4 displayColor;
#if TEXTURED
in vec2 picturePlace;
layout(binding = UNIT_DIFFUSE) uniform sampler2D picture;
#endif

void main() {
  vec3 colour = shown;
#if TEXTURED
  colour *= texture(picture, picturePlace).rgb;
#endif
  displayColor = vec4(mix(colour, edge.rgb, edge.a), 1.0);
}
