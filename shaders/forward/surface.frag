// Forward shading: direct sunlight with a filtered shadow map, indirect light from the light propagation volume or gathered
// beforehand, emission.
// Output: radiance, linear, scene units. Lambert: L = albedo / pi * E. Specular: Blinn-Phong, normalised so that its energy
// does not depend on the exponent, (n + 8) / (8 pi) [AkenineMoller2018, section 9.8].
#include "lib/frame.glsl"
#include "lib/sh.glsl"
#include "lib/material.glsl"
#if INDIRECT
#include "lpv/lookup.glsl"
#endif
#if GATHERED
layout(binding = 7) uniform sampler2D gatheredIrradiance;  // w = 2: interpolation refused the pixel
#endif

in vec3 vPosition;
in vec3 vNormal;
in vec2 vTexCoord;
layout(location = 0) out vec4 radiance;

#if SPECULAR
uniform vec3 materialSpecular;
uniform float materialShininess;
#endif
#if EMISSION
uniform vec3 materialEmission;
#endif

#if DIRECT
layout(binding = 2) uniform sampler2DShadow shadowMap;

// Fraction of the sun that is seen: four bilinear comparisons, which make a 3x3 tent. Outside the map is lit.
float sunVisibility(vec3 position, vec3 normal) {
  vec4 clip = frame.sunClipFromWorld * vec4(position + normal * frame.shadowNormalOffset, 1.0);
  vec3 uvz = 0.5 * clip.xyz + 0.5;
  float d = 0.5 * frame.shadowTexelUv;
  float sum = texture(shadowMap, uvz + vec3(-d, -d, 0.0)) + texture(shadowMap, uvz + vec3(d, -d, 0.0)) +
              texture(shadowMap, uvz + vec3(-d, d, 0.0)) + texture(shadowMap, uvz + vec3(d, d, 0.0));
  return 0.25 * sum;
}
#endif

void main() {
  if (materialCutOut(vTexCoord)) discard;
  vec3 toCamera = normalize(frame.cameraPosition - vPosition);
  // Surfaces have two sides: the normal is turned to the viewer by the face's own side, not by the interpolated normal.
  vec3 normal = normalize(gl_FrontFacing ? vNormal : -vNormal);
  vec3 albedo = materialAlbedo(vTexCoord);
  vec3 result = vec3(0.0);
#if DIRECT
  float cosine = dot(normal, -frame.sunDirection);
  if (cosine > 0.0) {
    vec3 irradiance = frame.sunIrradiance * (cosine * sunVisibility(vPosition, normal));
    vec3 reflected = albedo / kPi;
#if SPECULAR
    vec3 halfway = normalize(toCamera - frame.sunDirection);
    reflected += materialSpecular * ((materialShininess + 8.0) / (8.0 * kPi) * pow(max(dot(normal, halfway), 0.0), materialShininess));
#endif
    result += reflected * irradiance;
  }
#endif
#if INDIRECT
  result += albedo / kPi * lpvIrradiance(vPosition, normal);
#endif
#if GATHERED
  vec4 gathered = texelFetch(gatheredIrradiance, ivec2(gl_FragCoord.xy), 0);
  result += albedo / kPi * gathered.rgb;
#endif
#if EMISSION
  result += materialEmission;
#endif
#if SHOW_REFUSED
  if (gathered.w > 1.5) result = vec3(1.0, 0.0, 0.0) / frame.exposure;
#endif
  radiance = vec4(result, 1.0);
}
