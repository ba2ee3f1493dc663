// Shadow maps of scenes in which meshes and lights move: the bits of maps that are drawn anew, by less work.
#include "forward/layered_depth.hpp"
#include "host/api.hpp"
#include "render/renderer.hpp"
#include "scene/motion.hpp"
#include "support/gl_fixture.hpp"
#include "support/small_scenes.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <numbers>

namespace lucerna {
namespace {

constexpr std::size_t kPlate = 4, kMaskedPlate = 5;  // meshes that move, after the box
constexpr GLuint kTriangles = 12, kTrianglesOfPlate = 2;

/// A room with two plates, one of them with holes, and lights of all kinds.
Scene room() {
  test::SceneBuilder builder;
  builder.scene() = test::openBox();
  const int grey = builder.material(glm::vec3(0.5f)), masked = builder.material(glm::vec3(0.5f));
  builder.materialAt(masked).alphaMasked = true;
  builder.materialAt(masked).alphaTexture = builder.texture(2, 1, {255, 255, 255, 255, 255, 255, 255, 0}, true);
  builder.plate({-1, -2, 0}, {2, 0, 0}, {0, 0, 2}, grey);
  builder.plate({2, -1, 1}, {2, 0.5, 0}, {0, 0, 2}, masked);
  Scene scene = builder.scene();
  scene.points.resize(2);
  scene.points[0].position = {-2, 1, 1};
  scene.points[1].position = {2, 2, -1};
  scene.spots.resize(2);
  scene.spots[0].position = {0, 3, 0};
  scene.spots[1].position = {2, 3, 1};
  for (PointLight& lamp : scene.points) lamp.intensity = glm::vec3(5.0f);
  for (SpotLight& lamp : scene.spots) lamp.intensity = glm::vec3(9.0f);
  return scene;
}

SceneChange moved(Scene& scene, std::size_t mesh, const glm::dvec3& by) {
  transformMesh(scene, scene.meshes[mesh], glm::translate(glm::dmat4(1.0), by));
  updateBounds(scene, mesh);
  SceneChange change;
  change.meshes = {mesh};
  return change;
}

class MovingShadows : public test::SharedProgramsTest {
 protected:
  static RenderSettings settings(int cascades = 1) {
    RenderSettings result;
    result.technique = "direct";
    result.size = {48, 32};
    result.fullFloatTarget = true;
    result.pixelSamples = 1;
    result.shadow.size = 256;
    result.shadow.cascades.cascades = cascades;
    result.lights.spotSize = result.lights.pointSize = 128;
    return result;
  }
  static std::vector<float> sunDepth(const Renderer& renderer) {
    const std::vector<StagePicture> pictures = renderer.stagePictures();
    const auto map = std::ranges::find_if(pictures, [](const StagePicture& picture) {
      return picture.name == "shadow map" || picture.name == "sun cascades";
    });
    return map->texture->readDepth();
  }
};

TEST_F(MovingShadows, HaveTheBitsOfMapsDrawnAnew) {
  const auto move = [](std::size_t mesh, const glm::dvec3& by) {
    return [=](Scene& scene, Camera&) { return moved(scene, mesh, by); };
  };
  const auto moveLamp = [](Scene& scene, Camera&) {
    scene.points[0].position.x += 0.4;
    scene.spots[1].position.z -= 0.3;
    SceneChange change;
    change.lamps = true;
    return change;
  };
  const auto turnSun = [](Scene& scene, Camera&) {
    scene.sun->direction = glm::normalize(scene.sun->direction + glm::dvec3(0.05, 0.0, 0.0));
    SceneChange change;
    change.sun = true;
    return change;
  };
  const auto walk = [](Scene&, Camera& camera) {
    camera.position.x += 0.5;
    return SceneChange{};
  };
  const auto rest = [](Scene&, Camera&) { return SceneChange{}; };
  const auto moveAll = [&](Scene& scene, Camera& camera) {
    SceneChange change = moved(scene, kMaskedPlate, {-0.2, 0.1, 0.0});
    change.lamps = moveLamp(scene, camera).lamps;
    return change;
  };
  const std::vector<std::function<SceneChange(Scene&, Camera&)>> steps{
      move(kPlate, {0.3, 0.0, 0.0}),
      move(kPlate, {0.3, 0.2, 0.0}),
      move(kPlate, {0.0, 0.0, 0.2}),
      rest,
      walk,
      move(kMaskedPlate, {0.0, -0.3, 0.0}),  // a second one begins to move
      move(kMaskedPlate, {0.2, -0.3, 0.0}),
      moveAll,
      move(kMaskedPlate, {-0.2, 0.3, 0.0}),
      moveLamp,
      turnSun,
      move(kPlate, {0.0, 0.3, 0.1}),
      move(kPlate, {0.0, 0.3, 0.1}),
      move(kPlate, {0.0, 9.0, 0.0}),  // out of the box: the sun's view is another
      move(kPlate, {0.0, -9.0, 0.0}),
  };
  for (const int cascades : {1, 3}) {
    Scene scene = room();
    Camera camera = test::openBoxCamera();
    Renderer renderer(context(), programs(), scene, settings(cascades));
    renderer.render(camera);
    for (std::size_t step = 0; step < steps.size(); ++step) {
      const SceneChange change = steps[step](scene, camera);
      ASSERT_TRUE(renderer.follow(context(), programs(), scene, change));
      renderer.render(camera);
      Renderer anew(context(), programs(), scene, settings(cascades));
      anew.render(camera);
      EXPECT_EQ(sunDepth(renderer), sunDepth(anew)) << "step " << step << ", cascades " << cascades;
      EXPECT_TRUE(renderer.readRadiance().pixels == anew.readRadiance().pixels)
          << "step " << step << ", cascades " << cascades;
    }
  }
}

// Counted behind the geometry shader, which passes on what is in view; that is all.
TEST_F(MovingShadows, DrawOnlyMeshesThatMove) {
  Scene scene = room();
  GpuScene gpuScene(scene, analyse(scene), capabilities());
  LayeredDepth maps(programs(), gpuScene, "maps", {gl::TextureKind::array, 64, 2, 1});
  std::array<LayeredDepth::View, 2> views{};
  for (LayeredDepth::View& view : views) view.clipFromPlace = glm::scale(glm::mat4(1.0f), glm::vec3(0.1f));
  GLuint query = 0;
  glGenQueries(1, &query);
  const auto drawn = [&] {
    glBeginQuery(GL_PRIMITIVES_GENERATED, query);
    maps.record(gpuScene, views);
    glEndQuery(GL_PRIMITIVES_GENERATED);
    GLuint count = 0;
    glGetQueryObjectuiv(query, GL_QUERY_RESULT, &count);
    return count;
  };
  const auto move = [&](std::size_t mesh) { gpuScene.update(moved(scene, mesh, {0.1, 0.0, 0.1}).meshes); };
  EXPECT_EQ(drawn(), 2 * kTriangles);
  EXPECT_EQ(drawn(), 0u);
  move(kPlate);
  EXPECT_EQ(drawn(), 2 * kTriangles) << "what stands still is kept";
  move(kPlate);
  EXPECT_EQ(drawn(), 2 * kTrianglesOfPlate);
  move(kMaskedPlate);
  EXPECT_EQ(drawn(), 2 * kTriangles) << "less of it stands still";
  move(kMaskedPlate);
  EXPECT_EQ(drawn(), 4 * kTrianglesOfPlate);
  views[1].clipFromPlace[3].x += 0.01f;
  EXPECT_EQ(drawn(), kTriangles) << "the other lamp stands still, and so do all meshes";
  move(kPlate);
  EXPECT_EQ(drawn(), kTriangles + 2 * kTrianglesOfPlate);
  maps.forget();
  EXPECT_EQ(drawn(), 2 * kTriangles);
  glDeleteQueries(1, &query);
}

TEST_F(MovingShadows, HaveOneMapWhereNoMeshHasMoved) {
  Scene scene = room();
  Camera camera = test::openBoxCamera();
  Renderer renderer(context(), programs(), scene, settings());
  renderer.render(camera);
  const std::size_t bytes = renderer.gpuBytes();
  SceneChange lights;
  lights.sun = lights.lamps = true;
  for (int frame = 0; frame < 3; ++frame) {
    scene.points[0].position.x += 0.1;
    scene.sun->direction = glm::normalize(scene.sun->direction + glm::dvec3(0.05, 0.0, 0.0));
    ASSERT_TRUE(renderer.follow(context(), programs(), scene, lights));
    renderer.render(camera);
    EXPECT_EQ(renderer.gpuBytes(), bytes);
  }
  ASSERT_TRUE(renderer.follow(context(), programs(), scene, moved(scene, kPlate, {0.1, 0.0, 0.0})));
  renderer.render(camera);
  const std::size_t texels = 256 * 256 + 2 * 128 * 128 + 12 * 128 * 128;
  EXPECT_EQ(renderer.gpuBytes(), bytes + texels * sizeof(float)) << "a second map of the sun, of spots and of lamps";
}

}  // namespace
}  // namespace lucerna
