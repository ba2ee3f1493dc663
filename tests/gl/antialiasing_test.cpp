// What a pixel shows of edges: the filter's share of each side, in the path tracer and in added up frames, at rest and
// while the view moves.
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/pixel_filter.hpp"
#include "forward/antialiasing.hpp"
#include "forward/motion_samples.hpp"
#include "gl/draw.hpp"
#include "gl/split_timer.hpp"
#include "irradiance_cache/settings.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/renderer.hpp"
#include "scene/motion.hpp"
#include "support/gl_fixture.hpp"
#include "support/media_scenes.hpp"
#include "support/small_scenes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace lucerna {
namespace {

constexpr int kPicture = 16;

/// A shining rectangle from x = edge to the right, across the view; the picture is kPicture units wide and high.
struct EdgeScene : Scene {
  explicit EdgeScene(double edge, float behind = 0.0f) {
    materials.resize(1);
    materials[0].diffuse = glm::vec3(0.0f);
    materials[0].emission = glm::vec3(1.0f);
    background = glm::vec3(behind);
    meshes.resize(1);
    const double h = 2.0 * kPicture;
    for (const glm::dvec3& p : {glm::dvec3(edge, -h, 0), glm::dvec3(edge + 3 * h, -h, 0),
                                glm::dvec3(edge + 3 * h, h, 0), glm::dvec3(edge, h, 0)}) {
      vertices.push_back({glm::vec3(p), {}, {0, 0, 1}});
      bounds.add(p);
    }
    indices = {0, 1, 2, 0, 2, 3};
    meshes[0].indexCount = 6;
    meshes[0].bounds = bounds;
    cameras = {view(0.0)};
  }
  static Camera view(double x, bool orthographic = true) {
    Camera camera;
    camera.position = {x, 0.0, 10.0};
    camera.direction = {0.0, 0.0, -1.0};
    if (orthographic) camera.orthographicHeight = kPicture;
    else camera.verticalFov = 2.0 * std::atan(0.05 * kPicture);
    return camera;
  }
};

RenderSettings settingsFor(int samples, PixelFilter filter = PixelFilter::box) {
  RenderSettings s;
  s.technique = "direct";
  s.size = {kPicture, kPicture};
  s.fullFloatTarget = true;
  s.pixelSamples = samples;
  s.filter = filter;
  return s;
}

/// The filter's share on the right of a place, in pixels from the pixel's centre.
double shareRightOf(PixelFilter filter, double place) {
  constexpr int kSteps = 4000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = -2.0 + 4.0 * (i + 0.5) / kSteps;
    if (x > place) sum += 4.0 / kSteps * filterDensity(filter, x);
  }
  return sum;
}

class AntialiasingGl : public test::GlTest {
 protected:
  Image frames(const Scene& scene, const RenderSettings& settings) {
    Renderer renderer(context(), programs(), scene, settings);
    renderer.renderToTheEnd(scene.cameras.front());
    return renderer.readRadiance();
  }
};

TEST_F(AntialiasingGl, PixelsShowTheFiltersShareOfAnEdge) {
  for (const PixelFilter filter : {PixelFilter::box, PixelFilter::gaussian, PixelFilter::blackmanHarris})
    for (const double edge : {0.0, 0.3, 0.62}) {
      const EdgeScene scene(edge);
      const Image added = frames(scene, settingsFor(1024, filter));
      PathTracer::Settings paths;
      paths.size = {kPicture, kPicture};
      paths.filter = filter;
      PathTracer tracer(context(), programs(), scene, paths);
      tracer.setCamera(scene.cameras.front());
      tracer.record(1024);
      const Image traced = tracer.mean();
      for (int x = kPicture / 2 - 3; x < kPicture / 2 + 3; ++x) {
        const double right = shareRightOf(filter, edge - (x + 0.5 - 0.5 * kPicture));
        EXPECT_NEAR(added.at(x, 5).x, right, 0.004) << nameOf(filter) << " " << edge << " " << x;
        EXPECT_NEAR(traced.at(x, 5).x, right, 0.01) << nameOf(filter) << " " << edge << " " << x;
      }
    }
}

