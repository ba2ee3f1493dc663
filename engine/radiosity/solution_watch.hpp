// Lets a program follow, stop and resume the solutions that frames of the technique radiosity make.
#pragma once

#include "base/stop_watch.hpp"
#include "radiosity/solution.hpp"

#include <filesystem>
#include <functional>
#include <set>

namespace lucerna {

/// During its lifetime, a RadiosityView made on this thread calls `onStage` as solveScene does: false stops it by the
/// exception Stopped. A solution without a file of its own (radiosity.file) keeps its form factors in `folder` until it
/// is solved, named by scene and settings, so that the same command resumes from them. Only the innermost watch counts.
class SolutionWatch {
 public:
  /// Keeps: form factors of solved scenes stay for the watch's lifetime, so that the same surfaces are lit anew without
  /// hemicubes.
  enum class Rows { resume, keep };
  struct Limits {
    double secondsOfChunk = 0.25;  ///< of hemicubes between two calls of `onStage`
    double mostBytes = 8e9;  ///< of a file in `folder`: nobody asked for it, so it must not fill the disk
  };
  SolutionWatch(std::filesystem::path folder, std::function<bool(const RadiosityStage&)> onStage,
                Rows rows = Rows::resume);
  SolutionWatch(std::filesystem::path folder, std::function<bool(const RadiosityStage&)> onStage, Rows rows,
                const Limits& limits);
  ~SolutionWatch();
  SolutionWatch(const SolutionWatch&) = delete;
  SolutionWatch& operator=(const SolutionWatch&) = delete;

  /// For RadiosityView: the innermost watch's, or empty.
  static std::function<bool(const RadiosityStage&)> innermostOnStage();
  static double secondsOfChunk();
  static std::filesystem::path checkpointOf(const Scene& scene, const RadiositySolutionSettings& settings);
  /// The scene is solved: removes its form factors, at once or at the watch's end.
  static void solved(const std::filesystem::path& checkpoint);
  /// Whether these are kept from an earlier solution. Light from behind makes other patches: then they are of no use.
  static bool isKept(const std::filesystem::path& checkpoint);
  /// Bytes of a checkpoint, at most: the watch's limit, or half of what is free on the disk. Files that were asked for
  /// by name have no limit.
  static double mostBytes(const std::filesystem::path& checkpoint);

 private:
  /// Refined meshes depend on the light.
  static bool keeps(const RadiositySolutionSettings& settings);

  std::filesystem::path folder_;
  std::function<bool(const RadiosityStage&)> onStage_;
  Rows rows_;
  Limits limits_;
  std::set<std::filesystem::path> kept_;
  SolutionWatch* outer_;
  StopWatch prepares_;  ///< before the first stage that reports
};

}  // namespace lucerna
