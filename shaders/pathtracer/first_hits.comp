// Depth of what pixels' centres show, for earlier frames of a view in motion (forward/reproject.frag).
layout(local_size_x = 8, local_size_y = 8) in;
#include "shared/path_tracer.h"
layout(std140, binding = 0) uniform PathBlock { PathConstants tracer; };
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "rays/materials.glsl"
#include "rays/bvh.glsl"
#include "rays/view.glsl"
#include "pathtracer/seen.glsl"

layout(r32f, binding = 0) restrict writeonly uniform image2D depths;  // 0 to 1; 1: nothing
uniform ivec2 firstPixel;
uniform mat4 clipFromCamera;  // from places relative to the camera

void main() {
  ivec2 pixel = firstPixel + ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, tracer.picture.xy))) return;
  vec3 origin, direction;
  viewRay(vec2(pixel) + 0.5, origin, direction);
  Seen seen = seenAlong(origin, direction);
  float depth = 1.0;
  if (seen.place.w > 0.0) {
    vec4 clip = clipFromCamera * vec4(origin - tracer.cameraPosition + direction / seen.place.w, 1.0);
    depth = clamp(0.5 * clip.z / clip.w + 0.5, 0.0, 1.0);
  }
  imageStore(depths, pixel, vec4(depth));
}
