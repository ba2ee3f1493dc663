#include "bench/references.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "pathtracer/path_sampler.hpp"
#include "measure/batches.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace lucerna::demo::bench {

using measure::LightKinds;
using measure::Reference;

namespace {

constexpr LightKinds kDeltaLights{true, true, false, false};

Reference difference(const Reference& a, const Reference& b) {
  Reference result = a;
  for (std::size_t i = 0; i < a.mean.pixels.size(); ++i) {
    result.mean.pixels[i] -= b.mean.pixels[i];
    const glm::vec3 ea = a.standardError.pixels[i], eb = b.standardError.pixels[i];
    result.standardError.pixels[i] = glm::sqrt(ea * ea + eb * eb);
  }
  result.meanError = std::hypot(a.meanError, b.meanError);
  return result;
}

Image less(Image a, const Image& b) {
  for (std::size_t i = 0; i < a.pixels.size(); ++i) a.pixels[i] -= b.pixels[i];
  return a;
}

/// The references that a bench features: those of the techniques' models, and those that show how much a model leaves
/// out.
std::set<LightPaths> wantedOf(const std::vector<TechniqueModel>& models, LightKinds scene) {
  std::set<LightPaths> wanted{{Transport::all, scene},
                              {Transport::direct, scene},
                              {Transport::oneBounce, scene},
                              {Transport::direct, scene & kDeltaLights}};
  for (const TechniqueModel& m : models) {
    wanted.insert({Transport::direct, m.direct});
    if (!m.paths.lights.any()) continue;  // such a technique gives no light to judge
    wanted.insert(m.paths);
    const bool leavesOut = m.paths.lights != scene || m.paths.transport == Transport::oneBounceUnoccluded;
    if (leavesOut && m.paths.transport != Transport::direct) wanted.insert({Transport::oneBounce, m.paths.lights});
  }
  return wanted;
}

/// Shares of the time.
double weightOf(const LightPaths& paths) {
  return paths.transport == Transport::indirect || paths.transport == Transport::direct ? 1.0 : 2.0;
}

/// Half of the time for the reference that judges every row, the rest by weight.
struct Share {
  LightPaths paths;
  bool allMaterials;
  double time;
};

bool hasOwnMaterials(const ReferenceRequest& request) {
  return request.path && std::any_of(request.scene.materials.begin(), request.scene.materials.end(),
                                     [](const Material& m) { return m.bsdf != Bsdf::diffuse && m.bsdf != Bsdf::none; });
}

std::vector<Share> sharesOf(const ReferenceRequest& request) {
  const LightKinds lights = measure::kindsOf(request.scene);
  const LightPaths all{Transport::all, lights};
  const bool own = hasOwnMaterials(request);
  std::vector<Share> shares{{all, false, own ? 0.25 : 0.5}};
  if (own) shares.push_back({all, true, 0.4});
  std::set<LightPaths> others = wantedOf(request.models, lights);
  others.erase(all);
  others.erase({Transport::indirect, lights});  // computed as a difference of two others
  double weights = 0.0;
  for (const LightPaths& paths : others) weights += weightOf(paths);
  for (const LightPaths& paths : others)
    shares.push_back({paths, false, (own ? 0.35 : 0.5) * weightOf(paths) / weights});
  return shares;
}

/// The sampler of a reference, and its key.
struct ShareSampler {
  std::optional<Scene> lessLight;
  const Scene& scene;
  PathSampler sampler;
  measure::ReferenceKey key;

  ShareSampler(const ReferenceRequest& request, const Share& share)
      : lessLight(share.paths.lights == measure::kindsOf(request.scene)
                      ? std::nullopt
                      : std::optional(measure::litBy(request.scene, share.paths.lights))),
        scene(lessLight ? *lessLight : request.scene),
        sampler(request.context, request.programs, scene, request.camera, request.size, request.filter,
                share.paths.transport, share.allMaterials, share.paths.bounces),
        key(measure::keyOf(scene, request.camera, request.size, share.paths.transport, sampler.version())) {}
  ShareSampler(const ShareSampler&) = delete;
  ShareSampler& operator=(const ShareSampler&) = delete;
};

measure::ReferenceCache cacheOf(const ReferenceRequest& request) {
  return measure::ReferenceCache(request.folder.empty() ? measure::ReferenceCache::defaultFolder() : request.folder);
}

}  // namespace

