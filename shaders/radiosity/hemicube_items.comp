// Item buffer, second pass: copies its layers to one row of pixels per hemicube, the layout of the other methods, and
// sums each patch's share of the hemisphere (hemicube_keep.glsl). x, z: pixels, y: hemicubes of the batch.
#include "radiosity/hemicube.glsl"
#include "radiosity/hemicube_keep.glsl"

layout(local_size_x = 64) in;
layout(binding = 56) uniform usampler2DArray drawn;       // one layer per face, half faces in the upper half
layout(binding = 58) uniform samplerBuffer deltaFactors;  // the full face, then one half face
layout(std430, binding = 2) writeonly buffer Items { uint items[]; };

void main() {
  int pixel = int(gl_GlobalInvocationID.x + gl_GlobalInvocationID.z * gl_NumWorkGroups.x * 64u),
      hemicube = int(gl_WorkGroupID.y);
  if (pixel >= pixelsPerHemicube()) return;
  ivec3 place = placeOf(pixel);
  uint item =
      texelFetch(drawn, ivec3(place.y, place.z + (place.x == 0 ? 0 : faceSize / 2), 5 * hemicube + place.x), 0).x;
  items[hemicube * pixelsPerHemicube() + pixel] = item;
  float delta = texelFetch(deltaFactors, pixel - facePixels(place.x) + (place.x == 0 ? 0 : 2 * halfFacePixels)).x;
  if (item > 0u) keep(hemicube, int(item) - 1, delta);
}
