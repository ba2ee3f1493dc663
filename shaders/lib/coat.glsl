// The coat of a surface: how much light it reflects, and how much it lets through to the Lambertian base below
// (engine/scene/coat.hpp has the model and its sources).
#include "shared/bindings.h"
#include "shared/coat.h"
layout(binding = UNIT_COAT) uniform sampler2D coatTable;

struct Coat {
  vec3 specular;  // reflectance at normal incidence; 0: no coat
  float alpha;    // GGX, at least COAT_LEAST_ALPHA
};

// Reflectance at grazing incidence.
float coatGrazing(vec3 specular) { return min(50.0 * max(specular.x, max(specular.y, specular.z)), 1.0); }

// Schlick's term; cosine: of a direction to the facet's normal.
vec3 coatFresnel(Coat coat, float cosine) {
  float m = 1.0 - cosine, m2 = m * m;
  return coat.specular + (coatGrazing(coat.specular) - coat.specular) * (m2 * m2 * m);
}

// Directional albedo at the cosine to the normal, and its mean.
vec3 coatAlbedo(Coat coat, float cosine, out vec3 mean) {
  vec2 size = vec2(COAT_COSINES, COAT_ALPHAS);
  vec4 e = textureLod(coatTable, (vec2(max(cosine, 0.0), sqrt(coat.alpha)) * (size - 1.0) + 0.5) / size, 0.0);
  float grazing = coatGrazing(coat.specular);
  mean = coat.specular * (e.z - e.w) + grazing * e.w;
  return coat.specular * (e.x - e.y) + grazing * e.y;
}
vec3 coatAlbedo(Coat coat, float cosine) {
  vec3 mean;
  return coatAlbedo(coat, cosine, mean);
}

// A surface's albedo where light comes from all sides and leaves to all.
vec3 wholeReflectance(Coat coat, vec3 base) {
  if (coat.specular == vec3(0.0)) return base;
  vec3 mean;
  coatAlbedo(coat, 1.0, mean);
  return mean + (1.0 - mean) * base;
}

// Part of Lambert's reflection by the base that is left below the coat, for cosines of both directions.
vec3 coatTransmission(Coat coat, float cosineOut, float cosineIn) {
  vec3 mean, there = coatAlbedo(coat, cosineOut, mean);
  return (1.0 - there) * (1.0 - coatAlbedo(coat, cosineIn)) / max(1.0 - mean, vec3(1e-6));
}
