// Where surfaces stand on each other: patches end there, and share no light across.
#include "radiosity/patches.hpp"
#include "support/radiosity_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace lucerna {
namespace {

using test::addBox;
using test::lambertian;
using test::SceneBuilder;

constexpr double kWide = 4.0;  // half the floor's length, in x

PatchSettings settingsWith(bool contacts, double edge = 0.6) {
  PatchSettings settings;
  settings.contacts = contacts;
  settings.longestEdge = edge;
  return settings;
}

/// A floor at y = 0 and what `stand` puts there.
template <class Stand>
Scene floorWith(const Stand& stand) {
  SceneBuilder builder;
  builder.plate({0, 0, 0}, {0, 0, kWide}, {2.0 * kWide, 0, 0}, lambertian(builder, 0.5));
  stand(builder, lambertian(builder, 0.5));
  return builder.scene();
}

std::vector<const Patch*> floorOf(const RadiosityMesh& mesh) {
  std::vector<const Patch*> floor;
  for (const Patch& patch : mesh.patches)
    if (patch.material == mesh.patches.front().material) floor.push_back(&patch);
  return floor;
}

/// How many patches of the floor reach over a line by more than a millimetre to both of its sides.
template <class Side>
int across(const RadiosityMesh& mesh, const Side& side) {
  int count = 0;
  for (const Patch* patch : floorOf(mesh)) {
    double least = 0.0, most = 0.0;
    for (const glm::dvec3& corner : mesh.corners(*patch))
      least = std::min(least, side(corner)), most = std::max(most, side(corner));
    count += least < -1e-3 && most > 1e-3 ? 1 : 0;
  }
  return count;
}

/// How many light vertices patches of the floor share across a line.
template <class Side>
std::size_t sharedAcross(const RadiosityMesh& mesh, const Side& side) {
  std::set<std::uint32_t> left, right;
  for (const Patch* patch : floorOf(mesh))
    (side(patch->centroid) < 0.0 ? left : right).insert(patch->light.begin(), patch->light.end());
  return static_cast<std::size_t>(
      std::ranges::count_if(left, [&](std::uint32_t vertex) { return right.contains(vertex); }));
}

/// Of the floor alone.
std::size_t tJunctions(const RadiosityMesh& mesh) {
  RadiosityMesh floor = mesh;
  std::erase_if(floor.patches, [&](const Patch& patch) { return patch.material != mesh.patches.front().material; });
  return test::countTJunctions(floor);
}

double areaOf(const std::vector<const Patch*>& patches) {
  double sum = 0.0;
  for (const Patch* patch : patches) sum += patch->area;
  return sum;
}

TEST(RadiosityContacts, AFloorEndsAtAPartition) {
  for (const double below : {0.0, 0.05})  // it stands on the floor, or goes through
    for (const double width : {0.1, 0.3}) {
      const Scene scene = floorWith([&](SceneBuilder& builder, int m) {
        addBox(builder, {{0.3 - width, -below, -kWide / 2}, {0.3, 2, kWide / 2}}, m);
      });
      const auto first = [&](const glm::dvec3& p) { return p.x - 0.3 + width; };
      const auto second = [](const glm::dvec3& p) { return p.x - 0.3; };
      const RadiosityMesh before = makePatches(scene, settingsWith(false)),
                          mesh = makePatches(scene, settingsWith(true));
      EXPECT_GT(across(before, first) + across(before, second), 10);
      EXPECT_EQ(across(mesh, first), 0);
      EXPECT_EQ(across(mesh, second), 0);
      EXPECT_EQ(sharedAcross(mesh, first), 0u);
      EXPECT_EQ(sharedAcross(mesh, second), 0u);
      EXPECT_NEAR(areaOf(floorOf(mesh)), areaOf(floorOf(before)), 1e-9);
      EXPECT_EQ(tJunctions(mesh), 0u);
      for (const Patch& patch : mesh.patches) EXPECT_GT(patch.area, 0.0);
    }
}

TEST(RadiosityContacts, AnObliqueSheetToo) {
  const glm::dvec3 along = glm::normalize(glm::dvec3(0.4, 0.0, 1.0));
  const auto side = [&](const glm::dvec3& p) { return glm::cross(along, p).y; };
  for (const double turn : {1.0, -1.0}) {
    const RadiosityMesh mesh = makePatches(floorWith([&](SceneBuilder& builder, int m) {
                                             builder.plate({0, 1, 0}, turn * 6.0 * along, {0, 2, 0}, m);
                                           }),
                                           settingsWith(true));
    EXPECT_EQ(across(mesh, side), 0);
    EXPECT_EQ(sharedAcross(mesh, side), 0u);
    EXPECT_EQ(tJunctions(mesh), 0u);
  }
}

TEST(RadiosityContacts, LightGoesAroundTheEndOfAWall) {
  const RadiosityMesh mesh = makePatches(floorWith([](SceneBuilder& builder, int m) {
                                           builder.plate({0, 1, 1}, {0, 0, 2}, {0, 2, 0}, m);
                                         }),
                                         settingsWith(true));
  const auto side = [](const glm::dvec3& p) { return p.x; };
  // The wall stands from z = 0 to 2. Beyond its end the floor is one, and so it is at the end.
  std::set<std::uint32_t> left, right;
  for (const Patch* patch : floorOf(mesh))
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 corner = mesh.corners(*patch)[k];
      if (std::abs(corner.x) > 1e-9 || corner.z > 2.0 - 1e-9) continue;
      if (corner.z > 1e-9) (side(patch->centroid) < 0.0 ? left : right).insert(patch->light[k]);
      else if (std::abs(corner.z) <= 1e-9) {
        left.insert(patch->light[k] + 1000000u);
        right.insert(patch->light[k] + 1000000u);
      }
    }
  const auto atEnd = [](std::uint32_t vertex) { return vertex >= 1000000u; };
  EXPECT_EQ(std::ranges::count_if(left, atEnd), 1);
  for (const std::uint32_t vertex : left)
    if (!atEnd(vertex)) { EXPECT_FALSE(right.contains(vertex)); }
  EXPECT_GT(left.size(), 3u);
}

TEST(RadiosityContacts, CurvedSheetsStayWhole) {
  SceneBuilder builder;
  const auto material = [m = lambertian(builder, 0.5)](const glm::dvec3&) { return m; };
  test::addSphere(builder, 1.0, 2, true, material);
  test::addSphere(builder, 1.0, 2, false, material);  // both sides
  const RadiosityMesh before = makePatches(builder.scene(), settingsWith(false, 0.2)),
                      mesh = makePatches(builder.scene(), settingsWith(true, 0.2));
  EXPECT_EQ(mesh.patches.size(), before.patches.size());
  EXPECT_EQ(mesh.lightVertices, before.lightVertices);
}

TEST(RadiosityContacts, SmallThingsCutNothing) {
  const auto small = [](SceneBuilder& builder, int m) { addBox(builder, {{1, 0, 1}, {1.2, 0.2, 1.2}}, m); };
  const RadiosityMesh before = makePatches(floorWith(small), settingsWith(false)),
                      mesh = makePatches(floorWith(small), settingsWith(true));
  EXPECT_EQ(mesh.patches.size(), before.patches.size());
}

}  // namespace
}  // namespace lucerna
