// Item buffer: three vertices per patch, one instance per hemicube; positions in the hemicube's frame.
#include "radiosity/hemicube.glsl"
out vec3 gPosition;
flat out ivec2 gPatch;  // and hemicube

void main() {
  gPatch = ivec2(gl_VertexID / 3, gl_InstanceID);
  gPosition = toFrame(frames[gl_InstanceID], patchCorner(gPatch.x, gl_VertexID % 3));
}
