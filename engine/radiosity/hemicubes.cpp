#include "radiosity/hemicubes.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/stop_watch.hpp"
#include "gl/pass.hpp"
#include "radiosity/hemicube_methods.hpp"
#include "rays/ray_scene.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>

namespace lucerna {

namespace {

constexpr double kIterationsOfPatch = 8.0;  // by raster: a patch's setup
constexpr double kIterationsOfPixel = 32.0;  // by raster: a pixel's layers
constexpr int kMeasured = 32;  // hemicubes in a batch for measuring the cost
constexpr int kCompared = 8;  // hemicubes whose sights are compared

/// Approximate loop iterations of a hemicube (gl/chunks.hpp), by method.
struct Iterations {
  double rays, raster;
};
Iterations iterationsOfHemicube(const RadiosityMesh& mesh, int resolution) {
  const double pixels = 3.0 * resolution * resolution, patches = static_cast<double>(mesh.patches.size());
  return {gl::kIterationsOfRay * pixels, kIterationsOfPatch * patches + kIterationsOfPixel * pixels};
}

double mostIterationsOfHemicube(const RadiosityMesh& mesh, int resolution) {
  const Iterations iterations = iterationsOfHemicube(mesh, resolution);
  return std::max(iterations.rays, iterations.raster);
}

/// The cheapest method, with a line in the log.
HemicubeVisibility cheapestOf(const std::vector<Hemicubes::Cost>& costs) {
  const auto best = std::min_element(costs.begin(), costs.end(),
                                     [](const auto& a, const auto& b) { return a.milliseconds < b.milliseconds; });
  std::string measured;
  for (const Hemicubes::Cost& cost : costs)
    measured += fmt::format("{}{} {:.3g} ms", measured.empty() ? "" : ", ", nameOf(cost.visibility), cost.milliseconds);
  logInfo("radiosity: hemicubes by {} (a hemicube: {}{})", nameOf(best->visibility), measured,
          costs.size() == 1 ? "; too few to measure the other methods" : "");
  return best->visibility;
}

}  // namespace

HemicubeVisibility visibilityByCount(const RadiosityMesh& mesh, int resolution) {
  const Iterations iterations = iterationsOfHemicube(mesh, resolution);
  return iterations.raster <= iterations.rays ? HemicubeVisibility::raster : HemicubeVisibility::rays;
}

// ---------------------------------------------------------------------------------------------------- set-up

Hemicubes::Hemicubes(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, const RadiosityMesh& mesh,
                     const HemicubeSettings& settings, const RayScene* rays)
    : settings_(settings),
      rays_(rays),
      chunks_(settings.secondsOfChunk, mostIterationsOfHemicube(mesh, settings.resolution),
              HemicubeBatch::kMostHemicubes, settings.unmeasuredIterations) {
  CHECK(settings.resolution >= 2 && settings.resolution % 2 == 0, "hemicubes of {} pixels", settings.resolution);
  if (settings_.visibility == HemicubeVisibility::automatic) {
    costs_ = measure(programs, capabilities, mesh, settings, rays);
    settings_.visibility = cheapestOf(costs_);
  }
  batch_ = std::make_unique<HemicubeBatch>(capabilities, mesh, settings_);
  // A ray looks for the small sources that no pixel hit.
  const bool asksForSources = batch_->smallSourceCount() > 0 && settings_.exactPixels > 0;
  if (!rays_ && (asksForSources || settings_.visibility == HemicubeVisibility::rays)) {
    ownRays_ = std::make_unique<RayScene>(sceneOf(mesh), capabilities);
    rays_ = ownRays_.get();
  }
  method_ = makeHemicubeMethod(settings_.visibility, programs, *batch_, rays_);
  const bool items = listsPatches(settings_.visibility), drawn = settings_.visibility == HemicubeVisibility::itemBuffer;
  sum_ = &programs.loadCompute("hemicube sum", "radiosity/hemicube_sum.comp",
                               {{"LARGE", 0}, {"ITEMS", items}, {"DRAWN", drawn}});
  sumLarge_ = &programs.loadCompute("hemicube sum large", "radiosity/hemicube_sum.comp",
                                    {{"LARGE", 1}, {"ITEMS", items}, {"DRAWN", drawn}});
  exact_ = &programs.loadCompute("hemicube exact", "radiosity/hemicube_exact.comp",
                                 {{"ITEMS", items},
                                  {"SOURCES", asksForSources},
                                  {"ALPHA_MASKS", 0},
                                  {"SHARED_STACK", asksForSources ? rays_->sharedStack() : 0}});
}

Hemicubes::~Hemicubes() = default;

int Hemicubes::batchSize() const { return batch_->capacity(); }
int Hemicubes::patchCount() const { return batch_->patchCount(); }
const std::vector<std::uint32_t>& Hemicubes::smallSources() const { return batch_->smallSources(); }

std::size_t Hemicubes::gpuBytes() const {
  return batch_->gpuBytes() + method_->gpuBytes() + staging_.bytes() + (ownRays_ ? ownRays_->gpuBytes() : 0);
}

// ---------------------------------------------------------------------------------------------------- choice

/// The first of three runs warms up; then the better of two positions.
double Hemicubes::millisecondsEach() {
  const int count = std::min(chunkSize(), kMeasured);
  double best = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int first = static_cast<int>(static_cast<std::int64_t>(patchCount() - count) * k / 2);
    StopWatch::check("measuring hemicubes", static_cast<std::size_t>(k), 3);
    const auto start = Clock::now();
    draw(first, count, 0);
    const double took = std::chrono::duration<double, std::milli>(Clock::now() - start).count() / count;
    if (k == 1 || (k == 2 && took < best)) best = took;
  }
  return best;
}

