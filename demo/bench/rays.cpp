// lucerna bench rays: rays per second through the hierarchy in a compute shader, compared with Embree's single rays on
// the same rays in the same run.
#include "base/clock.hpp"
#include "bench/bench.hpp"

#include "base/error.hpp"
#include "base/statistics.hpp"
#include "bench/embree_rays.hpp"
#include "bench/rays_bench.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"
#include "rays/ray_scene.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace lucerna::demo {

namespace bench {

RaysOptions::RaysOptions() : splitBudget(BvhSettings{}.splitBudget) {}

namespace {

double secondsOf(const std::function<void()>& work) {
  const auto start = Clock::now();
  work();
  return secondsSince(start);
}

class Tracer {
 public:
  Tracer(gl::ProgramLibrary& programs, const RayScene& scene, std::size_t most)
      : programs_(programs),
        scene_(scene),
        rays_("rays", most * sizeof(PlainRay), nullptr, gl::Usage::dynamicDraw),
        hits_("hits", most * sizeof(PlainHit), nullptr, gl::Usage::dynamicRead) {
    const std::vector<std::uint32_t> none(most, PlainHit::kNone);
    skipped_ = gl::Buffer("skipped", most * sizeof none[0], none.data(), gl::Usage::staticDraw);
  }

  const gl::Program& program(bool anyHit, bool countWork) {
    return programs_.loadCompute("trace rays", "rays/trace_rays.comp",
                                 {{"ALPHA_MASKS", 0},
                                  {"ANY_HIT", anyHit},
                                  {"COUNT_WORK", countWork},
                                  {"OFFSET_ORIGINS", 0},
                                  {"SHARED_STACK", scene_.sharedStack()}});
  }
  void upload(const std::vector<PlainRay>& rays) { rays_.upload(0, rays.size() * sizeof rays[0], rays.data()); }
  /// Traces the uploaded rays, in submissions small enough for any watchdog.
  void trace(const gl::Program& program, std::size_t count) {
    program.use();
    scene_.bind();
    rays_.bindStorage(2);
    hits_.bindStorage(3);
    skipped_.bindStorage(4);
    program.set("rayCount", static_cast<int>(count));
    const gl::ComputePass pass("trace rays", gl::Barrier::storage);
    for (std::size_t first = 0; first < count; first += kBatch) {
      program.set("firstRay", static_cast<int>(first));
      pass.dispatch(glm::ivec3(static_cast<int>(std::min(kBatch, count - first)), 1, 1), glm::ivec3(64, 1, 1));
    }
    gl::finish();
  }
  std::vector<PlainHit> hits(std::size_t count) const {
    std::vector<PlainHit> all = hits_.read<PlainHit>();
    all.resize(count);
    return all;
  }

 private:
  static constexpr std::size_t kBatch = 1 << 16;
  gl::ProgramLibrary& programs_;
  const RayScene& scene_;
  gl::Buffer rays_, hits_, skipped_;
};

/// A point on a surface, with the normal facing the ray that found it.
struct SurfacePoint {
  glm::vec3 position, normal;
};

std::vector<SurfacePoint> surfacePoints(const Scene& scene, const glm::dvec3& origin, const std::vector<PlainRay>& rays,
                                        const std::vector<PlainHit>& hits) {
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].triangle == PlainHit::kNone) continue;
    const auto corner = [&](std::size_t k) {
      return glm::dvec3(scene.vertices[scene.indices[3 * hits[i].triangle + k]].position) - origin;
    };
    const glm::dvec3 a = corner(0), b = corner(1), c = corner(2);
    glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(normal, glm::dvec3(rays[i].direction)) > 0.0) normal = -normal;
    const glm::dvec3 p = a + static_cast<double>(hits[i].barycentrics.x) * (b - a) +
                         static_cast<double>(hits[i].barycentrics.y) * (c - a);
    const double magnitude = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    points.push_back({glm::vec3(p + normal * (magnitude * 0x1p-18)), glm::vec3(normal)});
  }
  return points;
}

