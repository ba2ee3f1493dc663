// Visible surfaces for techniques that start from the camera's pixels: normals, turned to the viewer as in forward
// shading. The position is reconstructed from depth.
#include "lib/material.glsl"
centroid in vec3 vNormal;
centroid in vec2 vTexCoord;
layout(location = 0) out vec4 outNormal;

void main() {
  if (materialCutOut(vTexCoord)) discard;
  outNormal = vec4(normalize(gl_FrontFacing ? vNormal : -vNormal), 0.0);
}
