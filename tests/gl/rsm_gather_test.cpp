// The gather on the GPU: against its CPU reference implementation point by point, and through the renderer on scenes
// whose answer is known.
#include "render/renderer.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "rsm/rsm_frame.hpp"
#include "rsm/rsm_gather.hpp"
#include "shared/frame.h"
#include "support/gl_fixture.hpp"
#include "support/rsm_maps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lucerna {
namespace {

using reference::NearField;
using reference::RsmMap;
using test::SurfacePoint;

double luminance(const glm::dvec3& c) { return (c.x + c.y + c.z) / 3.0; }

// ---------------------------------------------------------------------------------------------------- points

class RsmGatherOnGl : public test::SharedProgramsTest {
 protected:
  /// Irradiance at points, from a hand-made map, with the engine's shaders.
  std::vector<glm::dvec3> probe(const RsmMap& map, const RsmGather::Settings& settings,
                                const std::vector<glm::vec4>& pattern, const std::vector<SurfacePoint>& points,
                                float rotation) {
    std::vector<glm::vec4> position, normal, flux;
    for (const RsmMap::Texel& t : map.texels) {
      position.emplace_back(glm::vec3(t.position), t.surface ? 1.0f : 0.0f);
      normal.emplace_back(glm::vec3(t.normal), static_cast<float>(t.cosine));
      flux.emplace_back(glm::vec3(t.flux), static_cast<float>(map.texelArea() / std::max(t.cosine, 0.05)));
    }
    gl::Texture textures[3];
    const std::vector<glm::vec4>* data[] = {&position, &normal, &flux};
    for (int i = 0; i < 3; ++i) {
      textures[i] =
          gl::Texture("test rsm", gl::Format::rgba32f, glm::ivec3(map.size, 1), {}, 1, gl::TextureKind::array);
      textures[i].upload(gl::Texels::rgbaFloat, data[i]->data());
    }
    shared::FrameConstants frame{};
    frame.sunClipFromWorld = glm::mat4(map.clipFromWorld(10.0 * map.width));
    frame.sunDirection = glm::vec3(map.direction);
    const gl::Buffer frameBuffer("test frame", sizeof frame, &frame, gl::Usage::staticDraw);
    std::vector<glm::vec4> probes;
    for (const SurfacePoint& p : points) {
      probes.emplace_back(glm::vec3(p.position), rotation);
      probes.emplace_back(glm::vec3(p.normal), 0.0f);
    }
    const gl::Buffer in("probes", probes.size() * sizeof(glm::vec4), probes.data(), gl::Usage::staticDraw);
    const gl::Buffer out("irradiances", points.size() * sizeof(glm::vec4), nullptr, gl::Usage::streamRead);
    const gl::Buffer samples("pattern", pattern.size() * sizeof(glm::vec4), pattern.data(), gl::Usage::staticDraw);
    {
      const gl::ComputePass pass("probe");
      RsmGather::bindMap(programs().loadCompute("rsm gather probe", "rsm/gather_probe.comp",
                                                RsmGather::flags(settings, RsmGather::Light::sun)),
                         settings, {{textures[0], textures[1], textures[2], static_cast<float>(map.texelArea())}});
      frameBuffer.bindUniform(0);
      samples.bindStorage(0);
      in.bindStorage(1);
      out.bindStorage(2);
      pass.dispatch(glm::ivec3(static_cast<int>(points.size()), 1, 1), glm::ivec3(64, 1, 1));
    }
    std::vector<glm::dvec3> result;
    for (const glm::vec4& value : out.read<glm::vec4>()) result.emplace_back(glm::vec3(value));
    return result;
  }
};

TEST_F(RsmGatherOnGl, EqualsTheReference) {
  constexpr std::pair<RsmGather::Near, NearField> kNear[] = {{RsmGather::Near::none, NearField::none},
                                                             {RsmGather::Near::clamp, NearField::clamp},
                                                             {RsmGather::Near::disc, NearField::disc},
                                                             {RsmGather::Near::quad, NearField::quad}};
  RsmMap map = test::randomMap({64, 40}, 21);
  test::roundToFloat(map);
  const std::vector<SurfacePoint> points = test::randomPoints(map, 300, 22);
  for (const auto& [onGl, onCpu] : kNear)
    for (const auto weight : {RsmGather::Weight::unbiased, RsmGather::Weight::published})
      for (const float rotation : {0.0f, 1.0f}) {
        RsmGather::Settings settings;
        settings.nearField = onGl;
        settings.weight = weight;
        settings.radius = 0.45f;
        settings.reach = rotation > 0.0f ? RsmGather::Reach::map : RsmGather::Reach::radius;
        settings.clampTexels = 2.0f;
        const auto pattern = RsmGather::pattern(400, weight, {0.3, 0.1}, settings.exponent());
        const auto actual = probe(map, settings, pattern, points, rotation);
        const reference::GatherOptions options{static_cast<double>(settings.farthest()), onCpu,
                                               2.0 * std::sqrt(map.texelArea()),
                                               settings.reach == RsmGather::Reach::map};
        int compared = 0;
        double worst = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
          const auto expected = reference::gather(map, pattern, points[i].position, points[i].normal,
                                                  static_cast<double>(rotation), options);
          if (expected.boundaryDistance < 2e-5)
            continue;  // a sample on a texel's edge: rounding decides which it takes
          ++compared;
          const double scale = std::max(luminance(expected.irradiance), 1e-30);
          worst = std::max(worst, glm::length(actual[i] - expected.irradiance) / scale);
        }
        EXPECT_GT(compared, 200);
        EXPECT_LT(worst, 1e-4) << nameOf(onGl) << " " << nameOf(weight) << " " << rotation;
      }
}