std::vector<PlainRay> primaryRays(const Camera& camera, const glm::dvec3& origin, int count) {
  const int side = static_cast<int>(std::sqrt(count));
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                   up = glm::cross(right, camera.direction);
  const double half = camera.halfHeight();
  std::vector<PlainRay> rays;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double u = (2.0 * x + 1.0) / side - 1.0, v = (2.0 * y + 1.0) / side - 1.0;
      const glm::dvec3 across = half * (u * right + v * up);
      const bool parallel = camera.isOrthographic();
      rays.push_back({.origin = camera.position + (parallel ? across : glm::dvec3(0.0)) - origin,
                      .direction = glm::normalize(camera.direction + (parallel ? glm::dvec3(0.0) : across))});
    }
  return rays;
}

/// Cosine-distributed about the normals.
std::vector<PlainRay> diffuseRays(const std::vector<SurfacePoint>& points, std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<PlainRay> rays;
  for (std::size_t i = 0; i < count && !points.empty(); ++i) {
    const SurfacePoint& p = points[i % points.size()];
    const double z = 1.0 - 2.0 * unit(random), angle = 2.0 * std::numbers::pi * unit(random),
                 r = std::sqrt(1.0 - z * z);
    const glm::dvec3 d = glm::dvec3(p.normal) * 1.000001 + glm::dvec3(r * std::cos(angle), r * std::sin(angle), z);
    rays.push_back({.origin = p.position, .direction = glm::normalize(d)});
  }
  return rays;
}

/// From each point to another one chosen at random; tests whether anything lies between.
std::vector<PlainRay> shadowRays(const std::vector<SurfacePoint>& points, std::size_t count, std::mt19937& random) {
  std::vector<PlainRay> rays;
  for (std::size_t i = 0; i < count && points.size() > 1; ++i) {
    const glm::vec3 from = points[i % points.size()].position, to = points[random() % points.size()].position;
    if (from != to) rays.push_back({.origin = from, .direction = to - from, .tMax = 0.999f});
  }
  return rays;
}

struct Kind {
  std::string name;
  bool anyHit;
  std::vector<PlainRay> rays;
  std::vector<double> ours{}, embree{}, ratios{};  ///< Mrays/s
  std::size_t differ = 0;
  double nodes = 0.0, triangles = 0.0, utilisation = 0.0;
};

void countWork(Tracer& tracer, Kind& kind) {
  tracer.upload(kind.rays);
  tracer.trace(tracer.program(kind.anyHit, true), kind.rays.size());
  const std::vector<PlainHit> work = tracer.hits(kind.rays.size());
  double slots = 0.0;
  constexpr std::size_t kLanes = 8;
  for (std::size_t i = 0; i + kLanes <= work.size(); i += kLanes) {
    float slowest = 0.0f;
    for (std::size_t k = i; k < i + kLanes; ++k) slowest = std::max(slowest, work[k].t);
    slots += kLanes * static_cast<double>(slowest);
  }
  for (const PlainHit& w : work) kind.nodes += w.t, kind.triangles += w.barycentrics.x;
  kind.utilisation = slots > 0.0 ? kind.nodes / slots : 1.0;
  kind.nodes /= static_cast<double>(work.size());
  kind.triangles /= static_cast<double>(work.size());
}

std::size_t countDifferences(const std::vector<PlainHit>& a, const std::vector<PlainHit>& b, bool anyHit) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool hitA = a[i].triangle != PlainHit::kNone, hitB = b[i].triangle != PlainHit::kNone;
    n += hitA != hitB || (!anyHit && hitA && std::abs(a[i].t - b[i].t) > 1e-4f * b[i].t);
  }
  return n;
}

std::string spread(const std::vector<double>& values) {
  return values.empty()
             ? "-"
             : fmt::format("{:.3f} ({:.3f}..{:.3f})", median(values), percentile(values, 0.0), percentile(values, 1.0));
}

}  // namespace

