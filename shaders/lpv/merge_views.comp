// Merges the surfaces seen by another view into the geometry volume. Per cell the longer coefficient vector wins
// [LPV2015, 5.2], so that a surface in both views counts once. A surface may be cut by a view's edge or be partly
// hidden; the longer vector belongs to the view that saw more of it.
#include "cascades/block.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform sampler3D viewPotential;
layout(binding = 0, rgba32f) uniform image3D potential;
#if REFLECTS
layout(binding = 1) uniform sampler3D viewReflectance;
layout(binding = 1, rgba32f) writeonly uniform image3D reflectance;
#endif

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(at, textureSize(viewPotential, 0)))) return;
  vec4 other = texelFetch(viewPotential, at, 0), own = imageLoad(potential, at);
  if (dot(other, other) <= dot(own, own)) return;
  imageStore(potential, at, other);
#if REFLECTS
  imageStore(reflectance, at, texelFetch(viewReflectance, at, 0));
#endif
}
