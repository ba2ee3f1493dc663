// Shadow rays between patches and lights, through the path tracer's hierarchy. x: rays.
layout(local_size_x = 64) in;
#include "rays/bvh.glsl"
struct LightRay {
  vec4 origin;     // in the hierarchy's space; w: the patch it starts from, which is ignored
  vec4 direction;  // to the light, its length the distance
  vec4 normal;     // of the patch; w: its largest coordinate
};
layout(std430, binding = 1) readonly buffer Rays { LightRay rays[]; };
layout(std430, binding = 2) writeonly buffer Blocked { uint blocked[]; };
uniform int rayCount;

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= rayCount) return;
  LightRay r = rays[index];
  Ray ray;
  ray.origin = offsetRay(r.origin.xyz, r.normal.xyz, r.normal.w);
  ray.tMin = 0.0;
  ray.direction = r.direction.xyz + (r.origin.xyz - ray.origin);
  ray.tMax = 1.0;
  blocked[index] = anyHitToLamp(ray, uint(r.origin.w)) ? 1u : 0u;  // bounded: a patch's number
}