RaysResult measureRays(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                       const RaysOptions& options, bool quiet) {
  if (options.rays < 1024 || options.rays > (1 << 22))
    throwBadInput("--rays {}: from 1024 to {}", options.rays, 1 << 22);
  if (options.repeats < 1) throwBadInput("--repeats {}: at least 1", options.repeats);
  RayScene::Settings settings;
  settings.bvh.splitBudget = options.splitBudget;
  const RayScene rayScene(scene, context.capabilities(), settings);
  const auto count = static_cast<std::size_t>(options.rays);
  Tracer tracer(programs, rayScene, count);
  std::optional<EmbreeRays> embree;
  double embreeBuild = 0.0;
  if (EmbreeRays::isBuilt()) embreeBuild = secondsOf([&] { embree.emplace(scene, rayScene.origin()); });

  // Rays of three kinds, each starting from the hits of the previous ones.
  const auto hitsOf = [&](const std::vector<PlainRay>& rays) {
    tracer.upload(rays);
    tracer.trace(tracer.program(false, false), rays.size());
    return tracer.hits(rays.size());
  };
  std::mt19937 random(1);
  std::vector<Kind> kinds(3);
  kinds[0] = {.name = "primary",
              .anyHit = false,
              .rays = primaryRays(chooseCamera(scene, options.camera), rayScene.origin(), options.rays)};
  std::vector<SurfacePoint> points = surfacePoints(scene, rayScene.origin(), kinds[0].rays, hitsOf(kinds[0].rays));
  if (points.size() < 2)
    throwBadInput("{}: the camera sees nothing of it; choose another with --camera", scene.file.string());
  kinds[1] = {.name = "shadow", .anyHit = true, .rays = shadowRays(points, count, random)};
  // Second-bounce rays if there are any: those of the first bounce still start side by side.
  const std::vector<PlainRay> first = diffuseRays(points, count, random);
  if (const std::vector<SurfacePoint> second = surfacePoints(scene, rayScene.origin(), first, hitsOf(first));
      second.size() > points.size() / 4)
    points = second;
  kinds[2] = {.name = "diffuse", .anyHit = false, .rays = diffuseRays(points, count, random)};

  // Alternate with Embree, so that a ratio compares the same moment.
  Progress progress("bench rays", options.repeats * static_cast<int>(kinds.size()), quiet);
  int done = 0;
  for (Kind& kind : kinds) {
    const gl::Program& program = tracer.program(kind.anyHit, false);
    const double million = 1e-6 * static_cast<double>(kind.rays.size());
    countWork(tracer, kind);
    tracer.trace(program, kind.rays.size());  // warm-up
    const std::vector<PlainHit> ours = tracer.hits(kind.rays.size());
    std::vector<PlainHit> theirs(kind.rays.size());
    if (embree) {
      embree->trace(kind.rays, theirs, kind.anyHit);
      kind.differ = countDifferences(ours, theirs, kind.anyHit);
    }
    for (int r = 0; r < options.repeats && !interrupted(); ++r) {
      kind.ours.push_back(million / secondsOf([&] { tracer.trace(program, kind.rays.size()); }));
      if (embree) {
        kind.embree.push_back(million / secondsOf([&] { embree->trace(kind.rays, theirs, kind.anyHit); }));
        kind.ratios.push_back(kind.ours.back() / kind.embree.back());
      }
      progress.update(++done);
    }
  }

  // Results as JSON and as a table.
  const BvhStatistics& s = rayScene.statistics();
  nlohmann::ordered_json json{{"renderer", context.capabilities().renderer},
                              {"scene", scene.file.string()},
                              {"triangles", s.triangles},
                              {"degenerate", s.degenerate},
                              {"references", s.references},
                              {"nodes", s.nodes},
                              {"depth", s.depth},
                              {"sah_cost", s.sahCost},
                              {"build_seconds", s.seconds},
                              {"gpu_bytes", rayScene.gpuBytes()}};
  const auto number = [](const std::vector<double>& v) {
    return v.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(median(v));
  };
  json["mrays_per_s"] = number(kinds[2].ours);
  json["embree_mrays_per_s"] = number(kinds[2].embree);
  json["ratio"] = number(kinds[2].ratios);
  if (embree) json["embree_build_seconds"] = embreeBuild;
  RaysResult result;
  result.text = fmt::format(
      "{}: {} triangles ({} degenerate dropped), {} references, {} nodes, depth {}, {:.1f} MB, built in {:.2f} s\non "
      "{}\n",
      scene.name, s.triangles, s.degenerate, s.references, s.nodes, s.depth,
      1e-6 * static_cast<double>(rayScene.gpuBytes()), s.seconds, context.capabilities().renderer);
  result.text += fmt::format("{:<9}{:>24}{:>24}{:>22}{:>8}{:>11}{:>11}{:>11}{:>9}\n", "rays", "Mrays/s",
                             "Embree Mrays/s", "ratio", "differ", "nodes/ray", "tris/ray", "bytes/ray", "lanes");
  for (const Kind& k : kinds) {
    const double bytes = 16.0 * (BVH_NODE_TEXELS * k.nodes + BVH_TRIANGLE_TEXELS * k.triangles);
    result.text +=
        fmt::format("{:<9}{:>24}{:>24}{:>22}{:>8}{:>11.1f}{:>11.1f}{:>11.0f}{:>8.0f}%\n", k.name, spread(k.ours),
                    spread(k.embree), spread(k.ratios), k.differ, k.nodes, k.triangles, bytes, 100.0 * k.utilisation);
    json["rows"].push_back({{"rays", k.name},
                            {"count", k.rays.size()},
                            {"mrays_per_s", number(k.ours)},
                            {"embree_mrays_per_s", number(k.embree)},
                            {"ratio", number(k.ratios)},
                            {"samples", k.ours},
                            {"embree_samples", k.embree},
                            {"differ", k.differ},
                            {"nodes_per_ray", k.nodes},
                            {"triangles_per_ray", k.triangles},
                            {"bytes_per_ray", bytes},
                            {"lane_utilisation", k.utilisation}});
  }
  if (!embree) result.text += "built without Embree (Debian: libembree-dev): no comparison\n";
  result.json = std::move(json);
  return result;
}

}  // namespace bench