ReferenceBatches sampleReferences(const ReferenceRequest& request, const PartOptions& options,
                                  const std::string& identity) {
  constexpr std::size_t kBatches = measure::SamplingGoal::kBatches;
  CHECK(request.samples > 0, "references in batches by a number of samples");
  const std::vector<Share> shares = sharesOf(request);
  const std::uint32_t size = measure::batchSize(request.samples);
  std::string keys;
  for (const Share& share : shares) keys += " " + ShareSampler(request, share).key.name();
  const PartFolder part(options, "bench references",
                        fmt::format("{}, {} batches of {} samples, references{}", identity, kBatches, size, keys),
                        shares.size() * kBatches);
  ReferenceBatches result;
  result.batches = part.last() - part.first();
  Progress progress("batches", static_cast<int>(result.batches), request.quiet);
  for (std::size_t s = 0; s < shares.size(); ++s) {
    if ((s + 1) * kBatches <= part.first() || s * kBatches >= part.last()) continue;
    ShareSampler share(request, shares[s]);
    measure::BatchMean mean;
    double seconds = 0.0;
    for (std::size_t b = 0; b < kBatches; ++b) {
      const std::size_t unit = s * kBatches + b;
      if (unit < part.first() || unit >= part.last()) continue;
      if (interrupted()) return result;
      // The picture first: the JSON marks it as complete, with its cost.
      Image batch;
      if (const auto kept = part.load(unit)) {
        batch = readImage(part.file(unit, ".pfm"));
        seconds += kept->at("seconds").get<double>();
      } else {
        const auto start = Clock::now();
        batch = share.sampler.asSampler()(b * size, size);
        const double took = secondsSince(start);
        if (part.folder()) writeImage(part.file(unit, ".pfm"), batch);
        part.store(unit, {{"seconds", took}});
        seconds += took;
        ++result.made;
      }
      if (!part.isPart()) mean.add(batch);
      progress.update(static_cast<int>(unit + 1 - part.first()));
    }
    if (part.isPart()) continue;
    const measure::ReferenceCache cache = cacheOf(request);
    Reference reference;
    reference.transport = shares[s].paths.transport;
    reference.mean = mean.mean();
    reference.standardError = mean.standardError();
    reference.meanError = mean.meanError();
    reference.samples = kBatches * size;
    reference.seconds = seconds;
    reference.renderer = request.context.capabilities().renderer;
    // Keep one with more samples.
    const std::optional<Reference> known = cache.load(share.key);
    if (!known || known->samples < reference.samples) cache.store(share.key, reference);
    result.stored.push_back(cache.fileOf(share.key));
  }
  part.finish();
  result.complete = true;
  return result;
}

bool hasReferences(const ReferenceRequest& request) {
  const measure::ReferenceCache cache = cacheOf(request);
  for (const Share& share : sharesOf(request)) {
    const std::optional<Reference> known = cache.load(ShareSampler(request, share).key);
    if (!known || known->samples < request.samples) return false;
  }
  return true;
}

Reference References::inside(const LightPaths& paths) const {
  Reference reference = of.at(paths);
  if (!showsLights(paths.transport) || paths.lights == lights) return reference;
  const Image &all = seen.at(lights), &own_ = seen.at(paths.lights);
  for (std::size_t i = 0; i < reference.mean.pixels.size(); ++i)
    reference.mean.pixels[i] += all.pixels[i] - own_.pixels[i];
  return reference;
}

Image References::blackPicture(const Reference& reference) const {
  return showsLights(reference.transport) ? seen.at(lights) : Image(reference.mean.width, reference.mean.height);
}

Image References::constantPicture(const Reference& reference) const {
  const Image black = blackPicture(reference);
  Image picture = measure::litByConstant(albedo, measure::constantIrradiance(albedo, less(reference.mean, black)));
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) picture.pixels[i] += black.pixels[i];
  return picture;
}