TEST_F(AntialiasingGl, ThroughCentresThereIsNoShare) {
  const EdgeScene scene(0.3);
  for (const int samples : {1, 16}) {
    const Image image = frames(scene, settingsFor(samples, samples == 1 ? PixelFilter::box : PixelFilter::centre));
    for (int x = 0; x < kPicture; ++x)
      EXPECT_EQ(image.at(x, 5).x, x + 0.5 - 0.5 * kPicture > 0.3 ? 1.0f : 0.0f) << samples << " " << x;
  }
}

// A pixel covers one texel across the stripes and four along them. One sample needs an anisotropic filter; each of 16
// covers one texel along them.
TEST_F(AntialiasingGl, StripesOnASurfaceThatTurnsAwayStaySharp) {
  constexpr int kTexels = 64;
  constexpr float kTurned = 4.0f;  // texels of a pixel's height; of its width: one
  EdgeScene scene(-2.0 * kPicture);
  Bitmap stripes{kTexels, kTexels, std::vector<std::uint8_t>(4 * kTexels * kTexels, 255)};
  for (std::size_t i = 0; i < stripes.rgba.size(); ++i)
    if (i % 4 < 3 && i / 4 % 4 >= 2) stripes.rgba[i] = 0;
  scene.textures.push_back({"stripes", stripes});
  scene.materials[0].emissionTexture = 0;
  scene.materials[0].emissionScale = glm::vec3(1.0f);
  for (Vertex& v : scene.vertices) v.texCoord = glm::vec2(v.position) * glm::vec2(1.0f, kTurned) / float{kTexels};
  for (const int samples : {1, 16}) {
    // Drivers choose the anisotropic filter's level: at level 1 (Mesa 25) a stripe's inner half is 0.25 off, and at
    // level 2, of a filter that is not anisotropic, all is grey: 0.5.
    const double bound = samples == 1 ? 0.3 : 0.2;
    const Image image = frames(scene, settingsFor(samples));
    for (int x = 0; x < kPicture; ++x) {
      const bool isWhite = (x - kPicture / 2 + kTexels) % 4 < 2;
      EXPECT_NEAR(image.at(x, 5).x, isWhite ? 1.0 : 0.0, bound) << samples << " " << x;
    }
  }
}

// A strip between the pixels' centres: its light is found for the samples that it covers.
TEST_F(AntialiasingGl, WhatOnlySomeSamplesShowIsLit) {
  constexpr float kLeft = 0.6f, kRight = 0.85f, kAlbedo = 0.4f;
  EdgeScene scene(static_cast<double>(kLeft));
  for (const std::size_t corner : {1u, 2u}) scene.vertices[corner].position.x = kRight;
  scene.materials[0].emission = glm::vec3(0.0f);
  scene.materials[0].diffuse = glm::vec3(kAlbedo);
  scene.environment.emplace().radiance = glm::vec3(1.0f);
  for (const CacheTransport transport : {CacheTransport::rays, CacheTransport::gather}) {
    RenderSettings settings = settingsFor(16);
    settings.technique = "irradiance-cache";
    settings.of<IrradianceCacheSettings>().transport = transport;
    const Image image = frames(scene, settings);
    EXPECT_NEAR(image.at(kPicture / 2, 5).x, 1.0f - (kRight - kLeft) * (1.0f - kAlbedo), 0.01f);
    EXPECT_NEAR(image.at(kPicture / 2 - 1, 5).x, 1.0f, 1e-4f);
  }
}

// One frame, whose samples lie in columns of equal width. OpenGL 4.3, 14.3.1, leaves their places open; Mesa's are so.
TEST_F(AntialiasingGl, AMultisampledFrameShowsTheSharesOfAnEdge) {
  constexpr float kSky = 0.25f;
  for (const char* technique : {"direct", "irradiance-cache", "radiosity"})
    for (const int samples : {2, 4})
      for (const double edge : {0.0, 0.3, 0.62}) {
        EdgeScene scene(edge);
        scene.environment.emplace();
        scene.environment->radiance = glm::vec3(kSky);
        RenderSettings settings = settingsFor(1);
        settings.technique = technique;
        settings.multisamples = samples;
        const Image image = frames(scene, settings);
        for (int x = 0; x < kPicture; ++x) {
          const double right = std::clamp(x + 1 - 0.5 * kPicture - edge, 0.0, 1.0);
          const double share = (static_cast<double>(image.at(x, 5).x) - kSky) / (1.0 - kSky);
          const double error = right == 0.0 || right == 1.0 ? 1e-6 : 0.5 / samples + 1e-6;
          EXPECT_NEAR(share, right, error) << technique << " " << samples << " " << edge << " " << x;
        }
      }
}

