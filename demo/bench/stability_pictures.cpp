// Stiff and extreme cases of whole pictures: units, scale, place, resolution, nothing to light. A room without a roof, lit by the sun; answers are ratios that must be 1, or exact zeros.
#include "bench/stability.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>

namespace lucerna::demo::bench {

namespace {

struct Room {
  double scale = 1.0;
  glm::dvec3 place{0.0};          ///< of its middle, scene units
  float albedo = 0.7f, irradiance = 3.0f;
  glm::dvec3 sun{-0.35, -1.0, -0.1};
  bool badTriangles = false;      ///< zero area, slivers, twice the same
};

class RoomScene {
 public:
  explicit RoomScene(const Room& room) {
    scene_.name = "stability";
    const double s = 10.0 * room.scale, h = 0.5 * s;
    material(glm::vec3(room.albedo));
    material(room.albedo * glm::vec3(0.85f, 0.15f, 0.15f));
    material(room.albedo * glm::vec3(0.15f, 0.85f, 0.15f));
    plate(room.place + glm::dvec3(0, -h, 0), {0, 0, s}, {s, 0, 0}, 0);  // floor
    plate(room.place + glm::dvec3(0, 0, -h), {s, 0, 0}, {0, s, 0}, 0);  // back
    plate(room.place + glm::dvec3(-h, 0, 0), {0, s, 0}, {0, 0, s}, 1);  // left
    plate(room.place + glm::dvec3(h, 0, 0), {0, 0, s}, {0, s, 0}, 2);   // right
    if (room.badTriangles) addBad(room.place, s);
    scene_.sun = DirectionalLight{glm::normalize(room.sun), glm::vec3(room.irradiance)};
    Camera camera;
    camera.position = room.place + room.scale * glm::dvec3(0.0, 1.0, 12.0);
    camera.direction = glm::normalize(glm::dvec3(0.0, -2.0, -12.0));
    scene_.cameras.push_back(camera);
  }
  const Scene& scene() const { return scene_; }

 private:
  void material(const glm::vec3& albedo) { scene_.materials.emplace_back().diffuse = albedo; }

  void triangles(const std::vector<glm::dvec3>& corners, const glm::vec3& normal, int material, std::initializer_list<std::uint32_t> order) {
    Mesh& mesh = scene_.meshes.emplace_back();
    mesh.firstIndex = static_cast<std::uint32_t>(scene_.indices.size());
    mesh.indexCount = static_cast<std::uint32_t>(order.size());
    mesh.material = material;
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    for (const glm::dvec3& p : corners) {
      scene_.vertices.push_back({glm::vec3(p), glm::vec2(0.0f), normal});
      mesh.bounds.add(p);
    }
    for (const std::uint32_t i : order) scene_.indices.push_back(first + i);
    scene_.bounds.add(mesh.bounds);
  }
  void plate(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v, int material) {
    std::vector<glm::dvec3> corners;
    for (const glm::dvec2& c : {glm::dvec2(-.5, -.5), glm::dvec2(.5, -.5), glm::dvec2(.5, .5), glm::dvec2(-.5, .5)}) corners.push_back(centre + c.x * u + c.y * v);
    triangles(corners, glm::vec3(glm::normalize(glm::cross(u, v))), material, {0, 1, 2, 0, 2, 3});
  }
  void addBad(const glm::dvec3& o, double s) {
    const glm::dvec3 a = o + 0.3 * s * glm::dvec3(-1, -1, 0), b = a + glm::dvec3(0, 0.2 * s, 0);
    triangles({a, a, a}, {0, 1, 0}, 0, {0, 1, 2});
    triangles({a, b, 0.5 * (a + b)}, {0, 0, 1}, 0, {0, 1, 2});
    triangles({o + 0.5 * s * glm::dvec3(-1, -1, -1), o + 0.5 * s * glm::dvec3(1, -1, -1), o + 0.5 * s * glm::dvec3(1, -1.0 + 1e-12, -1)}, {0, 0, 1}, 0, {0, 1, 2});
  }

