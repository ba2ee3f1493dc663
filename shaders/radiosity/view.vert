// A patch's corner seen by the camera, with the irradiance there. litScene() lists three vertices per patch, so
// gl_VertexID is 3 * patch + corner.
#include "lib/frame.glsl"
#include "lib/lamp_place.glsl"
invariant gl_Position;
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texCoord;
#if DIRECT_RAYS
layout(location = 2) in vec3 normal;
// five floats per patch: normal, distance of its plane, largest coordinate
layout(std430, binding = 2) readonly buffer Faces { float faces[]; };
centroid out vec3 vNormal;
flat out vec3 vFace;
flat out vec2 vFacePlace;
#endif
layout(std430, binding = 0) readonly buffer Light { float irradiances[]; };  // three floats per corner
centroid out vec3 vPosition;
centroid out vec3 vIrradiance;
centroid out vec2 vTexCoord;
centroid out vec3 vCorner;  // barycentric
#if INSPECTED
flat out int vPatch;
#endif

void main() {
  int at = 3 * gl_VertexID;
  vPosition = position;
  vIrradiance = vec3(irradiances[at], irradiances[at + 1], irradiances[at + 2]);
  vTexCoord = texCoord;
  vCorner = vec3(gl_VertexID % 3 == 0, gl_VertexID % 3 == 1, gl_VertexID % 3 == 2);
#if INSPECTED
  vPatch = gl_VertexID / 3;
#endif
#if DIRECT_RAYS
  int face = 5 * (gl_VertexID / 3);
  vFace = vec3(faces[face], faces[face + 1], faces[face + 2]);
  vFacePlace = vec2(faces[face + 3], faces[face + 4]);
  vNormal = normal;
#endif
  gl_Position = drawnAt(position);
}