TEST_F(AntialiasingGl, MoreSamplesThanTheDriverHasAreAnError) {
  RenderSettings settings = settingsFor(1);
  settings.multisamples = 1 << 20;
  try {
    frames(EdgeScene(0.3), settings);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::missingCapability);
    EXPECT_NE(std::string(error.what()).find("1048576 samples"), std::string::npos) << error.what();
  }
}

TEST_F(AntialiasingGl, AViewAtRestEndsAtTheSameBitsOnEveryRun) {
  const EdgeScene scene(0.3);
  const RenderSettings settings = settingsFor(16);
  const Image first = frames(scene, settings);
  Renderer renderer(context(), programs(), scene, settings);
  const Camera camera = EdgeScene::view(0.0, false);
  renderer.render(EdgeScene::view(0.7));  // another view before
  renderer.render(scene.cameras.front());
  EXPECT_FALSE(renderer.isSettled());
  int count = 1;
  for (; !renderer.isSettled() && count < 100; ++count) renderer.render(scene.cameras.front());
  EXPECT_LE(count, 17);
  const Image second = renderer.readRadiance();
  EXPECT_EQ(std::memcmp(first.pixels.data(), second.pixels.data(), first.pixels.size() * sizeof first.pixels[0]), 0);
  renderer.render(scene.cameras.front());  // rests
  const Image third = renderer.readRadiance();
  EXPECT_EQ(std::memcmp(first.pixels.data(), third.pixels.data(), first.pixels.size() * sizeof first.pixels[0]), 0);
}

// An edge that moves by a fraction of a pixel in each frame, by itself or past the camera: its share of a pixel is that
// of the present place.
TEST_F(AntialiasingGl, InMotionAnEdgeIsSmoothAndWhereItIs) {
  const EdgeScene rest(0.3, 0.25f);
  for (const bool orthographic : {true, false})
    for (const bool movesItself : {false, true}) {
      const auto error = [&](bool reprojection, int samples) {
        RenderSettings settings = settingsFor(16);
        settings.reprojection = reprojection;
        settings.motionSamples = samples;
        EdgeScene scene = rest;
        Renderer renderer(context(), programs(), scene, settings);
        double squares = 0.0;
        constexpr int kFrames = 40;
        for (int frame = 0; frame < kFrames; ++frame) {
          const double gone = 0.13 * frame;
          if (movesItself) {
            for (std::size_t i = 0; i < scene.vertices.size(); ++i)
              scene.vertices[i].position.x = rest.vertices[i].position.x + static_cast<float>(gone);
            SceneChange change;
            change.meshes = {0};
            EXPECT_TRUE(renderer.follow(context(), programs(), scene, change));
          }
          renderer.render(EdgeScene::view(movesItself ? 0.0 : -gone, orthographic));
          if (frame < 12) continue;
          const Image image = renderer.readRadiance();
          for (int x = 0; x < kPicture; ++x) {
            const double right = 0.25 + 0.75 * shareRightOf(PixelFilter::box, 0.3 + gone - (x + 0.5 - 0.5 * kPicture));
            squares += std::pow(image.at(x, 5).x - right, 2.0) / kFrames;
          }
        }
        return std::sqrt(squares);
      };
      const double with = error(true, 1), without = error(false, 1), four = error(true, 4), fourAlone = error(false, 4);
      const std::string name = fmt::format("{}, {}", orthographic ? "orthographic" : "perspective",
                                           movesItself ? "by itself" : "past the camera");
      std::printf("edge in motion, %s: error %.3f, each frame alone %.3f; with four samples %.3f and %.3f\n",
                  name.c_str(), with, without, four, fourAlone);
      EXPECT_LT(with, 0.4 * without) << name;
      EXPECT_LT(four, 0.8 * with) << name;
      EXPECT_LT(fourAlone, 0.55 * without) << name;
    }
}