JudgedPicture References::judge(const Image& original, const Reference& reference, bool surfacesAlone,
                                double ownError) const {
  const Image black = blackPicture(reference);
  Image picture = original, exact = reference.mean, error = reference.standardError;
  if (surfacesAlone)
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
      if (!lit[i] && !other[i])
        picture.pixels[i] = exact.pixels[i] = black.pixels[i], error.pixels[i] = glm::vec3(0.0f);
  const auto errors = [&](const Image& p, const Image& t, const Image& e) {
    return measure::lessNoise(measure::errorsOf(p, t), measure::noiseOf(t, e, reference.meanError), ownError);
  };
  JudgedPicture judged;
  judged.pixels = errors(picture, exact, error);
  // d sqrt(x) = dx / (2 sqrt(x)).
  const measure::SquareErrors whole = measure::squareErrorsOf(picture, exact, error);
  judged.nrmseError = whole.squares / (2.0 * judged.pixels.rmse * judged.pixels.measured.referenceMean);
  judged.relmseError = whole.relative;
  picture = less(picture, black), exact = less(exact, black);
  // What an emissive surface covers there is so much brighter that the rest cannot be told from the sampling of its
  // edge.
  for (std::size_t i = 0; i < emitterEdges.size(); ++i)
    if (emitterEdges[i]) picture.pixels[i] = exact.pixels[i] = error.pixels[i] = glm::vec3(0.0f);
  const int side = measure::blockSide(exact.width);
  judged.scattered = errors(picture, exact, error);
  judged.l2Error = measure::squareErrorsOf(picture, exact, error).squares * judged.scattered.l2 /
                   (2.0 * judged.scattered.rmse * judged.scattered.rmse);
  judged.blocks = errors(measure::blockMeans(picture, side), measure::blockMeans(exact, side),
                         measure::blockStandardErrors(error, side));
  judged.lit = measure::partErrorsOf(picture, exact, error, lit, ownError);
  judged.other = measure::partErrorsOf(picture, exact, error, other, ownError);
  return judged;
}

std::optional<References> obtainReferences(const ReferenceRequest& request) {
  const measure::ReferenceCache cache = cacheOf(request);
  References result;
  result.lights = measure::kindsOf(request.scene);
  result.models = request.models;
  const LightPaths indirect{Transport::indirect, result.lights}, delta{Transport::direct, result.lights & kDeltaLights};
  const std::vector<Share> shares = sharesOf(request);

  Progress progress("references", static_cast<int>(shares.size()), request.quiet);
  int done = 0;
  for (const Share& share : shares) {
    const auto& [paths, allMaterials, time] = share;
    ShareSampler sampler(request, share);
    const measure::ReferenceKey& key = sampler.key;
    measure::SamplingGoal goal;
    goal.seconds = time * request.seconds;
    goal.samples = request.samples;
    std::optional<Reference> reference;
    if (!request.own.empty()) reference = measure::ReferenceCache(request.own).load(key);
    const bool isOwn = reference.has_value();
    if (!isOwn)
      reference = measure::obtainReference(cache, key, sampler.sampler.asSampler(), paths.transport, goal,
                                           request.context.capabilities().renderer, interrupted);
    if (!reference || interrupted()) return std::nullopt;
    if (!isOwn && !request.own.empty()) measure::ReferenceCache(request.own).store(key, *reference);
    if (!result.seen.contains(paths.lights))
      result.seen.emplace(paths.lights, seenLights(request.context, request.programs, sampler.scene, request.camera,
                                                   request.size, request.filter));
    if (allMaterials) result.own = std::move(*reference);
    else result.of.emplace(paths, std::move(*reference));
    progress.update(++done);
  }
  result.indirect_ = difference(result.all(), result.of.at({Transport::direct, result.lights}));
  result.indirect_.transport = Transport::indirect;
  if (wantedOf(request.models, result.lights).contains(indirect)) result.of.emplace(indirect, result.indirect_);

  // Surfaces, and whether sun and lamps light them. Without such lights none is lit.
  result.albedo =
      albedoPicture(request.context, request.programs, request.scene, request.camera, request.size, request.filter);
  if (result.lights.surfaces)
    result.emitterEdges =
        emitterEdges(request.context, request.programs, request.scene, request.camera, request.size, request.filter);
  const auto directly = result.of.find(delta);
  for (std::size_t i = 0; i < result.albedo.pixels.size(); ++i) {
    const auto positive = [](const glm::vec3& v) { return v.x > 0.0f || v.y > 0.0f || v.z > 0.0f; };
    const bool isSurface = positive(result.albedo.pixels[i]),
               isLit = isSurface && directly != result.of.end() && positive(directly->second.mean.pixels[i]);
    result.lit.push_back(isLit);
    result.other.push_back(isSurface && !isLit);
  }
  return result;
}

