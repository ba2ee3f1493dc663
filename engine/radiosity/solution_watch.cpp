#include "radiosity/solution_watch.hpp"

#include "base/hash.hpp"
#include "scene/fingerprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

namespace lucerna {

namespace {
thread_local SolutionWatch* innermostSolutionWatch = nullptr;
}

SolutionWatch::SolutionWatch(std::filesystem::path folder, std::function<bool(const RadiosityStage&)> onStage,
                             Rows rows)
    : SolutionWatch(std::move(folder), std::move(onStage), rows, Limits()) {}

SolutionWatch::SolutionWatch(std::filesystem::path folder, std::function<bool(const RadiosityStage&)> onStage,
                             Rows rows, const Limits& limits)
    : folder_(std::move(folder)),
      onStage_(std::move(onStage)),
      rows_(rows),
      limits_(limits),
      outer_(std::exchange(innermostSolutionWatch, this)),
      prepares_([this](const LongWork& work) {
        return !onStage_(RadiosityStage{.kind = RadiosityStage::Kind::direct, .solve = {}, .prepares = work});
      }) {}

SolutionWatch::~SolutionWatch() {
  innermostSolutionWatch = outer_;
  for (const std::filesystem::path& file : kept_) removeCheckpoints(file);
}

bool SolutionWatch::keeps(const RadiositySolutionSettings& settings) {
  return innermostSolutionWatch->rows_ == Rows::keep && settings.refinements == 0;
}

void SolutionWatch::solved(const std::filesystem::path& checkpoint) {
  if (checkpoint.empty()) return;
  if (innermostSolutionWatch && innermostSolutionWatch->rows_ == Rows::keep &&
      checkpoint.parent_path() == innermostSolutionWatch->folder_)
    innermostSolutionWatch->kept_.insert(checkpoint);
  else removeCheckpoints(checkpoint);
}

bool SolutionWatch::isKept(const std::filesystem::path& checkpoint) {
  return innermostSolutionWatch && innermostSolutionWatch->kept_.contains(checkpoint);
}

double SolutionWatch::mostBytes(const std::filesystem::path& checkpoint) {
  const bool isOwn = innermostSolutionWatch && checkpoint.parent_path() == innermostSolutionWatch->folder_;
  if (!isOwn) return std::numeric_limits<double>::infinity();
  std::error_code error;
  const double free = static_cast<double>(std::filesystem::space(innermostSolutionWatch->folder_, error).available);
  return error ? innermostSolutionWatch->limits_.mostBytes
               : std::min(innermostSolutionWatch->limits_.mostBytes, 0.5 * free);
}

double SolutionWatch::secondsOfChunk() {
  return innermostSolutionWatch ? innermostSolutionWatch->limits_.secondsOfChunk : Limits().secondsOfChunk;
}

std::function<bool(const RadiosityStage&)> SolutionWatch::innermostOnStage() {
  return innermostSolutionWatch ? innermostSolutionWatch->onStage_ : nullptr;
}

std::filesystem::path SolutionWatch::checkpointOf(const Scene& scene, const RadiositySolutionSettings& settings) {
  if (!innermostSolutionWatch || innermostSolutionWatch->folder_.empty()) return {};
  Hash hash;
  hash.add(std::uint32_t{2});  // version of how patches are made: 2 ends them at contacts
  if (keeps(settings)) addSurfaces(hash, scene);
  else addScene(hash, scene);
  hash.add(std::string_view(textOf(settings)));
  hash.add(static_cast<std::uint64_t>(settings.hemicubes.visibility));
  return innermostSolutionWatch->folder_ / fmt::format("radiosity_{:016x}.rows", hash.value());
}

}  // namespace lucerna
