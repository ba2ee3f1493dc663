// The figure that walks (assets/figure): a closed skin whose feet stand still where they stand, a round that closes.
#include "base/data.hpp"
#include "scene/motion.hpp"
#include "scene/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

namespace lucerna {
namespace {

class Figure : public testing::Test {
 protected:
  Figure() : scene_(loadScene(*findDataFolder() / "assets/figure/figure.json")) {
    mesh_ = std::ranges::find(scene_.meshes, "figure", &Mesh::name) - scene_.meshes.begin();
  }
  std::vector<glm::vec3> at(double seconds) {
    poseAt(scene_, seconds);
    const VertexRange range = vertexRange(scene_, mesh());
    std::vector<glm::vec3> positions;
    for (std::uint32_t i = 0; i < range.count; ++i) positions.push_back(scene_.vertices[range.first + i].position);
    return positions;
  }
  const Mesh& mesh() const { return scene_.meshes.at(static_cast<std::size_t>(mesh_)); }

  Scene scene_;
  std::ptrdiff_t mesh_ = 0;
};

TEST_F(Figure, IsAClosedSurface) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::uint32_t i = 0; i < mesh().indexCount; ++i) {
    const std::uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
    ++edges[{scene_.indices[mesh().firstIndex + i], scene_.indices[mesh().firstIndex + next]}];
  }
  // Where two parts of the body nearly touch, four triangles may meet in an edge.
  for (const auto& [edge, count] : edges)
    EXPECT_EQ(count, edges.contains({edge.second, edge.first}) ? edges.at({edge.second, edge.first}) : 0);
  EXPECT_LT(std::filesystem::file_size(*findDataFolder() / "assets/figure/figure.glb"), 300000u);
}

// Soles that touch the floor at two moments 0.06 s apart have not moved, while the body goes 5.6 cm.
TEST_F(Figure, StandsOnTheFloorAndDoesNotSlide) {
  for (double t = 0.0; t < scene_.motion->end; t += 0.1) {
    const std::vector<glm::vec3> now = at(t), next = at(t + 0.06);
    float low = 1.0f, high = 0.0f;
    for (std::size_t i = 0; i < now.size(); ++i) {
      low = std::min(low, now[i].y);
      high = std::max(high, now[i].y);
      if (now[i].y > 0.005f || next[i].y > 0.005f) continue;
      EXPECT_LT(std::hypot(next[i].x - now[i].x, next[i].z - now[i].z), 0.012f) << t << " s, vertex " << i;
    }
    EXPECT_NEAR(low, 0.0f, 0.015f) << t << " s";
    EXPECT_NEAR(high, 1.71f, 0.04f) << t << " s";
  }
}

TEST_F(Figure, EndsARoundWhereItBegan) {
  const std::vector<glm::vec3> first = at(0.0), last = at(scene_.motion->end), half = at(0.5 * scene_.motion->end);
  float worst = 0.0f, least = 10.0f;
  for (std::size_t i = 0; i < first.size(); ++i) {
    worst = std::max(worst, glm::distance(first[i], last[i]));
    least = std::min(least, glm::distance(first[i], half[i]));
  }
  EXPECT_LT(worst, 1e-4f);
  EXPECT_GT(least, 1.0f);  // on the other side of a circle of 2.8 m
}

}  // namespace
}  // namespace lucerna