TEST_F(RsmGatherOnGl, TheCornerAnchor) {
  RsmMap map = test::cornerMap({640, 64});
  test::roundToFloat(map);
  std::vector<SurfacePoint> points;
  const double heights[] = {0.001, 0.01, 0.1, 1.0};
  for (const double h : heights) points.push_back({{h, 0.0, 0.0}, {0.0, 0.0, 1.0}});
  RsmGather::Settings settings;
  settings.radius = 2.0f;
  const auto pattern = RsmGather::pattern(65536, RsmGather::Weight::unbiased);
  const auto actual = probe(map, settings, pattern, points, 0.3f);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(actual[i].x / test::cornerIrradiance(heights[i]), 1.0, 0.06) << heights[i];
}

TEST_F(RsmGatherOnGl, OnASurfelBesideTheMapAndFarAwayItIsFiniteAndDark) {
  RsmMap map = test::randomMap({16, 16}, 31);
  test::roundToFloat(map);
  RsmMap dark = map;
  for (RsmMap::Texel& t : dark.texels) t.surface = false;
  std::vector<SurfacePoint> onSurfels, outside;
  for (const RsmMap::Texel& t : map.texels) onSurfels.push_back({t.position, t.normal});
  for (const double away : {1e2, 1e6, 1e20, 1e37}) outside.push_back({map.right * away, -map.right});
  const auto pattern = RsmGather::pattern(400, RsmGather::Weight::unbiased);
  for (const auto nearField :
       {RsmGather::Near::none, RsmGather::Near::clamp, RsmGather::Near::disc, RsmGather::Near::quad}) {
    RsmGather::Settings settings;
    settings.nearField = nearField;
    for (const glm::dvec3& e : probe(map, settings, pattern, onSurfels, 0.0f))
      EXPECT_TRUE(std::isfinite(luminance(e))) << nameOf(nearField);
    for (const glm::dvec3& e : probe(map, settings, pattern, outside, 0.0f))
      EXPECT_TRUE(luminance(e) >= 0.0 && luminance(e) < 1e-3) << nameOf(nearField) << " " << luminance(e);
    settings.reach = RsmGather::Reach::radius;
    for (const glm::dvec3& e : probe(map, settings, pattern, outside, 0.0f))
      EXPECT_EQ(luminance(e), 0.0) << nameOf(nearField);
    for (const glm::dvec3& e : probe(dark, settings, pattern, onSurfels, 0.0f))
      EXPECT_EQ(luminance(e), 0.0) << nameOf(nearField);
  }
}

// ---------------------------------------------------------------------------------------------------- pictures

void addQuad(Scene& scene, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, int material) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  const glm::vec3 normal = glm::normalize(glm::cross(u, v));
  for (const glm::vec3& p : {corner, corner + u, corner + u + v, corner + v}) {
    scene.vertices.push_back({p, {}, normal});
    scene.bounds.add(glm::dvec3(p));
  }
  Mesh mesh;
  mesh.firstIndex = static_cast<std::uint32_t>(scene.indices.size());
  mesh.indexCount = 6;
  mesh.material = material;
  for (const glm::vec3& p : {corner, corner + u, corner + u + v, corner + v}) mesh.bounds.add(glm::dvec3(p));
  for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) scene.indices.push_back(first + i);
  scene.meshes.push_back(mesh);
}

