#include "scene/coat.hpp"

#include "shared/coat.h"
#include "support/coat_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

// Against an integral over the facets as they are distributed rather than as they are seen.
TEST(Coat, AlbedosAreIntegralsOfTheLobe) {
  for (const double alpha : {0.02, 0.1, 0.4, 1.0}) {
    const reference::CoatedSurface all(glm::dvec3(0.0), glm::dvec3(1.0), alpha),
        some(glm::dvec3(0.0), glm::dvec3(0.25), alpha);
    for (const double cosine : {0.05, 0.3, 0.7, 1.0}) {
      const CoatReflectance e = coatReflectance(cosine, alpha);
      EXPECT_NEAR(e.facets, all.albedo(cosine).x, 1e-3) << alpha << " " << cosine;
      EXPECT_NEAR(0.25 * e.facets + 0.75 * e.grazing, some.albedo(cosine).x, 1e-3) << alpha << " " << cosine;
    }
    EXPECT_NEAR(meanCoatReflectance(glm::vec3(1.0f), static_cast<float>(alpha)).x, all.meanAlbedo().x, 1e-3) << alpha;
  }
}

TEST(Coat, TheTableIsReadBetweenItsRows) {
  for (const double alpha : {0.003, 0.07, 0.33, 0.8}) {
    const reference::CoatedSurface coat(glm::dvec3(0.0), glm::dvec3(0.04), alpha);
    EXPECT_NEAR(meanCoatReflectance(glm::vec3(0.04f), static_cast<float>(alpha)).x, coat.meanAlbedo().x, 5e-4) << alpha;
  }
}

// Schlick's term over the hemisphere's cosine is F0 + (1 - F0) / 21.
TEST(Coat, ASmoothCoatHasFresnelsMean) {
  EXPECT_NEAR(meanCoatReflectance(glm::vec3(0.04f), 0.0f).x, 0.04 + 0.96 / 21.0, 2e-4);
}

TEST(Coat, WithoutReflectanceThereIsNone) {
  EXPECT_EQ(meanCoatReflectance(glm::vec3(0.0f), 0.3f), glm::vec3(0.0f));
  Material material;
  EXPECT_FALSE(hasCoat(material));
  EXPECT_EQ(wholeReflectance(material), material.diffuse);
  material.specular = glm::vec3(0.001f);
  EXPECT_TRUE(hasCoat(material));
  EXPECT_NEAR(wholeReflectance(material).x, 0.5, 3e-3);  // goes to none without a step
}

TEST(Coat, KdStaysWhatIsReflectedDiffusely) {
  const glm::vec3 base = baseUnderCoat({0.6f, 0.5f, 0.9f}, {0.04f, 0.5f, 0.5f});
  EXPECT_FLOAT_EQ(base.x, 0.625f);
  EXPECT_FLOAT_EQ(base.y, 1.0f);
  EXPECT_FLOAT_EQ(base.z, 1.0f);  // a surface reflects no more than arrives
  EXPECT_FLOAT_EQ(alphaOfExponent(0.0f), 1.0f);
  EXPECT_FLOAT_EQ(alphaOfExponent(198.0f), 0.1f);
}

}  // namespace
}  // namespace lucerna
