// The folder of a job that many machines work on (no GL). All that they share is that folder, on storage where creating
// a file that must not exist yet is atomic and a rename is seen whole (a local disk; NFS from version 3 on; Lustre,
// GPFS).
//
//   job.json        what is made: the command, how many tasks; never changed. Task K of N is it with --part K/N
//   claims/TASK.N   who works on a task: creating the file is the claim, its time of change is the sign of life.
//                   N: how often it was taken up. A claim without a sign of life for `deadAfter` seconds is nobody's:
//                   whoever creates TASK.(N+1) first takes the task up
//   parts/TASK      the task's checkpoint, a folder (parts.hpp) or, of samples, a film TASK.film: who takes a task up
//                   goes on from it
//   whole           all parts as one checkpoint, made by the join; of samples whole.film
//   done/TASK.json  its result, written last, at once
//   logs/TASK.log   what the program said
//   array.sbatch, join.sbatch, submit: the same for Slurm
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo {

struct ClusterTask {
  std::string name;
  std::uint32_t number = 0;
};

/// The work to divide into tasks.
struct ClusterCommand {
  /// Arguments after `lucerna`, without --part, --checkpoint, --json, --quiet, and for a picture -o.
  std::vector<std::string> words;
  std::string output;  ///< of a path traced picture; empty: a command that computes its result itself from all parts
  std::string json;  ///< --json of the whole; empty: none

  bool isPicture() const { return !output.empty(); }
};

class ClusterJob {
 public:
  enum class State { waiting, running, abandoned, done };

  /// Throws Error(badInput) if the folder holds no job.
  explicit ClusterJob(std::filesystem::path folder);
  /// Throws Error(badInput) if the folder already holds a job.
  static void plan(const std::filesystem::path& folder, const ClusterCommand& command, std::uint32_t tasks);

  const std::filesystem::path& folder() const { return folder_; }
  const std::vector<ClusterTask>& tasks() const { return tasks_; }
  const ClusterCommand& command() const { return command_; }
  /// The folder where the command was planned; relative paths refer to it.
  const std::string& directory() const { return directory_; }

  std::filesystem::path part(const ClusterTask& task) const {
    return folder_ / "parts" / (task.name + (command_.isPicture() ? ".film" : ""));
  }
  std::filesystem::path result(const ClusterTask& task) const { return folder_ / "done" / (task.name + ".json"); }
  std::filesystem::path log(const ClusterTask& task) const { return folder_ / "logs" / (task.name + ".log"); }
  State state(const ClusterTask& task, double deadAfter) const;

  /// The claim file, if the task is available: waiting or abandoned. Empty if it is done, in progress, or another
  /// worker was faster.
  std::optional<std::filesystem::path> claim(const ClusterTask& task, double deadAfter) const;
  /// Gives a sign of life; false if another worker has taken over the task, assuming this one dead.
  bool keep(const std::filesystem::path& claim) const;
  /// Gives the task back, so that it can be taken up at once.
  void giveBack(const std::filesystem::path& claim) const;

 private:
  int claimsOf(const ClusterTask& task) const;  ///< number of times it was taken up
  /// Seconds since a file's last change, by the storage's clock: those of machines may differ.
  double age(const std::filesystem::path& file) const;

  std::filesystem::path folder_;
  std::vector<ClusterTask> tasks_;
  ClusterCommand command_;
  std::string directory_;
};

}  // namespace lucerna::demo
