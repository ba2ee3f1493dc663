// A radiosity solution: the albedo, its texture modulated by the light, and what the surface emits. Output: radiance, linear, scene units.
// A patch's back sends nothing.
#include "lib/frame.glsl"
#include "lib/material.glsl"
const float kPi = 3.14159265358979;
in vec3 vPosition;
in vec3 vIrradiance;
in vec2 vTexCoord;
in vec3 vCorner;
layout(location = 0) out vec4 radiance;
#if EMISSION
uniform vec3 materialEmission;
#endif

void main() {
  if (materialCutOut(vTexCoord)) discard;
  vec3 result = vec3(0.0);
  if (gl_FrontFacing) {
    result = materialAlbedo(vTexCoord) * vIrradiance / kPi;
#if EMISSION
    result += materialEmission;
#endif
  }
#if MESH
  vec3 width = fwidth(vCorner);
  vec3 inside = smoothstep(0.5 * width, 1.5 * width, vCorner);
  float line = 1.0 - min(inside.x, min(inside.y, inside.z));
  result = mix(result, vec3(0.0, 0.35, 0.6) / frame.exposure, 0.6 * line);
#endif
  radiance = vec4(result, 1.0);
}