  Scene scene_;
};

struct View {
  std::string technique;
  Component component = Component::all;
  glm::ivec2 size{48, 32};
  std::vector<std::string> settings;
};

Image picture(const StabilityContext& c, const Room& room, const View& view) {
  PictureOptions options;
  options.technique = view.technique;
  options.settings = {"shadow.size=512", "rsm.size=128"};
  options.settings.insert(options.settings.end(), view.settings.begin(), view.settings.end());
  std::optional<float> exposure;
  RenderSettings settings = options.parse(exposure);
  settings.size = view.size;
  settings.component = view.component;
  settings.fullFloatTarget = true;
  const RoomScene scene(room);
  Renderer renderer(c.context, c.programs, scene.scene(), settings);
  renderer.render(scene.scene().cameras.front());
  return renderer.readRadiance();
}

double meanOfPicture(const StabilityContext& c, const Room& room, const View& view) {
  const glm::dvec3 mean = meanOf(picture(c, room, view));
  return (mean.x + mean.y + mean.z) / 3.0;
}

double notFinite(const Image& image) {
  double count = 0.0;
  for (const glm::vec3& p : image.pixels) count += !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  return count;
}

void add(std::vector<StabilityCase>& cases, const std::string& technique, std::string name, std::string parameter, std::function<Measurement(const StabilityContext&)> run) {
  cases.push_back({technique, std::move(name), std::move(parameter), std::move(run)});
}

void addUnits(std::vector<StabilityCase>& cases, const View& view) {
  for (const float factor : {1e-9f, 1e9f})
    add(cases, view.technique, "mean over the sun's irradiance, against 1x", fmt::format("sun {:g}x", static_cast<double>(factor)), [view, factor](const StabilityContext& c) {
      Room room;
      const double usual = meanOfPicture(c, room, view);
      room.irradiance *= factor;
      return Measurement{1.0, meanOfPicture(c, room, view) / factor / usual, 1e-3};
    });
  for (const double scale : {std::exp2(-20), std::exp2(20), 1e-3, 1e6})
    add(cases, view.technique, "mean of a scaled scene, against 1x", fmt::format("scale {:g}", scale), [view, scale](const StabilityContext& c) {
      Room room;
      const double usual = meanOfPicture(c, room, view);
      room.scale = scale;
      // Powers of two change no rounding; others may shift a cell or a texel.
      return Measurement{1.0, meanOfPicture(c, room, view) / usual, std::exp2(std::round(std::log2(scale))) == scale ? 1e-5 : 5e-3};
    });
  for (const double distance : {1e3, 1e4})
    add(cases, view.technique, "mean of a scene far from the origin", fmt::format("{:g} room sides", 0.1 * distance), [view, distance](const StabilityContext& c) {
      Room room;
      const double usual = meanOfPicture(c, room, view);
      room.place = glm::dvec3(distance, -0.5 * distance, 0.7 * distance);
      return Measurement{1.0, meanOfPicture(c, room, view) / usual, 0.02};
    });
}

void addExtremes(std::vector<StabilityCase>& cases, const View& view) {
  const auto finite = [&](const char* name, const char* parameter, const Room& room, View v) {
    add(cases, view.technique, std::string(name) + ": pixels not finite", parameter, [room, v](const StabilityContext& c) { return Measurement{0.0, notFinite(picture(c, room, v)), 0.0}; });
  };
  Room room;
  room.place = glm::dvec3(1e6);
  finite("very far from the origin", "1e5 room sides", room, view);
  room = {};
  room.albedo = 1.0f;
  finite("walls that absorb nothing", "albedo 1", room, view);
  room = {};
  room.sun = {-1.0, 0.0, -1e-7};
  finite("sun along the floor", "grazing", room, view);
  room = {};
  View tiny = view;
  tiny.size = {1, 1};
  finite("a picture of one pixel", "1x1", room, tiny);
  add(cases, view.technique, "no light: mean", "sun 0", [view](const StabilityContext& c) {
    Room dark;
    dark.irradiance = 0.0f;
    return Measurement{0.0, meanOfPicture(c, dark, view), 0.0};
  });
  add(cases, view.technique, "zero-area, needle and doubled triangles: mean", "3 more", [view](const StabilityContext& c) {
    Room bad;
    bad.badTriangles = true;
    return Measurement{1.0, meanOfPicture(c, bad, view) / meanOfPicture(c, {}, view), 2e-3};
  });
}

void addIndirect(std::vector<StabilityCase>& cases, View view) {
  view.component = Component::indirect;
  add(cases, view.technique, "black walls: mean of indirect light", "albedo 0", [view](const StabilityContext& c) {
    Room room;
    room.albedo = 0.0f;
    return Measurement{0.0, meanOfPicture(c, room, view), 0.0};
  });
  for (const int size : {32, 64, 512})
    add(cases, view.technique, "mean of indirect light, against a map of 128", fmt::format("rsm.size={}", size), [view, size](const StabilityContext& c) {
      View other = view;
      other.settings = {fmt::format("rsm.size={}", size)};
      return Measurement{1.0, meanOfPicture(c, {}, other) / meanOfPicture(c, {}, view), size < 64 ? 0.15 : 0.05};
    });
}

void addRsm(std::vector<StabilityCase>& cases) {
  const View view{"rsm", Component::indirect, {48, 32}, {}};
  add(cases, "rsm", "one sample: pixels not finite", "rsm.samples=1", [view](const StabilityContext& c) {
    View one = view;
    one.settings = {"rsm.samples=1"};
    return Measurement{0.0, notFinite(picture(c, {}, one)), 0.0};
  });
  add(cases, "rsm", "mean of 16384 samples, against 1024", "rsm.samples=16384", [](const StabilityContext& c) {
    const View many{"rsm", Component::indirect, {24, 16}, {"rsm.samples=16384", "rsm.interpolate=off"}}, usual{"rsm", Component::indirect, {24, 16}, {"rsm.samples=1024", "rsm.interpolate=off"}};
    return Measurement{1.0, meanOfPicture(c, {}, many) / meanOfPicture(c, {}, usual), 0.03};
  });
  add(cases, "rsm", "reach of half a texel: pixels not finite", "rsm.radius=0.004", [view](const StabilityContext& c) {
    View near = view;
    near.settings = {"rsm.radius=0.004"};
    return Measurement{0.0, notFinite(picture(c, {}, near)), 0.0};
  });
}

}  // namespace

void addPictureCases(std::vector<StabilityCase>& cases) {
  for (const char* technique : {"direct", "rsm", "lpv"}) {
    const View view{technique, Component::all, {48, 32}, {}};
    addUnits(cases, view);
    addExtremes(cases, view);
    if (std::string_view(technique) != "direct") addIndirect(cases, view);
  }
  addRsm(cases);
}

}  // namespace lucerna::demo::bench
