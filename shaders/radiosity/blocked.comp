// Whether anything lies between the two ends of a ray, triangle by triangle [Moller1997]: for the few rays of direct light.
// x: rays. Triangles firstTriangle..lastTriangle - 1; results add up over dispatches.
#include "radiosity/patch.glsl"
layout(local_size_x = 64) in;
struct Ray {
  vec4 origin;     // w: the patch that it starts from, not looked at
  vec4 direction;  // to the light, its length the distance
};
layout(std430, binding = 1) readonly buffer Rays { Ray rays[]; };
layout(std430, binding = 2) buffer Blocked { uint blocked[]; };
uniform int rayCount, firstTriangle, lastTriangle;

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= rayCount) return;
  Ray ray = rays[index];
  int self = int(ray.origin.w);
  bool hit = false;
  for (int i = firstTriangle; i < lastTriangle; ++i) {
    vec3 a = patchCorner(i, 0), ab = patchCorner(i, 1) - a, ac = patchCorner(i, 2) - a;
    vec3 p = cross(ray.direction.xyz, ac);
    float det = dot(ab, p);
    vec3 s = ray.origin.xyz - a;
    float u = dot(s, p) / det;
    vec3 q = cross(s, ab);
    float v = dot(ray.direction.xyz, q) / det, t = dot(ac, q) / det;
    hit = hit || (i != self && det != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-5 && t < 0.99999);
  }
  if (hit) blocked[index] = 1u;
}