constexpr float kLitAlbedo = 0.6f, kSun = 3.0f;

/// A sunlit floor y = 0, 0 < x < 10, |z| < 50 beside a wall x = 0 that the sun, straight above, does not touch. Exact
/// for the wall at height h: kLitAlbedo kSun cornerIrradiance(h).
Scene corner() {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].diffuse = glm::vec3(kLitAlbedo);
  addQuad(scene, {0.0f, 0.0f, 50.0f}, {10.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -100.0f}, 0);
  addQuad(scene, {0.0f, 0.0f, 50.0f}, {0.0f, 0.0f, -100.0f}, {0.0f, 6.0f, 0.0f}, 0);
  scene.sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(kSun)};
  Camera camera;
  camera.position = {6.0, 1.5, 0.0};
  camera.direction = {-1.0, 0.0, 0.0};
  camera.verticalFov = glm::radians(30.0);
  scene.cameras.push_back(camera);
  return scene;
}

/// Three walls, a floor and two blocks in slanting light, red and green: smooth walls, edges and a background.
/// Lengths times `scale`.
Scene room(float scale = 1.0f) {
  Scene scene;
  scene.materials.resize(3);
  scene.materials[0].diffuse = glm::vec3(0.7f);
  scene.materials[1].diffuse = {0.7f, 0.1f, 0.1f};
  scene.materials[2].diffuse = {0.1f, 0.6f, 0.1f};
  const auto quad = [&](glm::vec3 corner, glm::vec3 u, glm::vec3 v, int material) {
    addQuad(scene, scale * corner, scale * u, scale * v, material);
  };
  quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, 0);
  quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, 0);
  quad({-2, 0, 2}, {0, 0, -4}, {0, 3, 0}, 1);
  quad({2, 0, -2}, {0, 0, 4}, {0, 3, 0}, 2);
  for (const float x : {-1.2f, 0.5f}) {
    quad({x, 0, 0.4f}, {0.8f, 0, 0}, {0, 1, 0}, 0);
    quad({x, 1, 0.4f}, {0.8f, 0, 0}, {0, 0, -0.8f}, 1);
    quad({x, 0, -0.4f}, {0, 0, 0.8f}, {0, 1, 0}, 2);
    quad({x + 0.8f, 0, 0.4f}, {0, 0, -0.8f}, {0, 1, 0}, 0);
  }
  scene.sun = DirectionalLight{glm::normalize(glm::dvec3(-0.5, -1.0, -0.7)), glm::vec3(kSun)};
  scene.background = glm::vec3(0.4f);
  Camera camera;
  camera.position = glm::dvec3(0.3, 1.6, 7.0) * static_cast<double>(scale);
  camera.direction = glm::normalize(glm::dvec3(-0.05, -0.05, -1.0));
  camera.verticalFov = glm::radians(40.0);
  scene.cameras.push_back(camera);
  return scene;
}

class RsmRendered : public test::SharedProgramsTest {
 protected:
  static RenderSettings settings() {
    RenderSettings s;
    s.technique = "rsm";
    s.component = Component::indirect;
    s.size = {160, 120};
    s.fullFloatTarget = true;
    return s;
  }
  struct Result {
    Image image;
    std::vector<glm::vec4> irradiance;  ///< bottom row first
    RsmGather::Counts counts;
  };
  Result render(const Scene& scene, const RenderSettings& s, int frames = 1) {
    Renderer renderer(context(), programs(), scene, s);
    for (int i = 0; i < frames; ++i) renderer.render(scene.cameras.front());
    renderer.drain();
    return {renderer.readRadiance(), gatherOf(renderer.technique())->irradiance().readRgba(),
            gatherOf(renderer.technique())->counts()};
  }
};

TEST_F(RsmRendered, TheWallOfACornerHasTheExactIrradiance) {
  const Scene scene = corner();
  RenderSettings s = settings();
  s.of<RsmGather::Settings>().samples = 16384;
  s.of<RsmGather::Settings>().interpolate = false;
  s.size = {8, 120};
  const Result r = render(scene, s);
  // The wall is 6 away: pixel rows are heights.
  const double pixel = 2.0 * 6.0 * std::tan(0.5 * scene.cameras.front().verticalFov) / s.size.y;
  int compared = 0;
  for (int y = 0; y < s.size.y; ++y) {
    const double h = 1.5 + (y + 0.5 - 0.5 * s.size.y) * pixel;
    if (h < 0.02 || h > 3.0) continue;
    const double e = static_cast<double>(r.irradiance[static_cast<std::size_t>(y * s.size.x + s.size.x / 2)].x);
    // The floor's texels start within half a texel of the wall: 0.02 of h at least is missed or doubled where h is of
    // its size.
    EXPECT_NEAR(e / (static_cast<double>(kLitAlbedo * kSun) * test::cornerIrradiance(h)), 1.0, h < 0.15 ? 0.3 : 0.08)
        << h;
    ++compared;
    // Lambert: the picture's radiance is albedo / pi times it.
    const double radiance = static_cast<double>(r.image.at(s.size.x / 2, s.size.y - 1 - y).x);
    EXPECT_NEAR(radiance, static_cast<double>(kLitAlbedo) / M_PI * e, 1e-5 * radiance);
  }
  EXPECT_GT(compared, 80);
}

