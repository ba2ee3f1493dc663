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

/// What is cut into tasks.
struct ClusterCommand {
  /// After `lucerna`, without --part, --checkpoint, --json, --quiet, and of a picture -o.
  std::vector<std::string> words;
  std::string output;  ///< of a path traced picture; empty: a command that writes its result itself, from all parts
  std::string json;  ///< --json of the whole; empty: none

  bool isPicture() const { return !output.empty(); }
};

class ClusterJob {
 public:
  enum class State { waiting, running, abandoned, done };

  /// Throws Error(badInput) where the folder holds no job.
  explicit ClusterJob(std::filesystem::path folder);
  /// Throws Error(badInput) where the folder holds a job.
  static void plan(const std::filesystem::path& folder, const ClusterCommand& command, std::uint32_t tasks);

  const std::filesystem::path& folder() const { return folder_; }
  const std::vector<ClusterTask>& tasks() const { return tasks_; }
  const ClusterCommand& command() const { return command_; }
  /// Where the command was planned: its relative paths are from there.
  const std::string& directory() const { return directory_; }

  std::filesystem::path part(const ClusterTask& task) const {
    return folder_ / "parts" / (task.name + (command_.isPicture() ? ".film" : ""));
  }
  std::filesystem::path result(const ClusterTask& task) const { return folder_ / "done" / (task.name + ".json"); }
  std::filesystem::path log(const ClusterTask& task) const { return folder_ / "logs" / (task.name + ".log"); }
  State state(const ClusterTask& task, double deadAfter) const;

  /// The claim, if the task is to be had: it waits, or was abandoned. Empty where it is done, somebody works on it, or
  /// another one was faster.
  std::optional<std::filesystem::path> claim(const ClusterTask& task, double deadAfter) const;
  /// A sign of life; false where the task was taken up by another one, who took this one for dead.
  bool keep(const std::filesystem::path& claim) const;
  /// Gives the task back, so that it is taken up at once.
  void giveBack(const std::filesystem::path& claim) const;

 private:
  int claimsOf(const ClusterTask& task) const;  ///< how often it was taken up
  /// Seconds since a file's last change, by the storage's own clock: those of machines may differ.
  double age(const std::filesystem::path& file) const;

  std::filesystem::path folder_;
  std::vector<ClusterTask> tasks_;
  ClusterCommand command_;
  std::string directory_;
};

}  // namespace lucerna::demo
