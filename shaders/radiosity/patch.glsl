// Patches as the visibility passes read them: nine floats a patch, corner by corner.
layout(std430, binding = 0) readonly buffer Corners { float corners[]; };
uniform int patchCount;

vec3 patchCorner(int patchIndex, int k) {
  int at = 9 * patchIndex + 3 * k;
  return vec3(corners[at], corners[at + 1], corners[at + 2]);
}
