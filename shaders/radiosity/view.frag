// Displays a radiosity solution: albedo and texture times irradiance, plus emission. Output: radiance, linear, scene
// units. A back without a patch of its own is black.
#include "lib/frame.glsl"
#include "lib/material.glsl"
#if SPECULAR
#include "lib/material_coat.glsl"
#endif
const float kPi = 3.14159265358979;
in vec3 vPosition;
in vec3 vIrradiance;
in vec2 vTexCoord;
in vec3 vCorner;
#if INSPECTED
flat in int vPatch;
#include "forward/inspected.glsl"
#endif
#if DIRECT_RAYS
#include "radiosity/direct_rays.glsl"
in vec3 vNormal;
flat in vec3 vFace;
flat in vec2 vFacePlace;
#endif
#if EMISSION
#include "lib/emission.glsl"
#endif
layout(location = 0) out vec4 radiance;

void main() {
  vec3 albedo = materialAlbedo(vTexCoord);
#if SPECULAR
  albedo = wholeReflectance(materialCoat(vTexCoord), albedo);
#endif
#if EMISSION
  vec3 emitted = materialEmitted(vTexCoord);
#endif
#if DIRECT_RAYS
  // If shading normals are missing or face away, the face's own normal is used, as in the solution.
  vec3 normal = materialNormal(dot(vNormal, vFace) > 0.0 ? normalize(vNormal) : vFace, vPosition, vTexCoord);
#endif
#if MESH
  vec3 width = fwidth(vCorner);
#endif
  if (materialCutOut(vTexCoord)) discard;
  vec3 result = vec3(0.0);
  if (gl_FrontFacing) {
    vec3 irradiance = vIrradiance;
#if DIRECT_RAYS
    irradiance += directIrradiance(vPosition, normal, vFace, vFacePlace.x, vFacePlace.y, albedo / kPi);
#endif
    result = albedo * irradiance / kPi;
#if EMISSION
    result += emitted;
#endif
#if INSPECTED
    record(INSPECTED_POSITION, vec4(vPosition, 1.0));
    record(INSPECTED_ALBEDO, vec4(albedo, 0.0));
    record(INSPECTED_RADIANCE, vec4(result, 0.0));
    record(INSPECTED_INDIRECT, vec4(vIrradiance, 0.0));
    record(INSPECTED_CORNERS, vec4(vCorner, float(vPatch)));
#if EMISSION
    record(INSPECTED_EMISSION, vec4(emitted, 0.0));
#endif
#endif
  }
#if MESH
  vec3 inside = smoothstep(0.5 * width, 1.5 * width, vCorner);
  float line = 1.0 - min(inside.x, min(inside.y, inside.z));
  result = mix(result, vec3(0.0, 0.35, 0.6) / frame.exposure, 0.6 * line);
#endif
  radiance = vec4(result, 1.0);
}
