// What the camera sees, for techniques that start from its pixels: normals, turned to the viewer as forward shading
// turns them. Depth gives the position.
#include "lib/material.glsl"
in vec3 vNormal;
in vec2 vTexCoord;
layout(location = 0) out vec4 outNormal;

void main() {
  if (materialCutOut(vTexCoord)) discard;
  outNormal = vec4(normalize(gl_FrontFacing ? vNormal : -vNormal), 0.0);
}
