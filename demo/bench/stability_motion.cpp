// Scenes that move, in every technique. A renderer follows the scene through some frames; each must be the picture of a
// new renderer for a scene that stands still and was built with that moment's numbers, which are written here and not
// read from the curves. Other answers are closed forms: darkness around a lamp inside a box, the cosine of the sun.
// The 10,000 frames (technique "motion": they take minutes) must repeat the bits of their first loop (radiosity: within
// its error) and leave nothing behind.
#include "base/image.hpp"
#include "bench/stability.hpp"
#include "bench/stability_room.hpp"
#include "gl/live_objects.hpp"
#include "irradiance_cache/settings.hpp"
#include "lpv/settings.hpp"
#include "pathtracer/path_deviations.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/renderer.hpp"
#include "rsm/reflective_shadow_map.hpp"
#include "scene/curve.hpp"
#include "scene/motion.hpp"
#include "shared/commands.hpp"

#include <fmt/core.h>
#include <glm/gtc/matrix_transform.hpp>

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna::demo::bench {

namespace {

constexpr double kPi = 3.14159265358979323846;

struct How {
  std::string_view technique;
  ShadowTransport shadows = ShadowTransport::map;
};
constexpr std::array kHows{How{"direct"},
                           How{"direct", ShadowTransport::rays},
                           How{"rsm"},
                           How{"lpv"},
                           How{"irradiance-cache"},
                           How{"radiosity"},
                           How{"path"}};

constexpr double kRadiosityError = 1e-5;

RenderSettings settingsOf(const How& how, glm::ivec2 size = {32, 20}) {
  RenderSettings settings;
  settings.technique = how.technique;
  settings.shadows = how.shadows;
  settings.size = size;
  settings.pixelSamples = 1;
  settings.fullFloatTarget = true;
  settings.shadow.size = 256;
  settings.lights.pointSize = 64;
  settings.of<ReflectiveShadowMap::Settings>().size = 64;
  settings.of<LpvSettings>().cascades.cells = settings.of<IrradianceCacheSettings>().cascades.cells = 8;
  settings.of<IrradianceCacheSettings>().samples = 16;
  settings.of<IrradianceCacheSettings>().bounces = 1;
  settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 4.0;
  // Patches of a mirrored box come in another order and get other random rolls: 3e-4 with hemicubes of 32 pixels, 1e-5
  // of 64.
  settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 64;
  // Two solutions from two starts differ by twice this.
  settings.of<RadiosityView::Settings>().solution.error = kRadiosityError;
  settings.of<PathSettings>().samples = 4;
  return settings;
}

/// A room of side 10 without roof and front, a box in it, a lamp and a sun.
struct Numbers {
  glm::dvec3 box{0.0, -3.5, 0.0};  ///< its middle
  double size = 1.0;  ///< half its side; 0: no box
  glm::dvec3 lamp{1.0, 3.0, 1.0};
  float intensity = 20.0f;
  float sun = 3.0f;  ///< irradiance; 0: none
};

Scene still(const Numbers& n) {
  SceneParts parts("moving room");
  const int white = parts.material(glm::vec3(0.7f)), red = parts.material(glm::vec3(0.6f, 0.1f, 0.1f));
  parts.plate({0, -5, 0}, {0, 0, 10}, {10, 0, 0}, white);
  parts.plate({0, 0, -5}, {10, 0, 0}, {0, 10, 0}, white);
  parts.plate({-5, 0, 0}, {0, 10, 0}, {0, 0, 10}, red);
  parts.plate({5, 0, 0}, {0, 0, 10}, {0, 10, 0}, white);
  if (n.size > 0.0) parts.box(n.box - n.size, n.box + n.size, red);
  Scene& scene = parts.scene();
  if (n.sun > 0.0f) scene.sun = DirectionalLight{glm::normalize(glm::dvec3(-0.35, -1.0, -0.1)), glm::vec3(n.sun)};
  scene.points.push_back({n.lamp, glm::vec3(n.intensity)});
  Camera camera;
  camera.position = {0.5, 2.0, 12.0};
  camera.direction = glm::normalize(glm::dvec3(0.0, -1.0, 0.0) - camera.position);
  scene.cameras.push_back(camera);
  return std::move(scene);
}

/// What moves it: of Numbers, those that have keys.
struct Curves {
  Curve box, size, lamp, intensity;
};

Curve curve(std::vector<double> times, const std::vector<glm::dvec3>& values, Curve::Interpolation interpolation,
            bool loops = false) {
  Curve c{interpolation, false, loops, 3, std::move(times), {}};
  for (const glm::dvec3& v : values) c.values.insert(c.values.end(), {v.x, v.y, v.z});
  return c;
}

Curve curve(std::vector<double> times, std::vector<double> values, Curve::Interpolation interpolation,
            bool loops = false) {
  return {interpolation, false, loops, 1, std::move(times), std::move(values)};
}

constexpr auto kStep = Curve::Interpolation::step, kLinear = Curve::Interpolation::linear;

glm::dvec3 at(const Curve& c, double seconds, const glm::dvec3& otherwise) {
  std::array<double, 3> now{};
  if (c.times.empty()) return otherwise;
  c.at(seconds, now);
  return {now[0], now[1], now[2]};
}

double at(const Curve& c, double seconds, double otherwise) {
  std::array<double, 1> now{};
  if (c.times.empty()) return otherwise;
  c.at(seconds, now);
  return now[0];
}

/// `rest`: its numbers where no curve gives others; its box has the size 1 and stands at the origin.
Scene moving(Numbers rest, const Curves& curves) {
  const Numbers given = rest;
  rest.box = glm::dvec3(0.0);
  Scene scene = still(rest);
  SceneMotion& motion = motionOf(scene);
  using Part = SceneMotion::Part;
  constexpr std::size_t kWalls = 4;
  for (std::size_t m = kWalls; m < scene.meshes.size(); ++m) motion.meshes.push_back(m);
  motion[Part::objects] = [given, curves](Scene& posed, double t) {
    const glm::dmat4 placed = glm::translate(glm::dmat4(1.0), at(curves.box, t, given.box));
    const glm::dmat4 matrix = glm::scale(placed, glm::dvec3(at(curves.size, t, 1.0)));
    for (const std::size_t m : posed.motion->meshes) transformMesh(posed, posed.meshes[m], matrix);
  };
  motion[Part::points] = [given, curves](Scene& posed, double t) {
    posed.points[0].position = at(curves.lamp, t, given.lamp);
    posed.points[0].intensity = glm::vec3(static_cast<float>(at(curves.intensity, t, double{given.intensity})));
  };
  for (const Curve* c : {&curves.box, &curves.size, &curves.lamp, &curves.intensity})
    if (!c->times.empty()) motion.end = std::max(motion.end, c->times.back());
  finishMotion(scene);
  return scene;
}

/// Follows a scene from frame to frame, as the window does.
class Follower {
 public:
  Follower(const StabilityContext& c, Scene& scene, const RenderSettings& settings)
      : c_(c), scene_(scene), settings_(settings) {
    make();
  }
  const Image& draw(double seconds) {
    if (!renderer_->follow(c_.context, c_.programs, scene_, poseAt(scene_, seconds))) make();
    renderer_->renderToTheEnd(scene_.cameras.front());
    return picture_ = renderer_->readRadiance();
  }
  const Renderer& renderer() const { return *renderer_; }

 private:
  void make() { renderer_ = std::make_unique<Renderer>(c_.context, c_.programs, scene_, settings_); }
  const StabilityContext& c_;
  Scene& scene_;
  const RenderSettings& settings_;
  std::unique_ptr<Renderer> renderer_;
  Image picture_;
};

Image pictureOf(const StabilityContext& c, const Scene& scene, const RenderSettings& settings) {
  Renderer renderer(c.context, c.programs, scene, settings);
  renderer.renderToTheEnd(scene.cameras.front());
  return renderer.readRadiance();
}

/// The largest |a - b| / (1 + b) of any pixel and channel; NaN if a value is not finite.
double largestDifference(const Image& a, const Image& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < b.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double d = std::abs(static_cast<double>(a.pixels[i][k]) - static_cast<double>(b.pixels[i][k])) /
                       (1.0 + static_cast<double>(b.pixels[i][k]));
      if (!std::isfinite(d)) return NAN;
      worst = std::max(worst, d);
    }
  return worst;
}

struct Frame {
  double seconds;
  Numbers expected;
};

struct Course {
  const char *name, *parameter;
  Curves curves;
  std::vector<Frame> frames;
  bool inOwnBounds = false;  ///< what is expected has the bounds of its own surfaces, not of the whole motion
};

/// Rays of a refitted hierarchy may find the other of two surfaces that meet in an edge, and sums are in another order:
/// as in tests/gl/motion_gl_test.cpp.
constexpr double kSamePicture = 2e-4;
/// With another far plane: depths are rounded elsewhere, and rsm chooses by them what a pixel shares with those beside
/// it.
constexpr double kOtherFarPlane = 0.01;
/// A frame must show at least this much that the frame before did not, or else it proves nothing.
constexpr double kOtherPicture = 0.02;

Measurement follow(const StabilityContext& c, const How& how, const Course& course) {
  const double same = course.inOwnBounds ? kOtherFarPlane : kSamePicture;
  const RenderSettings settings = settingsOf(how);
  Scene scene = moving({}, course.curves);
  Follower follower(c, scene, settings);
  double worst = 0.0;
  Image before = pictureOf(c, scene, settings);
  for (const Frame& frame : course.frames) {
    const Image followed = follower.draw(frame.seconds);
    Scene alone = still(frame.expected);
    if (!course.inOwnBounds)
      alone.bounds = scene.bounds, alone.mainBounds = scene.mainBounds;  // maps and clip planes follow them
    // What moves is cut out of radiosity's patches last, and their hemicubes are rolled by place.
    alone.motion = std::make_shared<SceneMotion>(*scene.motion);
    std::erase_if(alone.motion->meshes, [&](std::size_t m) { return m >= alone.meshes.size(); });
    const Image right = pictureOf(c, alone, settings);
    const double wrong = largestDifference(followed, right);
    if (!(largestDifference(right, before) > kOtherPicture) || !std::isfinite(wrong)) return {same, NAN};
    worst = std::max(worst, wrong);
    before = right;
  }
  return {same, worst, 0.0, Rule::atMost};
}

std::vector<Course> courses() {
  std::vector<Course> all;
  const auto box = [](const glm::dvec3& place, double size = 1.0) {
    Numbers n;
    n.box = place;
    n.size = size;
    return n;
  };
  const auto lamp = [](const glm::dvec3& place, float intensity = 20.0f) {
    Numbers n;
    n.lamp = place;
    n.intensity = intensity;
    return n;
  };

  Curves teleport;
  teleport.box = curve({0.0, 1.0, 2.0}, {{-3, -3.5, -2}, {3, -3.5, 2}, {3, -3.5, 2}}, kStep);
  teleport.lamp = curve({0.0, 2.0}, {{1, 3, 1}, {-3, 1, -1}}, kStep);
  Numbers both = box({3, -3.5, 2});
  both.lamp = {-3, 1, -1};
  all.push_back({"teleport", "box, then lamp", teleport, {{1.0, box({3, -3.5, 2})}, {2.0, both}}});

  // A 64th of a second before it is 156 units away.
  Curves fast;
  fast.box = curve({0.0, 1.0}, {{-5000, -3.5, 0}, {5000, -3.5, 0}}, kLinear);
  all.push_back({"moves at 1e4 units a second",
                 "box",
                 fast,
                 {{0.5, box({0, -3.5, 0})}, {0.515625, box({156.25, -3.5, 0})}, {0.5, box({0, -3.5, 0})}}});
  Curves fastLamp;
  fastLamp.lamp = curve({0.0, 1.0}, {{-5000, 3, 1}, {5000, 3, 1}}, kLinear);
  all.push_back(
      {"moves at 1e4 units a second", "lamp", fastLamp, {{0.5, lamp({0, 3, 1})}, {0.515625, lamp({156.25, 3, 1})}}});

  // Mirrored about its middle a box is itself.
  Curves shrinking;
  shrinking.size = curve({0.0, 1.0, 2.0, 3.0}, {1.0, 0.0, -1.0, 1e-20}, kLinear);
  all.push_back({"scale through 0",
                 "1 to -1, and 1e-20",
                 shrinking,
                 {{0.5, box({0, -3.5, 0}, 0.5)},
                  {1.0, box({0, -3.5, 0}, 0.0)},
                  {1.5, box({0, -3.5, 0}, 0.5)},
                  {2.0, box({0, -3.5, 0})},
                  {3.0, box({0, -3.5, 0}, 0.0)}}});

  Curves leaving;
  leaving.box = curve({0.0, 1.0, 2.0}, {{0, -3.5, 0}, {0, -3.5, -10}, {0, -3.5, 110}}, kLinear);
  all.push_back({"through a wall and out of the scene",
                 "box",
                 leaving,
                 {{0.5, box({0, -3.5, -5})},
                  {1.0, box({0, -3.5, -10})},
                  {1.125, box({0, -3.5, 5})},
                  {2.0, box({0, -3.5, 110})}}});

  // The room is then drawn as if the box had never been there.
  Curves flying;
  flying.box = curve({0.0, 1.0, 2.0}, {{0, -3.5, 0}, {1e6, -3.5, 0}, {0, -3.5, 0}}, kLinear);
  all.push_back({"flies off",
                 "box, to 1e6 units",
                 flying,
                 {{0.01, box({0, -3.5, 0}, 0.0)}, {0.0, box({0, -3.5, 0})}, {1.0, box({0, -3.5, 0}, 0.0)}},
                 true});

  Curves entering;
  entering.lamp = curve({0.0, 1.0, 2.0}, {{1, 3, 1}, {0, -3.5, 0}, {-3, 1, -1}}, kLinear);
  all.push_back(
      {"lamp into a box and out again", "lamp", entering, {{1.0, lamp({0, -3.5, 0})}, {2.0, lamp({-3, 1, -1})}}});

  Curves switching;
  switching.intensity = curve({0.0, 1.0, 2.0}, {20.0, 5.0, 20.0}, kStep, true);
  switching.size = curve({0.0, 1.0, 2.0}, {1.0, 0.0, 1.0}, kStep, true);
  Numbers off = box({0, -3.5, 0}, 0.0);
  off.intensity = 5.0f;
  Course each{"switch every frame", "lamp and box", switching, {}};
  for (int k = 1; k <= 12; ++k) each.frames.push_back({static_cast<double>(k), k % 2 ? off : Numbers{}});
  all.push_back(each);
  Curves blinking;
  blinking.intensity = curve({0.0, 1.0, 2.0}, {20.0, 0.0, 20.0}, kStep, true);
  Course blinks{"switch every frame", "lamp to 0", blinking, {}};
  for (int k = 1; k <= 6; ++k) blinks.frames.push_back({static_cast<double>(k), lamp({1, 3, 1}, k % 2 ? 0.0f : 20.0f)});
  all.push_back(blinks);

  // A loop of 4 s: 1e9 is a multiple of it.
  Curves loop;
  loop.box = curve({0.0, 2.0, 4.0}, {{-3, -3.5, 0}, {3, -3.5, 0}, {-3, -3.5, 0}}, kLinear, true);
  all.push_back({"time",
                 "0, -1.5, +-1e9",
                 loop,
                 {{1.0, box({0, -3.5, 0})},
                  {0.0, box({-3, -3.5, 0})},
                  {-1.5, box({1.5, -3.5, 0})},
                  {1e9, box({-3, -3.5, 0})},
                  {1e9 + 1.0, box({0, -3.5, 0})},
                  {-1e9 - 2.0, box({3, -3.5, 0})}}});
  Curves once;
  once.box = curve({0.0, 4.0}, {{-3, -3.5, 0}, {3, -3.5, 0}}, kLinear);
  all.push_back(
      {"time, without a loop",
       "0, -1e9, 1e9",
       once,
       {{2.0, box({0, -3.5, 0})}, {-1e9, box({-3, -3.5, 0})}, {1e9, box({3, -3.5, 0})}, {0.0, box({-3, -3.5, 0})}}});
  return all;
}

std::string nameOf(const How& how, const std::string& what) {
  return fmt::format("moving scene{}: {}", how.shadows == ShadowTransport::rays ? ", by rays" : "", what);
}

/// The lamp alone, and where it is inside a closed box nothing else is lit. The gathering of reflective shadow maps and
/// the grids of light propagation do not know that walls are in the way; their direct light does.
Measurement lampInABox(const StabilityContext& c, const How& how) {
  RenderSettings settings = settingsOf(how);
  if (how.technique == "rsm" || how.technique == "lpv") settings.component = Component::direct;
  Curves entering;
  entering.lamp = curve({0.0, 1.0}, {{1, 3, 1}, {0, -3.5, 0}}, kLinear);
  Numbers noSun;
  noSun.sun = 0.0f;
  Scene scene = moving(noSun, entering);
  Follower follower(c, scene, settings);
  double brightest = 0.0;
  for (const double t : {0.0, 1.0}) {
    const Image picture = follower.draw(t);
    brightest = 0.0;
    for (const glm::vec3& p : picture.pixels)
      brightest = std::max({brightest, static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
    if (t == 0.0 && !(brightest > 0.1)) return {0.0, NAN};
  }
  return {0.0, brightest, 0.0};
}

/// A lone white floor: radiance E cos(theta) / pi, none once the sun is below the horizon. Largest error of any pixel
/// and angle, over E / pi. The sun goes through zenith and horizon in one go.
Measurement sunOverAFloor(const StabilityContext& c, const How& how) {
  SceneParts parts("floor");
  parts.plate({0, 0, 0}, {0, 0, 8}, {8, 0, 0}, parts.material(glm::vec3(1.0f)));
  Camera camera;
  camera.position = {0.0, 4.0, 0.0};
  camera.direction = {0.0, -1.0, 0.0};
  camera.up = {0.0, 0.0, -1.0};
  parts.scene().cameras.push_back(camera);
  parts.scene().sun = DirectionalLight{{0.0, -1.0, 0.0}, glm::vec3(3.0f)};
  Scene scene = std::move(parts.scene());
  motionOf(scene)[SceneMotion::Part::sun] = [](Scene& posed, double degrees) {
    posed.sun->direction = {std::sin(degrees * kPi / 180.0), -std::cos(degrees * kPi / 180.0), 0.0};
  };
  finishMotion(scene);
  RenderSettings settings = settingsOf(how);
  // The floor is all there is: it reflects no light to itself, but cells of a grid are as large as it is.
  if (how.technique == "rsm" || how.technique == "lpv") settings.component = Component::direct;
  Follower follower(c, scene, settings);
  double worst = 0.0;
  for (const double degrees :
       {-91.0, -90.0, -60.0, -1e-6, 0.0, 1e-6, 45.0, 89.0, 90.0 - 1e-6, 90.0, 90.0 + 1e-6, 180.0}) {
    const double right = std::max(std::cos(degrees * kPi / 180.0), 0.0);
    for (const glm::vec3& p : follower.draw(degrees).pixels)
      for (int k = 0; k < 3; ++k) {
        const double wrong = std::abs(static_cast<double>(p[k]) * kPi / 3.0 - right);
        if (!std::isfinite(wrong)) return {1e-4, NAN};
        worst = std::max(worst, wrong);
      }
  }
  return {1e-4, worst, 0.0, Rule::atMost};
}

// ------------------------------------------------------------------------------------------------- 10,000 frames

constexpr int kLoop = 100, kFrames = 10000;

/// Of this process in bytes, without what free() keeps for later.
double residentBytes() {
  malloc_trim(0);
  std::ifstream file("/proc/self/statm");
  double pages = 0.0, resident = 0.0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

struct LongRun {
  /// Of the last loop, with other bits than in the first; of radiosity, which starts from the frame before, with other
  /// light than its error allows.
  double otherFrames = 0.0;
  double notFinite = 0.0;  ///< pixels
  double moreObjects = 0.0, moreBytes = 0.0;  ///< of GL, since the end of the first loop
  double growth = 0.0;  ///< of the resident set in the quarter in which it grew least, over that after the first one
};

LongRun runLong(const StabilityContext& c, const How& how) {
  RenderSettings settings = settingsOf(how, {16, 10});
  settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 10.0;
  settings.of<RadiosityView::Settings>().solution.hemicubes.resolution = 8;
  // Seconds are binary fractions, so that moments of all loops have the same bits.
  constexpr double kSeconds = 1.0 / 64.0, kLoopSeconds = kLoop * kSeconds;
  Curves curves;
  curves.box =
      curve({0.0, 0.5 * kLoopSeconds, kLoopSeconds}, {{-3, -3.5, 0}, {3, -2, -2}, {-3, -3.5, 0}}, kLinear, true);
  curves.lamp = curve({0.0, 0.5 * kLoopSeconds, kLoopSeconds}, {{1, 3, 1}, {-3, 1, -1}, {1, 3, 1}}, kLinear, true);
  curves.intensity = curve({0.0, kSeconds, 2.0 * kSeconds}, {20.0, 5.0, 20.0}, kStep, true);
  Scene scene = moving({}, curves);
  Follower follower(c, scene, settings);
  LongRun run;
  std::vector<Image> first;
  std::size_t objects = 0, bytes = 0;
  std::array<double, 4> resident{};
  for (int k = 0; k < kFrames && !interrupted(); ++k) {
    const Image& picture = follower.draw(k * kSeconds);
    gl::throwIfError("a frame of a loop");
    for (const glm::vec3& p : picture.pixels)
      run.notFinite += !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    if (k < kLoop) first.push_back(picture);
    if (k >= kFrames - kLoop) {
      const Image& then = first[static_cast<std::size_t>(k % kLoop)];
      run.otherFrames += how.technique == "radiosity" ? !(largestDifference(picture, then) <= 2.0 * kRadiosityError)
                                                      : picture.pixels != then.pixels;
    }
    if (k + 1 == kLoop) objects = gl::countLiveObjects(), bytes = follower.renderer().gpuBytes();
    if ((k + 1) % (kFrames / 4) == 0) resident[static_cast<std::size_t>((k + 1) / (kFrames / 4) - 1)] = residentBytes();
  }
  run.moreObjects = static_cast<double>(gl::countLiveObjects()) - static_cast<double>(objects);
  run.moreBytes = static_cast<double>(follower.renderer().gpuBytes()) - static_cast<double>(bytes);
  run.growth = std::numeric_limits<double>::infinity();
  for (std::size_t q = 1; q < resident.size(); ++q)
    run.growth = std::min(run.growth, (resident[q] - resident[q - 1]) / resident[0]);
  return run;
}

void addLongRuns(std::vector<StabilityCase>& cases) {
  for (const How& how : kHows) {
    const auto run = std::make_shared<std::optional<LongRun>>();  // once for its rows
    const auto add = [&](const char* name, std::function<Measurement(const LongRun&)> judge) {
      cases.push_back({"motion", fmt::format("{} frames: {}", kFrames, name),
                       fmt::format("{}{}", how.technique, how.shadows == ShadowTransport::rays ? ", by rays" : ""),
                       [how, run, judge = std::move(judge)](const StabilityContext& c) {
                         if (!*run) *run = runLong(c, how);
                         return judge(**run);
                       },
                       true});
    };
    add("pixels not finite, and no GL error", [](const LongRun& r) { return Measurement{0.0, r.notFinite, 0.0}; });
    add("pictures of the last loop unlike those of the first", [](const LongRun& r) {
      return Measurement{0.0, r.otherFrames, 0.0};
    });
    // A leak of one in each loop would be 99.
    add("GL objects more than after the first loop", [](const LongRun& r) {
      return Measurement{0.5 * kFrames / kLoop, r.moreObjects, 0.0, Rule::atMost};
    });
    add("GL bytes more than after the first loop", [](const LongRun& r) { return Measurement{0.0, r.moreBytes, 0.0}; });
    // A leak grows in every quarter; a driver's pool that fills, in one. A quarter of a percent is as in
    // tests/gl/memory_test.cpp: some bytes a frame.
    add("growth of the resident set in its best quarter", [](const LongRun& r) {
      return Measurement{0.0025, r.growth, 0.0, Rule::atMost};
    });
  }
}

}  // namespace

void addMotionCases(std::vector<StabilityCase>& cases) {
  for (const How& how : kHows) {
    const auto add = [&](const char* what, const char* parameter,
                         std::function<Measurement(const StabilityContext&)> run) {
      cases.push_back({std::string(how.technique), nameOf(how, what), parameter, std::move(run)});
    };
    for (const Course& course : courses())
      add(course.name, course.parameter, [how, course](const StabilityContext& c) { return follow(c, how, course); });
    add("lamp inside a box: largest radiance", "no other light",
        [how](const StabilityContext& c) { return lampInABox(c, how); });
    add("sun through zenith and horizon: error", "over a floor",
        [how](const StabilityContext& c) { return sunOverAFloor(c, how); });
  }
  addLongRuns(cases);
}

}  // namespace lucerna::demo::bench
