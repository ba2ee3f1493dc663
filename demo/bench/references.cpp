#include "bench/references.hpp"

#include "base/error.hpp"
#include "bench/path_sampler.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo::bench {

using measure::Reference;
using measure::Transport;

namespace {

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

}  // namespace

std::optional<References> obtainReferences(const ReferenceRequest& request) {
  const measure::ReferenceCache cache(request.folder.empty() ? measure::ReferenceCache::defaultFolder() : request.folder);
  const bool own = request.path && std::any_of(request.scene.materials.begin(), request.scene.materials.end(),
                                               [](const Material& m) { return m.bsdf != Bsdf::diffuse && m.bsdf != Bsdf::none; });
  // Shares of the time: all light is the noisiest and judges every row.
  struct Share {
    Transport transport;
    bool allMaterials;
    double time;
  };
  std::vector<Share> shares{{Transport::all, false, 0.5}, {Transport::direct, false, 0.1}, {Transport::oneBounce, false, 0.2}, {Transport::oneBounceUnoccluded, false, 0.2}};
  if (own) shares = {{Transport::all, false, 0.25}, {Transport::direct, false, 0.1}, {Transport::oneBounce, false, 0.1}, {Transport::oneBounceUnoccluded, false, 0.1}, {Transport::all, true, 0.45}};
  References result;
  Progress progress("references", static_cast<int>(shares.size()), request.quiet);
  int done = 0;
  for (const auto& [transport, allMaterials, share] : shares) {
    PathSampler sampler(request.context, request.programs, request.scene, request.camera, request.size, transport, allMaterials);
    const measure::ReferenceKey key = measure::keyOf(request.scene, request.camera, request.size, transport, allMaterials ? PathSampler::kVersionOfAllMaterials : PathSampler::kVersion);
    measure::SamplingGoal goal;
    goal.seconds = share * request.seconds;
    goal.samples = request.samples;
    std::optional<Reference> reference;
    if (!request.own.empty()) reference = measure::ReferenceCache(request.own).load(key);
    const bool isOwn = reference.has_value();
    if (!isOwn) reference = measure::obtainReference(cache, key, sampler.asSampler(), transport, goal, request.context.capabilities().renderer, interrupted);
    if (!reference || interrupted()) return std::nullopt;
    if (!isOwn && !request.own.empty()) measure::ReferenceCache(request.own).store(key, *reference);
    if (allMaterials)
      result.own = std::move(*reference);
    else
      result.of.emplace(transport, std::move(*reference));
    progress.update(++done);
  }
  result.indirect_ = difference(result.all(), result.of.at(Transport::direct));
  return result;
}

std::vector<ModelError> modelErrors(const References& r) {
  const auto judge = [&](const Reference& model, const Reference& truth) {
    const Reference d = difference(truth, model);
    return measure::lessNoise(measure::errorsOf(model.mean, truth.mean), measure::noiseOf(truth.mean, d.standardError, d.meanError));
  };
  const Reference &one = r.of.at(Transport::oneBounce), &unoccluded = r.of.at(Transport::oneBounceUnoccluded);
  return {{"no visibility between surfaces (RSM)", judge(unoccluded, one)},
          {"one bounce only (RSM, LPV)", judge(one, r.indirect())},
          {"both (RSM)", judge(unoccluded, r.indirect())}};
}

}  // namespace lucerna::demo::bench