namespace {

struct RaysCommandOptions {
  CommonOptions common;
  std::string scene;
  bench::RaysOptions bench;
};

int runRaysCommand(const RaysCommandOptions& options) {
  options.common.apply();
  watchForInterrupt();
  const Scene scene = loadScene(bench::sceneOrAtrium(options.scene));
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  const bench::RaysResult result = bench::measureRays(context, programs, scene, options.bench, options.common.quiet);
  fmt::print("{}", result.text);
  options.common.writeJson(result.json);
  return exitCode();
}

}  // namespace

Work addBenchRays(Command app) {
  auto options = std::make_shared<RaysCommandOptions>();
  app.addOption("SCENE", options->scene, "a scene file (default: the atrium)").scene();
  app.addOption("--rays", options->bench.rays, "number of rays of each kind").showDefault();
  app.addOption("--repeats", options->bench.repeats, "measurements of each kind, after one warm-up").showDefault();
  app.addOption("--camera", options->bench.camera,
                "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  app.addOption("--split-budget", options->bench.splitBudget, "references that spatial splits may add, as a fraction")
      .range(0.0, 10.0)
      .showDefault();
  app.setFooter(
      "Medians with least and most. Lanes: how much of the work of eight rays side by side is not waiting for the "
      "slowest of them, by nodes.\n"
      "Differ: rays that Embree answers otherwise, by more than 1e-4 of the distance. All of this machine's cores work "
      "for either.");
  options->common.declare(app);
  return [options] { return runRaysCommand(*options); };
}

}  // namespace lucerna::demo