TEST_F(RsmRendered, InterpolationEqualsTheFullGatherWhereRefusedAndNearlyElsewhere) {
  const Scene scene = room();
  RenderSettings s = settings();
  s.of<RsmGather::Settings>().samples = 4096;  // the pattern's own noise low: interpolation's error alone
  s.of<RsmGather::Settings>().interpolate = false;
  const Result off = render(scene, s);
  s.of<RsmGather::Settings>().interpolate = true;
  // Light near a contact changes within the distance to it, so the error is that of steps of 4 and 2 pixels in so
  // small a picture.
  double before = 0.12;
  for (const int step : {4, 2}) {
    s.of<RsmGather::Settings>().lowResolution = step;
    const Result on = render(scene, s);
    double square = 0.0, sum = 0.0, count = 0.0;
    std::uint64_t refused = 0, surfaces = 0;
    for (std::size_t i = 0; i < on.irradiance.size(); ++i) {
      const glm::vec4 a = on.irradiance[i], b = off.irradiance[i];
      EXPECT_EQ(a.w > 0.0f, b.w > 0.0f);
      if (b.w == 0.0f) {  // background
        EXPECT_EQ(a, glm::vec4(0.0f));
      }
      surfaces += b.w > 0.0f ? 1 : 0;
      refused += a.w > 1.5f ? 1 : 0;
      if (a.w > 1.5f) {
        EXPECT_LE(glm::length(glm::vec3(a - b)), 1e-5f * glm::length(glm::vec3(b)));
      } else if (a.w > 0.5f) {
        square += std::pow(static_cast<double>(glm::length(glm::vec3(a - b))), 2.0);
        sum += static_cast<double>(glm::length(glm::vec3(b)));
        count += 1.0;
      }
    }
    const double error = std::sqrt(square / count) / (sum / count);
    std::printf("step %d, interpolated pixels %.0f, refused %llu: RMS error over mean %.4f\n", step, count,
                static_cast<unsigned long long>(refused), error);
    EXPECT_GT(refused, 100u);
    EXPECT_GT(count, 8000.0);
    EXPECT_LT(error, before);
    before = 0.65 * error;
    EXPECT_EQ(on.counts.refused, refused);
    EXPECT_EQ(on.counts.pixels, surfaces);
    EXPECT_EQ(off.counts.refused, 0u);
    EXPECT_EQ(off.counts.gathered, surfaces);
    EXPECT_LT(on.counts.gathered, surfaces / 2);
    EXPECT_GE(on.counts.gathered, refused + surfaces / static_cast<std::uint64_t>(step * step + 4));
  }
}

TEST_F(RsmRendered, StepOneIsNoInterpolationAndThresholdsRefuse) {
  const Scene scene = room();
  RenderSettings s = settings();
  s.of<RsmGather::Settings>().interpolate = false;
  const Result off = render(scene, s);
  s.of<RsmGather::Settings>().interpolate = true;
  s.of<RsmGather::Settings>().lowResolution = 1;
  EXPECT_EQ(render(scene, s).irradiance, off.irradiance);
  s.of<RsmGather::Settings>().lowResolution = 4;
  s.of<RsmGather::Settings>().fitDistance =
      0.0f;  // only the sample's own pixel is near enough, and that is one of four: all are refused
  const Result none = render(scene, s, 3);
  EXPECT_EQ(none.counts.frames, 3u);
  EXPECT_EQ(none.counts.refused, none.counts.pixels);
  for (std::size_t i = 0; i < none.irradiance.size(); ++i)
    EXPECT_EQ(glm::vec3(none.irradiance[i]), glm::vec3(off.irradiance[i]));
}

