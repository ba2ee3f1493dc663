// Reflective shadow map [Dachsbacher2005]: each texel is a virtual point light. Its flux, in watts, is the light that
// enters the texel times the albedo. There is no N.L: the number of texels that a surface covers already accounts for
// its tilt (the published text multiplies by N.L, which applies the cosine twice).
// Sun: flux = E * albedo * A, A the texel's area across the rays. Surface area: A / cos.
// Spot and omnidirectional: flux = I(omega) * albedo * dOmega. A texel of width w at depth 1, seen at the angle psi to
// the view's axis, lies at the distance 1 / cos psi and is tilted by psi: dOmega = w^2 cos psi / (1 / cos psi)^2 = w^2
// cos^3 psi, exact to second order in w (the corner form, four arctangents, loses more than that to rounding). Surface
// area: d^2 dOmega / cos.
// Normal maps are not read here: a texel's area follows from the mesh's own normal, and flux does not depend on it. The
// cosine in an area is bounded below by 1/20, since the few texels on a surface seen edge-on say little about its area.
#if !PERSPECTIVE
#include "lib/frame.glsl"
#endif
#include "lib/material.glsl"
#if SPECULAR
#include "lib/material_coat.glsl"
#endif
#include "lib/spot.glsl"
#if HAZE
#include "lib/haze.glsl"
#endif
in vec3 vPosition;
in vec3 vNormal;
in vec2 vTexCoord;
layout(location = 0) out vec4 outPosition;  // world; w = 1 marks a surface, 0 background
layout(location = 1) out vec4 outNormal;    // unit, towards the light; w = cosine to it
// reflected flux of the texel, RGB; w = surface area in it, world units squared
layout(location = 2) out vec4 outFlux;
#if ALBEDO
layout(location = 3) out vec4 outAlbedo;    // of the surface, linear; for multiple bounces
#endif
#if PERSPECTIVE
uniform vec3 lightPosition;
uniform vec3 lightIntensity;  // W/sr
uniform float lightTangent;   // of half a view's opening angle
uniform float texelWidth;     // at depth 1
#if LAYERS == 1
uniform vec3 lightDirection;  // of a spot
uniform float cosInner;
uniform float cosOuter;
#endif
#else
uniform float texelArea;      // world units squared, across the rays
#endif

void main() {
  vec3 albedo = materialAlbedo(vTexCoord);
#if SPECULAR
  albedo = wholeReflectance(materialCoat(vTexCoord), albedo);
#endif
  if (materialCutOut(vTexCoord)) discard;
  vec3 normal = normalize(gl_FrontFacing ? vNormal : -vNormal);
#if PERSPECTIVE
  vec3 away = lightPosition - vPosition;
  float distance2 = dot(away, away);
  vec3 toLight = away * inversesqrt(max(distance2, 1e-30));  // a surface point inside the lamp: no area rather than NaN
  vec2 atDepth1 = gl_FragCoord.xy * texelWidth - lightTangent;
  float cosAxis = inversesqrt(1.0 + dot(atDepth1, atDepth1));
  float solidAngle = texelWidth * texelWidth * cosAxis * cosAxis * cosAxis;
  float across = distance2 * solidAngle;
  vec3 incoming = lightIntensity * solidAngle;
#if LAYERS == 1
  incoming *= spotFalloff(-dot(toLight, lightDirection), cosInner, cosOuter);
#endif
#else
  vec3 toLight = -frame.sunDirection;
  float across = texelArea;
  vec3 incoming = frame.sunIrradiance * texelArea;
#if HAZE
  incoming *= hazeTransmittance(vPosition, toLight);
#endif
#endif
  float cosine = dot(normal, toLight);
  if (cosine < 0.0) {  // an interpolated normal may face away from the light when the face does not
    normal = -normal;
    cosine = -cosine;
  }
  outPosition = vec4(vPosition, 1.0);
  outNormal = vec4(normal, cosine);
  outFlux = vec4(incoming * albedo, across / max(cosine, 0.05));
#if ALBEDO
  outAlbedo = vec4(albedo, 1.0);
#endif
#if FLUX_COSINE
  outFlux.rgb *= cosine;  // deviation rsm.flux-cosine
#endif
}