// By timestamps, as on a GPU: the number follows what the first sample costs beside the others.
TEST_F(AntialiasingGl, TheNumberOfSamplesInMotionFollowsTheGpusClock) {
  const gl::VertexArray noAttributes("full screen");
  const gl::Texture picture("picture", gl::Format::rgba16f, {128, 128});
  Antialiasing work(programs());
  work.resize({128, 128});
  const auto add = [&](int pictures) {
    for (int i = 0; i < pictures; ++i) work.add(picture, noAttributes);
    gl::finish();
  };
  gl::SplitTimer timer(false);
  MotionSamples samples;
  const auto restOf = [&](int first, int further) {
    for (int frame = 0; frame < 16; ++frame) {
      timer.begin();
      gl::finish();  // llvmpipe draws tile by tile: a timestamp is that of the last tile
      add(first);
      timer.split();
      gl::finish();
      add(further * (samples.now() - 1));
      for (const gl::SplitTimer::Times& times : timer.end(samples.now()))
        if (times.label == samples.now()) samples.add(times.first, times.second, 8);
      gl::finish();
    }
    return samples.now();
  };
  const auto quickestOfThree = [&](int pictures) {  // one alone may have waited for other work
    double quickest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const auto start = Clock::now();
      add(pictures);
      quickest = std::min(quickest, secondsSince(start));
    }
    return quickest;
  };
  int pictures = 64;  // more than a 60th of a second
  while (quickestOfThree(pictures) < 0.03) pictures *= 2;
  EXPECT_EQ(restOf(pictures, pictures / 64), 8);
  EXPECT_EQ(restOf(pictures, 2 * pictures), 1);
}

/// Leaves of a pixel or two, cut out of a shining rectangle by a mask.
EdgeScene leaves(float texelsOfPixel = 2.0f) {
  constexpr int kTexels = 64;
  EdgeScene scene(-2.0 * kPicture, 0.25f);
  Bitmap mask{kTexels, kTexels, std::vector<std::uint8_t>(4 * kTexels * kTexels, 0), true};
  std::mt19937 random(7);
  for (int leaf = 0; leaf < 160; ++leaf) {
    const glm::ivec2 at(random() % kTexels, random() % kTexels);
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const glm::ivec2 texel = (at + glm::ivec2(x, y) + kTexels) % kTexels;
        if (x * x + 2 * y * y <= 5) mask.rgba[static_cast<std::size_t>(4 * (texel.y * kTexels + texel.x)) + 3] = 255;
      }
  }
  scene.textures.push_back({"leaves", mask});
  scene.materials[0].alphaTexture = 0;
  scene.materials[0].alphaMasked = true;
  for (Vertex& v : scene.vertices) v.texCoord = glm::vec2(v.position) * (texelsOfPixel / kTexels);
  return scene;
}

/// Balls with a polished coat, whose reflections of the sun are smaller than a pixel.
Scene polishedBalls() {
  test::SceneBuilder builder;
  builder.materialAt(builder.material(glm::vec3(0.02f))).specular = glm::vec3(0.3f);
  Scene& scene = builder.scene();
  scene.materials[0].roughness = 0.12f;
  for (int i = 0; i < 10; ++i) {
    const glm::dvec3 centre(3.1 * i - 14.0, 2.3 * (i % 3) - 2.0, 0.0);
    const std::size_t first = scene.vertices.size();
    test::addSphere(scene, centre, 1.4, 3, 0);
    for (std::size_t v = first; v < scene.vertices.size(); ++v)
      scene.vertices[v].normal = glm::normalize(scene.vertices[v].position - glm::vec3(centre));
  }
  scene.sun->direction = glm::normalize(glm::dvec3(-0.3, -0.4, -1.0));
  return scene;
}

