// Displays a radiosity solution: albedo and texture times irradiance, plus emission. Output: radiance, linear, scene
// units. A back without a patch of its own is black.
#include "lib/frame.glsl"
#include "lib/material.glsl"
const float kPi = 3.14159265358979;
#if SPECULAR
#include "lib/material_coat.glsl"
#include "lib/coat_reflection.glsl"
#endif
centroid in vec3 vPosition;
centroid in vec3 vIrradiance;
centroid in vec2 vTexCoord;
centroid in vec3 vCorner;
#if INSPECTED
flat in int vPatch;
#include "forward/inspected.glsl"
#endif
#if DIRECT_RAYS
#include "radiosity/direct_rays.glsl"
centroid in vec3 vNormal;
flat in vec3 vFace;
flat in vec2 vFacePlace;
#endif
#if EMISSION
#include "lib/emission.glsl"
#endif
layout(location = 0) out vec4 radiance;

void main() {
  vec3 albedo = materialAlbedo(vTexCoord);
#if DIRECT_RAYS
  DirectReflection reflected = DirectReflection(albedo, albedo / kPi);
#endif
#if SPECULAR
  // Light of patches and emissive surfaces is reflected as if matt, that of lamps as it is.
  Coat coat = materialCoat(vTexCoord);
  albedo = wholeReflectance(coat, albedo);
#if DIRECT_RAYS
  reflected.matt = albedo / kPi;
  if (!(coat.alpha > 0.0)) reflected.base = albedo;
#endif
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
    result = albedo * vIrradiance / kPi;
#if DIRECT_RAYS
    vec3 toCamera = normalize(eyeOf(vPosition) - vPosition);
    result += directRadiance(vPosition, normal, vFace, vFacePlace.x, vFacePlace.y,
#if SPECULAR
                             coat,
#endif
                             toCamera, reflected);
#endif
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
