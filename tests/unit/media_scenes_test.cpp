// The media scenes of assets/: they load, and what holds a medium is closed: every edge of a solid stands once each
// way, and its volume is positive.
#include "scene/scene.hpp"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <map>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

const fs::path kMedia = fs::path(LUCERNA_SOURCE_DIR) / "assets/media";

struct Solid {
  std::size_t openEdges = 0;
  double volume = 0.0;
};

/// By position, as the loader splits vertices where normals differ.
Solid examine(const Scene& scene, const Mesh& mesh) {
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, int> edges;
  Solid solid;
  const glm::dvec3 origin(scene.vertices[scene.indices[mesh.firstIndex]].position);
  for (std::uint32_t i = 0; i < mesh.indexCount; i += 3) {
    std::array<Point, 3> corners;
    std::array<glm::dvec3, 3> p;
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::vec3& position = scene.vertices[scene.indices[mesh.firstIndex + i + c]].position;
      corners[c] = {position.x, position.y, position.z};
      p[c] = glm::dvec3(position) - origin;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const Point &a = corners[c], &b = corners[(c + 1) % 3];
      a < b ? ++edges[{a, b}] : --edges[{b, a}];
    }
    solid.volume += glm::dot(p[0], glm::cross(p[1], p[2])) / 6.0;
  }
  for (const auto& [edge, balance] : edges) solid.openEdges += balance != 0;
  return solid;
}

std::vector<fs::path> sceneFiles() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(kMedia))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

TEST(MediaScenes, EveryOneLoadsAndItsMediaAreInClosedSolids) {
  const std::vector<fs::path> files = sceneFiles();
  EXPECT_EQ(files.size(), 16u);
  for (const fs::path& file : files) {
    const Scene scene = loadScene(file);
    EXPECT_EQ(scene.droppedTriangles, 0u) << file;
    EXPECT_EQ(scene.degenerateTriangles, 0u) << file;
    EXPECT_EQ(scene.metresPerUnit, file.stem() == "milk_haze_original" ? 0.00025 : 0.001) << file;
    EXPECT_FALSE(scene.media.empty()) << file;
    std::size_t solids = 0;
    for (const Mesh& mesh : scene.meshes) {
      const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
      if (material.bsdf != Bsdf::dielectric && material.bsdf != Bsdf::none) continue;
      ++solids;
      EXPECT_GE(material.interior, 0) << file << " " << mesh.name;
      const Solid solid = examine(scene, mesh);
      EXPECT_EQ(solid.openEdges, 0u) << file << " " << mesh.name;
      EXPECT_GT(solid.volume, 1.0) << file << " " << mesh.name;  // mm^3
    }
    EXPECT_GE(solids, 1u) << file;
    const bool original = file.stem().string().ends_with("_original") || file.stem() == "smoke_cloud";
    EXPECT_EQ(scene.points.size(), original ? 1u : 0u) << file;
    EXPECT_EQ(scene.environment.has_value(), !original) << file;
    EXPECT_EQ(scene.keyFrames.empty(), original) << file;
  }
}

TEST(MediaScenes, GlassHasPriorityOverWhatIsInIt) {
  for (const char* name : {"espresso/espresso.json", "cola/cola.json"}) {
    const Scene scene = loadScene(kMedia / name);
    int glass = -1, liquid = -1;
    for (const Material& material : scene.materials) {
      if (material.name == "glass") glass = material.priority;
      if (material.name == "espresso" || material.name == "cola") liquid = material.priority;
    }
    EXPECT_GT(liquid, 0) << name;
    EXPECT_GT(glass, liquid) << name;
  }
}

TEST(MediaScenes, TheSmokeIsAGridWithFadedBorders) {
  const Scene scene = loadScene(kMedia / "smoke/smoke.json");
  ASSERT_EQ(scene.media.size(), 1u);
  ASSERT_TRUE(scene.media[0].grid);
  const DensityGrid& grid = *scene.media[0].grid;
  EXPECT_EQ(grid.size, glm::ivec3(96));
  double sum = 0.0;
  for (int z = 0; z < 96; ++z)
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        const float density = grid.density[static_cast<std::size_t>(x + 96 * (y + 96 * z))];
        sum += density;
        if (x == 0 || y == 0 || z == 0 || x == 95 || y == 95 || z == 95) { EXPECT_EQ(density, 0.0f); }
      }
  EXPECT_GT(sum / (96.0 * 96.0 * 96.0), 0.02);
}

}  // namespace
}  // namespace lucerna