/// The share of a patch's hemisphere that is not background.
double Hemicubes::seenBy(int patch) {
  const FormFactorRows row = rowsOf(draw(patch, 1, 0));
  return static_cast<double>(row.fronts[0]) + static_cast<double>(row.backs[0]);
}

// A driver's rasteriser may lose triangles, as NVIDIA's did (docs/drivers.md): the item buffer must see what raster
// sees, but for some pixels along silhouettes.
bool Hemicubes::seesAsRaster(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                             const RadiosityMesh& mesh, HemicubeSettings settings, const RayScene* rays,
                             Hemicubes& drawn) {
  settings.visibility = HemicubeVisibility::raster;
  Hemicubes raster(programs, capabilities, mesh, settings, rays);
  const double allowed = 0.01 + 4.0 / (3.0 * settings.resolution * settings.resolution);
  for (int k = 0; k < kCompared; ++k) {
    StopWatch::check("comparing hemicubes", static_cast<std::size_t>(k), kCompared);
    const int patch = static_cast<int>(static_cast<std::int64_t>(drawn.patchCount() - 1) * k / (kCompared - 1));
    if (std::abs(drawn.seenBy(patch) - raster.seenBy(patch)) > allowed) return false;
  }
  return true;
}

std::vector<Hemicubes::Cost> Hemicubes::measure(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                                const RadiosityMesh& mesh, HemicubeSettings settings,
                                                const RayScene* rays) {
  const auto patches = static_cast<int>(mesh.patches.size());
  std::vector<Cost> costs;
  // Raster first: if all the work takes it less time than compiling and measuring the others would, they are skipped.
  for (const HemicubeVisibility one :
       {HemicubeVisibility::raster, HemicubeVisibility::rays, HemicubeVisibility::itemBuffer}) {
    if (!costs.empty() && costs[0].milliseconds * patches < 1000.0 * settings.worthMeasuring) break;
    settings.visibility = one;
    Hemicubes hemicubes(programs, capabilities, mesh, settings, rays);
    const Cost cost{one, hemicubes.millisecondsEach()};
    if (one == HemicubeVisibility::itemBuffer &&
        !seesAsRaster(programs, capabilities, mesh, settings, rays, hemicubes)) {
      logWarning("radiosity: on this driver the item buffer loses what rays and raster see, so it is not used");
      continue;
    }
    costs.push_back(cost);
  }
  return costs;
}