std::vector<ModelError> modelErrors(const References& r) {
  const auto judge = [&](const Reference& model, const Reference& exact) {
    const Reference d = difference(exact, model);
    return measure::lessNoise(measure::errorsOf(model.mean, exact.mean),
                              measure::noiseOf(exact.mean, d.standardError, d.meanError));
  };
  const auto addName = [](std::string& names, const std::string& name) {
    if ((", " + names + ",").find(", " + name + ",") == std::string::npos) names += (names.empty() ? "" : ", ") + name;
  };
  const auto techniques = [&](auto isOf) {
    std::string names;
    for (const TechniqueModel& m : r.models)
      if (isOf(m.paths)) addName(names, m.technique);
    return names;
  };
  const auto black = [](Reference like) {
    like.mean = like.standardError = Image(like.mean.width, like.mean.height);
    like.meanError = 0.0;
    return like;
  };
  const auto oneBounce = [&](LightKinds lights) -> const Reference& { return r.of.at({Transport::oneBounce, lights}); };
  const auto isOne = [](const LightPaths& p) {
    return p.transport == Transport::oneBounce || p.transport == Transport::oneBounceUnoccluded;
  };
  std::vector<ModelError> lines;
  std::set<LightKinds> kinds;
  for (const TechniqueModel& m : r.models) kinds.insert(m.paths.lights);

  // Visibility, for each choice of lights gathered without it.
  for (const LightKinds k : kinds) {
    const LightPaths unoccluded{Transport::oneBounceUnoccluded, k};
    if (const auto found = r.of.find(unoccluded); found != r.of.end())
      lines.push_back({fmt::format("no visibility between surfaces ({})",
                                   techniques([&](const LightPaths& p) { return p == unoccluded; })),
                       fmt::format("one bounce of {}", measure::nameOf(k)), judge(found->second, oneBounce(k))});
  }
  // Bounces, with all lights.
  if (const std::string names = techniques(isOne); !names.empty())
    lines.push_back(
        {fmt::format("one bounce only ({})", names), "indirect light", judge(oneBounce(r.lights), r.indirect())});
  // Lights that a technique lacks: in its direct light, and in its reflected light.
  std::set<LightKinds> directKinds;
  for (const TechniqueModel& m : r.models) directKinds.insert(m.direct);
  const auto noLightOf = [&](LightKinds k) { return "no light of: " + measure::nameOf(measure::without(r.lights, k)); };
  for (const LightKinds k : directKinds) {
    if (k == r.lights) continue;
    std::string names;
    for (const TechniqueModel& m : r.models)
      if (m.direct == k) addName(names, m.technique);
    lines.push_back({fmt::format("{} ({})", noLightOf(k), names), "direct light",
                     judge(r.inside({Transport::direct, k}), r.of.at({Transport::direct, r.lights}))});
  }
  for (const LightKinds k : kinds) {
    const std::string names =
        techniques([&](const LightPaths& p) { return p.lights == k && p.transport != Transport::direct; });
    if (k == r.lights || names.empty()) continue;
    lines.push_back({fmt::format("{} ({})", noLightOf(k), names), "one bounce of all lights",
                     judge(k.any() ? oneBounce(k) : black(oneBounce(r.lights)), oneBounce(r.lights))});
  }
  // Everything together.
  std::set<LightPaths> seen;
  for (const TechniqueModel& m : r.models)
    if (isOne(m.paths) && m.paths.lights.any() && seen.insert(m.paths).second)
      lines.push_back({fmt::format("all of these ({})", techniques([&](const LightPaths& p) { return p == m.paths; })),
                       "indirect light", judge(r.of.at(m.paths), r.indirect())});
  return lines;
}

}  // namespace lucerna::demo::bench
