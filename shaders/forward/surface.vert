// Transforms mesh vertices for the camera.
#include "lib/frame.glsl"
#include "lib/lamp_place.glsl"
invariant gl_Position;
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texCoord;
layout(location = 2) in vec3 normal;
centroid out vec3 vPosition;
centroid out vec3 vNormal;
centroid out vec2 vTexCoord;
centroid out float vTangentPlane;  // where the plane through the vertex and perpendicular to its normal lies along that

void main() {
  vPosition = position;
  vNormal = normal;
  vTexCoord = texCoord;
  vTangentPlane = dot(normal, position);
  gl_Position = drawnAt(position);
}