// Far away, where a leaf is smaller than a pixel, the tree covers as much as close by.
TEST_F(AntialiasingGl, LeavesCoverAsMuchOverDistance) {
  constexpr int kSide = 4 * kPicture;
  const auto covered = [&](float texelsOfPixel, int samples) {
    RenderSettings settings = settingsFor(samples);
    settings.size = {kSide, kSide};
    return (meanOf(frames(leaves(texelsOfPixel * kSide / kPicture), settings)).x - 0.25) / 0.75;
  };
  const double near = covered(1.0f, 256);  // the whole mask
  for (const int samples : {1, 4, 16})
    for (const float pixelsOfTile : {17.3f, 9.1f, 5.3f, 3.7f, 2.6f, 1.9f, 1.27f, 0.61f}) {
      const double far = covered(64.0f / pixelsOfTile, samples);
      std::printf("leaves, %.1f pixels a tile, %d samples: %.3f of %.3f covered\n", static_cast<double>(pixelsOfTile),
                  samples, far, near);
      EXPECT_NEAR(far, near, 0.07 * near) << pixelsOfTile << " " << samples;
    }
}

// Both moved by a fraction of a pixel in each frame, against the same view at rest with many samples: the error of a
// frame, and of its change from the frame before.
TEST_F(AntialiasingGl, InMotionLeavesAndHighlightsHoldStill) {
  struct Case {
    const char* name;
    Scene scene;
    double mostOfAlone, mostChange;  // error over that of each frame alone; error of changes
  };
  for (const auto& [name, scene, mostOfAlone, mostChange] :
       {Case{"leaves", leaves(), 0.5, 0.2}, Case{"highlights", polishedBalls(), 1.1, 0.35}}) {
    constexpr int kFrames = 40, kFirst = 12;
    const auto viewAt = [](int frame) { return EdgeScene::view(-0.13 * frame); };
    std::vector<Image> truth;
    for (int frame = kFirst - 1; frame < kFrames; ++frame) {
      Renderer renderer(context(), programs(), scene, settingsFor(256));
      renderer.renderToTheEnd(viewAt(frame));
      truth.push_back(renderer.readRadiance());
    }
    struct Errors {
      double frame = 0.0, change = 0.0;
    };
    const auto errors = [&, &drawn = scene](bool reprojection, int samples) {  // clang 14 captures no binding by [&]
      RenderSettings settings = settingsFor(16);
      settings.reprojection = reprojection;
      settings.motionSamples = samples;
      Renderer renderer(context(), programs(), drawn, settings);
      Errors sum;
      double all = 0.0;
      std::vector<glm::vec3> before;
      for (int frame = 0; frame < kFrames; ++frame) {
        renderer.render(viewAt(frame));
        if (frame < kFirst - 1) continue;
        const Image image = renderer.readRadiance();
        const Image& right = truth[static_cast<std::size_t>(frame - kFirst + 1)];
        std::vector<glm::vec3> differences;
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
          differences.push_back(image.pixels[i] - right.pixels[i]);
          const auto square = [](const glm::vec3& v) { return static_cast<double>(glm::dot(v, v)); };
          if (frame < kFirst) continue;
          sum.frame += square(differences[i]);
          sum.change += square(differences[i] - before[i]);
          all += square(right.pixels[i]);
        }
        before = differences;
      }
      return Errors{std::sqrt(sum.frame / all), std::sqrt(sum.change / all)};
    };
    const Errors with = errors(true, 1), without = errors(false, 1), four = errors(true, 4);
    std::printf("%s in motion: error %.3f, of changes %.3f; each frame alone %.3f, %.3f; four samples %.3f, %.3f\n",
                name, with.frame, with.change, without.frame, without.change, four.frame, four.change);
    EXPECT_LT(with.frame, mostOfAlone * without.frame) << name;
    EXPECT_LT(with.change, mostChange) << name;
    EXPECT_LT(with.change, 0.5 * without.change) << name;
    EXPECT_LT(four.frame, 0.8 * with.frame) << name;
  }
}

TEST_F(AntialiasingGl, WhatHasLeftIsNoGhost) {
  // The edge leaves the picture at once: its light goes with it.
  const EdgeScene scene(0.3);
  Renderer renderer(context(), programs(), scene, settingsFor(16));
  for (int frame = 0; frame < 8; ++frame) renderer.render(EdgeScene::view(0.01 * frame));
  renderer.render(EdgeScene::view(-kPicture));
  for (const glm::vec3& pixel : renderer.readRadiance().pixels) EXPECT_EQ(pixel, glm::vec3(0.0f));
}

}  // namespace
}  // namespace lucerna