TEST_F(RsmRendered, ASampleFitsOnlyNearThePlaneAndNotFarAway) {
  // The room's parallel surfaces stand behind one another: with one threshold wide open the other refuses.
  const Scene scene = room();
  RenderSettings s = settings();
  const auto refused = [&](float plane, float distance) {
    s.of<RsmGather::Settings>().fitPlane = plane;
    s.of<RsmGather::Settings>().fitDistance = distance;
    return render(scene, s).counts.refused;
  };
  const std::uint64_t none = refused(1e6f, 1e6f);
  EXPECT_GT(refused(0.25f, 1e6f), none + 100);
  EXPECT_GT(refused(1e6f, 3.0f), none + 100);
}

TEST_F(RsmRendered, OddSizesAndPicturesSmallerThanAStep) {
  const Scene scene = room();
  for (const glm::ivec2& size : {glm::ivec2(1), glm::ivec2(3, 2), glm::ivec2(37, 5), glm::ivec2(66, 41)}) {
    RenderSettings s = settings();
    s.size = size;
    s.of<RsmGather::Settings>().lowResolution = 7;
    const Result r = render(scene, s);
    for (const glm::vec4& e : r.irradiance) EXPECT_TRUE(std::isfinite(e.x + e.y + e.z) && e.x >= 0.0f);
  }
}

TEST_F(RsmRendered, SceneScaleAndMapSizeDoNotChangeTheLight) {
  RenderSettings s = settings();
  s.of<RsmGather::Settings>().samples = 2048;
  const double reference = luminance(meanOf(render(room(), s).image));
  EXPECT_GT(reference, 0.01);
  for (const float scale : {0.01f, 100.0f})
    EXPECT_NEAR(luminance(meanOf(render(room(scale), s).image)) / reference, 1.0, 1e-3) << scale;
  for (const int size : {64, 128, 512, 1024}) {
    s.of<ReflectiveShadowMap::Settings>().size = size;
    EXPECT_NEAR(luminance(meanOf(render(room(), s).image)) / reference, 1.0, 0.05) << size;
  }
}

TEST_F(RsmRendered, ComponentsAddUpAndNothingIsBuiltThatIsNotNeeded) {
  const Scene scene = room();
  RenderSettings s = settings();
  const Image indirect = render(scene, s).image;
  s.component = Component::all;
  const Image all = render(scene, s).image;
  s.component = Component::direct;
  Renderer direct(context(), programs(), scene, s);
  direct.render(scene.cameras.front());
  EXPECT_EQ(direct.technique(), nullptr);
  const auto leftOut = direct.leftOut();
  EXPECT_NE(std::find(leftOut.begin(), leftOut.end(), "rsm gather"), leftOut.end());
  const Image without = direct.readRadiance();
  for (int y = 0; y < all.height; ++y)
    for (int x = 0; x < all.width; ++x)
      EXPECT_LE(glm::length(all.at(x, y) - indirect.at(x, y) - without.at(x, y)),
                1e-5f * glm::length(all.at(x, y)) + 1e-6f)
          << x << " " << y;
  s.component = Component::all;
  EXPECT_GT(Renderer(context(), programs(), scene, s).gpuBytes(), direct.gpuBytes());
  // Without a light there is nothing to gather.
  Scene night = room();
  night.sun.reset();
  EXPECT_EQ(Renderer(context(), programs(), night, s).technique(), nullptr);
}

TEST_F(RsmRendered, NoiseAndResizingKeepTheMean) {
  const Scene scene = room();
  RenderSettings s = settings();
  const double reference = luminance(meanOf(render(scene, s).image));
  s.of<RsmGather::Settings>().rotation = RsmGather::Rotation::noise;
  EXPECT_NEAR(luminance(meanOf(render(scene, s).image)) / reference, 1.0, 0.03);
  Renderer renderer(context(), programs(), scene, s);
  renderer.render(scene.cameras.front());
  renderer.resize({80, 60});
  renderer.render(scene.cameras.front());
  EXPECT_NEAR(luminance(meanOf(renderer.readRadiance())) / reference, 1.0, 0.05);
}

TEST_F(RsmRendered, RefusedPixelsArePaintedRed) {
  const Scene scene = room();
  RenderSettings s = settings();
  s.of<RsmGather::Settings>().showRefused = true;
  const Result r = render(scene, s);
  std::uint64_t red = 0;
  for (const glm::vec3& c : r.image.pixels) red += c == glm::vec3(1.0f, 0.0f, 0.0f) ? 1 : 0;
  EXPECT_EQ(red, r.counts.refused);
}

}  // namespace
}  // namespace lucerna
