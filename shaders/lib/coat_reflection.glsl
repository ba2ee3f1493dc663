// What a surface with a coat reflects of one direction's light: reflected radiance per irradiance. Needs kPi.
#include "lib/coat.glsl"
#include "lib/ggx.glsl"
#include "lib/tangent.glsl"

// albedo: of the base. A mirror or glass (alpha 0) has no coat to look up.
vec3 coatedReflection(Coat coat, vec3 albedo, vec3 normal, vec3 toCamera, vec3 toLight) {
  vec3 reflected = albedo / kPi;
  if (coat.specular == vec3(0.0) || !(coat.alpha > 0.0)) return reflected;
  vec3 t, b;
  tangentFrame(normal, t, b);
  vec3 o = vec3(dot(toCamera, t), dot(toCamera, b), dot(toCamera, normal)),
       i = vec3(dot(toLight, t), dot(toLight, b), dot(toLight, normal));
  float density, facets = ggxReflect(o, i, coat.alpha, density);
  reflected *= coatTransmission(coat, o.z, i.z);
  if (facets > 0.0) reflected += facets / i.z * coatFresnel(coat, max(dot(o, normalize(o + i)), 0.0));
  return reflected;
}
