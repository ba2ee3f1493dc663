// Reflective shadow map of an orthographic light [Dachsbacher2005]: each texel is a virtual point light.
// Flux = E * albedo * A_texel, in watts, A_texel the texel's area across the rays. No N.L: the tilt of a surface is already in
// the number of texels that it covers (the published text multiplies by it: twice the cosine).
#include "lib/frame.glsl"
#include "lib/material.glsl"
in vec3 vPosition;
in vec3 vNormal;
in vec2 vTexCoord;
layout(location = 0) out vec4 outPosition;  // world; w = 1 marks a surface, 0 background
layout(location = 1) out vec4 outNormal;    // unit, towards the light; w = cosine to it
layout(location = 2) out vec4 outFlux;      // reflected flux of the texel, RGB
uniform float texelArea;                    // world units squared, across the rays

void main() {
  if (materialCutOut(vTexCoord)) discard;
  vec3 normal = normalize(gl_FrontFacing ? vNormal : -vNormal);
  float cosine = -dot(normal, frame.sunDirection);
  if (cosine < 0.0) {  // an interpolated normal may turn away from the light where the face does not
    normal = -normal;
    cosine = -cosine;
  }
  outPosition = vec4(vPosition, 1.0);
  outNormal = vec4(normal, cosine);
  outFlux = vec4(frame.sunIrradiance * materialAlbedo(vTexCoord) * texelArea, 0.0);
#if FLUX_COSINE
  outFlux *= cosine;  // deviation rsm.flux-cosine
#endif
}