// ---------------------------------------------------------------------------------------------------- rows

DrawnHemicubes Hemicubes::draw(int first, int count, int roll) {
  const auto start = Clock::now();
  const HemicubeRange range{first, count};
  batch_->start(range, roll);
  method_->findVisible(range);
  // Sums of pixels, of large patches row by row, and closed forms in place of the sums of near pairs.
  constexpr gl::Barrier kStorage = gl::Barrier::storage;
  {
    const gl::ComputePass pass(sum_->name(), kStorage | gl::Barrier::command);
    batch_->use(*sum_, range);
    method_->dispatchOverPatches(pass, range);
  }
  {
    const gl::ComputePass pass(sumLarge_->name(), kStorage);
    batch_->use(*sumLarge_, range);
    pass.dispatchIndirect(batch_->largeList());
  }
  {
    const gl::ComputePass pass(exact_->name(), kStorage);
    batch_->use(*exact_, range);
    if (rays_) {
      rays_->bind();
      exact_->set("raysOrigin", glm::vec3(rays_->origin()));
    }
    pass.dispatch(glm::ivec3(batch_->groupsOfExact(), 1, 1), glm::ivec3(1));
  }
  DrawnHemicubes drawn;
  drawn.first = first;
  drawn.count = count;
  drawn.patchCount = patchCount();
  method_->readFactors(staging_, drawn);
  drawn.exact = staging_.read<glm::uvec2>(batch_->exactList(), 1 + staging_.readFirst<GLuint>(batch_->exactList()));
  drawn.exact.erase(drawn.exact.begin());  // the list's length
  gl::throwIfReset();
  gl::throwIfError("hemicubes");
  chunks_.took(static_cast<std::uint32_t>(count), secondsSince(start));
  return drawn;
}

std::vector<std::uint32_t> Hemicubes::seenByPixels(int patch) {
  CHECK(listsPatches(visibility()), "pixels by {}", nameOf(visibility()));
  draw(patch, 1, 0);
  const auto pixels = static_cast<std::size_t>(3 * settings_.resolution * settings_.resolution);
  return staging_.read<std::uint32_t>(batch_->pixels().buffer(), pixels);
}

glm::dmat3 Hemicubes::axesOf(int patch) const { return batch_->axesOf(patch, 0); }

std::vector<DrawnHemicubes> Hemicubes::drawRolls(int first, int count) {
  std::vector<DrawnHemicubes> drawn;
  for (int roll = 0; roll < rollsOf(settings_); ++roll) drawn.push_back(draw(first, count, roll));
  return drawn;
}

int Hemicubes::chunkSize() const { return std::min(batchSize(), static_cast<int>(chunks_.units())); }

FormFactorRows Hemicubes::rows(int first, int count) {
  CHECK(count > 0 && count <= batchSize(), "{} hemicubes, at most {}", count, batchSize());
  FormFactorRows all;
  all.first = first;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (const int end = first + count; first < end;) {
    const FormFactorRows chunk = meanRowsOf(drawRolls(first, std::min(end - first, chunkSize())));
    append(all.counts, chunk.counts), append(all.fronts, chunk.fronts), append(all.backs, chunk.backs);
    append(all.patches, chunk.patches), append(all.factors, chunk.factors);
    first += static_cast<int>(chunk.counts.size());
  }
  return all;
}

void Hemicubes::stream(int first, int end, const std::function<void(const FormFactorRows&)>& take,
                       const std::function<bool(int done)>& goOn) {
  std::future<void> taken;
  for (bool stopped = false; first < end && !stopped;) {
    std::vector<DrawnHemicubes> drawn = drawRolls(first, std::min(end - first, chunkSize()));
    first += drawn.front().count;
    if (taken.valid()) taken.get();
    taken = std::async(std::launch::async,
                       [&take, chunk = std::move(drawn)]() mutable { take(meanRowsOf(std::move(chunk))); });
    stopped = goOn && !goOn(first);
  }
  if (taken.valid()) taken.get();
}

}  // namespace lucerna
