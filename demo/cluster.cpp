#include "cluster.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"
#include "shared/commands.hpp"
#include "merge.hpp"
#include "shared/parts.hpp"
#include "pathtracer/film.hpp"
#include "shared/shell.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;

struct ClusterOptions {
  CommonOptions common;
  std::string folder, time = "1-00:00:00", account, gpus;
  std::vector<std::string> command, devices;
  std::uint32_t tasks = 40;
  int jobs = 1;
};

// ---------------------------------------------------------------------------------------------------- the folder

struct Job {
  fs::path folder;
  std::string directory;  ///< where the command was planned: its relative paths refer to it
  std::vector<std::string> command;  ///< after `lucerna`, without --json, --quiet and a picture's -o
  std::string output;  ///< of a path traced picture; empty: the command writes its result itself
  std::string json;  ///< --json of the whole; empty: none
  std::uint32_t tasks = 0;

  bool isPicture() const { return !output.empty(); }
  fs::path part(std::uint32_t task) const {
    return folder / "parts" / (std::to_string(task) + (isPicture() ? ".film" : ""));
  }
  bool isDone(std::uint32_t task) const {
    return isPicture() ? fs::exists(part(task).replace_extension(".json")) : isFinishedPart(part(task));
  }
  std::vector<std::uint32_t> left() const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t task = 0; task < tasks; ++task)
      if (!isDone(task)) result.push_back(task);
    return result;
  }
};

Job readJob(const fs::path& folder) {
  const fs::path file = fs::absolute(folder) / "job.json";
  if (!fs::exists(file)) throwBadInput("{}: holds no job (lucerna cluster plan creates one)", folder.string());
  const auto json = parseJson<nlohmann::ordered_json>(readFileText(file), file.string());
  try {
    if (json.at("lucerna_cluster_job") != 3) throwBadInput("{}: a job of a different version", file.string());
    return {file.parent_path(), json.at("directory"), json.at("command"),
            json.at("output"),  json.at("json"),      json.at("tasks")};
  } catch (const nlohmann::json::exception& error) {
    throwBadInput("{}: not a job of lucerna cluster plan ({})", file.string(), error.what());
  }
}

/// Numbers as Slurm writes them: "0,3-5".
std::string rangesOf(const std::vector<std::uint32_t>& tasks) {
  std::string text;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const std::size_t first = i;
    while (i + 1 < tasks.size() && tasks[i + 1] == tasks[i] + 1) ++i;
    text += (text.empty() ? "" : ",") + std::to_string(tasks[first]);
    if (i > first) text += "-" + std::to_string(tasks[i]);
  }
  return text;
}

/// The exit code of a job with these tasks left, which are named.
int exitCodeOf(const Job& job, const std::vector<std::uint32_t>& left) {
  if (left.empty()) return 0;
  fmt::print(stderr,
             "lucerna: {0}: {1} of {2} tasks are not done: {3}. Their messages are in {0}/logs. {0}/submit or lucerna "
             "cluster run goes on with them\n",
             job.folder.string(), left.size(), job.tasks, rangesOf(left));
  return 1;
}

/// Replaces this process by this program with other arguments.
[[noreturn]] void become(const std::vector<std::string>& words, const std::string& directory) {
  std::string name = "lucerna";
  std::vector<char*> arguments{name.data()};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  std::fflush(stdout);
  // The file that this process runs, even if another build has replaced it meanwhile.
  if (::chdir(directory.c_str()) == 0) ::execv("/proc/self/exe", arguments.data());
  throwMissingCapability("cluster: cannot start lucerna in {} ({})", directory, std::strerror(errno));
}

// ---------------------------------------------------------------------------------------------------- plan

/// Commands that --part divides, and their units.
constexpr std::pair<const char*, const char*> kCuts[]{{"render", "samples"},
                                                      {"walk", "frames"},
                                                      {"bench references", "batches"},
                                                      {"bench error", "rows"},
                                                      {"bench stability", "rows"},
                                                      {"bench tables", "rows"},
                                                      {"radiosity solve", "rows of hemicubes"}};

std::string listOfCuts() {
  std::vector<std::string> list;
  for (const auto& [command, units] : kCuts) list.push_back(fmt::format("{} ({})", command, units));
  return fmt::format("{}", fmt::join(list, ", "));
}

/// Takes an option, "--key value" or "--key=value", out of the words; returns its value.
std::optional<std::string> take(std::vector<std::string>& words, const std::string& key) {
  for (auto word = words.begin(); word != words.end(); ++word) {
    if (word->starts_with(key + "=")) {
      const std::string value = word->substr(key.size() + 1);
      words.erase(word);
      return value;
    }
    if (*word != key) continue;
    if (word + 1 == words.end()) throwBadInput("cluster plan: {} has no value", key);
    const std::string value = word[1];
    words.erase(word, word + 2);
    return value;
  }
  return std::nullopt;
}

/// The job that the command after -- describes. Everything that would make each task fail is refused here.
Job jobOf(const ClusterOptions& options) {
  Job job;
  job.folder = fs::absolute(options.folder);
  job.directory = fs::current_path().string();
  job.tasks = options.tasks;
  job.command = options.command;
  std::vector<std::string>& words = job.command;
  if (!words.empty() && fs::path(words[0]).filename() == "lucerna") words.erase(words.begin());
  const std::string line = fmt::format("{} ", fmt::join(words, " "));
  if (std::none_of(std::begin(kCuts), std::end(kCuts),
                   [&](const auto& cut) { return line.starts_with(std::string(cut.first) + " "); }))
    throwBadInput("cluster plan: the command after -- must be one that can be divided into parts: {}", listOfCuts());
  const auto refuse = [&](const char* key, const char* reason) {
    if (take(words, key)) throwBadInput("cluster plan: {}: {}", key, reason);
  };
  for (const char* key : {"--part", "--checkpoint"}) refuse(key, "each task has its own");
  // Results lie where they would without a job, wherever it is joined.
  if (const auto json = take(words, "--json")) job.json = fs::absolute(*json).string();
  std::erase(words, "--quiet");
  if (words[0] != "render") return job;

  for (const char* key : {"--samples", "--seconds", "--error"}) refuse(key, "tasks share the samples of --spp");
  std::vector<std::string> rest = words;
  if (take(rest, "--technique").value_or("") != "path")
    throwBadInput("cluster plan: only pictures with --technique path can be divided, into parts of their samples");
  const std::string samples = take(rest, "--spp").value_or("");
  if (samples.empty() || samples.size() > 9 || samples.find_first_not_of("0123456789") != std::string::npos)
    throwBadInput("cluster plan: --spp '{}': expected the number of samples that the tasks share, up to 999999999",
                  samples);
  if (job.tasks > std::stoul(samples))
    throwBadInput("--tasks {}: expected 1 to {}, the samples of a pixel", job.tasks, samples);
  auto output = take(words, "-o");
  if (const auto longer = take(words, "--output")) output = longer;
  if (!output || !isWritableImageName(*output))
    throwBadInput("cluster plan: -o {}: the extension must be png, hdr, exr or pfm", output.value_or(""));
  job.output = fs::absolute(*output).string();
  return job;
}

void writeScript(const fs::path& file, const std::string& text) {
  writeFileAtomically(file, text);
  fs::permissions(file, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec, fs::perm_options::add);
}

/// An array with one task each, and the join after it. Slurm starts a task again after a preemption or the failure of
/// its node, and the task goes on from its checkpoint. The join comes after the array however that ended: after a
/// failed task it says which are left, where a join that waits for success would stay in the queue for ever.
void writeSlurm(const Job& job, const ClusterOptions& options) {
  const std::string program = bench::shellWord(fs::read_symlink("/proc/self/exe").string()),
                    folder = bench::shellWord(job.folder.string());
  // `submit` starts them in the job's folder, so that logs are named relative to it.
  std::string head =
      fmt::format("#!/bin/bash\n#SBATCH --ntasks=1\n#SBATCH --time={}\n#SBATCH --requeue\n#SBATCH --open-mode=append\n",
                  options.time);
  if (!options.account.empty()) head += fmt::format("#SBATCH --account={}\n", options.account);
  if (!options.gpus.empty()) head += fmt::format("#SBATCH --gpus-per-task={}\n", options.gpus);
  // Slurm's numbers and UUIDs are not EGL devices: the host finds the device they mean (host/egl_device.hpp).
  const std::string device =
      "# Of a node's devices the first that Slurm gave to this task; NoDevFiles: it gave none.\n"
      "given=\"${CUDA_VISIBLE_DEVICES:+cuda:$CUDA_VISIBLE_DEVICES}\"\n"
      "given=\"${given:-${ROCR_VISIBLE_DEVICES:+rocm:$ROCR_VISIBLE_DEVICES}}\"\n"
      "case \"$given\" in ''|*:NoDevFiles) ;; *) export LUCERNA_EGL_DEVICE=\"${given%%,*}\" ;; esac\n";
  const std::string part = folder + "/parts/\"$SLURM_ARRAY_TASK_ID\"";
  writeScript(job.folder / "array.sbatch",
              head +
                  fmt::format("#SBATCH --job-name=lucerna\n#SBATCH --array=0-{}\n#SBATCH --signal=B:TERM@60\n"
                              "#SBATCH --output=logs/%a.log\n",
                              job.tasks - 1) +
                  device +
                  fmt::format("cd {} && exec {} {} --quiet \\\n  --part \"$SLURM_ARRAY_TASK_ID\"/{} --checkpoint {}\n",
                              bench::shellWord(job.directory), program, bench::shellCommand(job.command), job.tasks,
                              job.isPicture() ? fmt::format("{0}.film --json {0}.json", part) : part));
  writeScript(job.folder / "join.sbatch", head + "#SBATCH --job-name=lucerna-join\n#SBATCH --output=logs/join.log\n" +
                                              device + fmt::format("exec {} cluster join {}\n", program, folder));
  writeScript(job.folder / "submit",
              fmt::format("#!/bin/sh\n"
                          "# Hands the array and the join to Slurm and prints their numbers. Once more after failures: "
                          "tasks go on from\n# their checkpoints, and those that are done end at once.\n"
                          "set -e\n"
                          "cd {}\n"
                          "array=$(sbatch --parsable array.sbatch)\n"
                          "join=$(sbatch --parsable --dependency=afterany:\"$array\" join.sbatch)\n"
                          "echo \"$array $join\"\n",
                          folder));
}

int plan(const ClusterOptions& options) {
  options.common.apply();
  const Job job = jobOf(options);
  if (fs::exists(job.folder / "job.json"))
    throwBadInput("-o {0}: holds a job; choose another folder, or go on with lucerna cluster run {0}", options.folder);
  std::error_code error;
  for (const char* name : {"parts", "logs"}) {
    fs::create_directories(job.folder / name, error);
    if (error) throwBadInput("-o {}: cannot create folder ({})", options.folder, error.message());
  }
  writeSlurm(job, options);
  const nlohmann::ordered_json json{{"lucerna_cluster_job", 3}, {"command", job.command},     {"output", job.output},
                                    {"json", job.json},         {"directory", job.directory}, {"tasks", job.tasks}};
  writeFileAtomically(job.folder / "job.json", json.dump(1) + "\n");
  if (!options.common.quiet)
    fmt::print(
        "{0}: {1} tasks. With Slurm: {0}/submit. On this machine: lucerna cluster run {0} --jobs N, then lucerna "
        "cluster join {0}\n",
        options.folder, job.tasks);
  options.common.writeJson({{"job", options.folder}, {"tasks", job.tasks}});
  return 0;
}

// ---------------------------------------------------------------------------------------------------- run

/// Held until this process and all its tasks have ended, even if it is killed before them: they inherit it.
void lock(const Job& job) {
  const fs::path file = job.folder / "lock";
  const int descriptor = ::open(file.c_str(), O_CREAT | O_RDWR, 0666);
  if (descriptor < 0) throwBadInput("{}: cannot be opened ({})", file.string(), std::strerror(errno));
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return;
  if (errno != EWOULDBLOCK) throwMissingCapability("{}: cannot be locked ({})", file.string(), std::strerror(errno));
  throwBadInput("{}: another cluster run works on it, here or on another machine; it must end first",
                job.folder.string());
}

/// Starts a task as a child, which is told to stop when this process ends. `device`: its LUCERNA_EGL_DEVICE; empty:
/// that of this process.
pid_t start(const Job& job, std::uint32_t task, const std::string& device) {
  std::vector<std::string> words = job.command;
  words.insert(words.end(),
               {"--quiet", "--part", fmt::format("{}/{}", task, job.tasks), "--checkpoint", job.part(task).string()});
  if (job.isPicture()) words.insert(words.end(), {"--json", job.part(task).replace_extension(".json").string()});
  std::fflush(stdout);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) throwMissingCapability("cluster: cannot create process ({})", std::strerror(errno));
  if (child > 0) return child;
  // A signal from before this point was caught by the handler of this process.
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (interrupted() || ::getppid() != parent) ::_exit(143);
  if (!device.empty()) ::setenv("LUCERNA_EGL_DEVICE", device.c_str(), 1);
  const fs::path log = job.folder / "logs" / fmt::format("{}.log", task);
  const int out = ::open(log.c_str(), O_CREAT | O_APPEND | O_WRONLY | O_CLOEXEC, 0666);
  ::dup2(out, 1), ::dup2(out, 2);
  become(words, job.directory);
}

int runCluster(const ClusterOptions& options) {
  options.common.apply();
  const Job job = readJob(options.folder);
  lock(job);
  watchForInterrupt();
  const std::vector<std::uint32_t> tasks = job.left();
  struct Worker {
    pid_t process = 0;
    std::uint32_t task = 0;
    bool isStopRequested = false;
  };
  std::vector<Worker> workers(static_cast<std::size_t>(options.jobs));
  std::size_t next = 0;
  for (bool busy = true; busy;) {
    busy = false;
    for (std::size_t i = 0; i < workers.size(); ++i) {
      Worker& worker = workers[i];
      if (int status = 0; worker.process != 0 && ::waitpid(worker.process, &status, WNOHANG) != 0) {
        if (!options.common.quiet)
          fmt::print("task {}: {}\n", worker.task,
                     job.isDone(worker.task) ? "done"
                     : WIFSIGNALED(status)   ? fmt::format("ended by signal {}", WTERMSIG(status))
                                             : fmt::format("exit code {}", WEXITSTATUS(status)));
        worker.process = 0;
      }
      if (worker.process == 0 && next < tasks.size() && !interrupted()) {
        const std::string device = options.devices.empty() ? "" : options.devices[i % options.devices.size()];
        worker = {start(job, tasks[next], device), tasks[next], false};
        ++next;
      }
      // Once: a second signal would end it without keeping its work.
      if (worker.process != 0 && interrupted() && !worker.isStopRequested)
        worker.isStopRequested = ::kill(worker.process, SIGTERM) == 0;
      busy = busy || worker.process != 0;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (interrupted()) throw Stopped(fmt::format("stopped; lucerna cluster run {} resumes", options.folder));
  const std::vector<std::uint32_t> left = job.left();
  options.common.writeJson({{"done_here", tasks.size() - left.size()}, {"left", left.size()}});
  return exitCodeOf(job, left);
}

// ---------------------------------------------------------------------------------------------------- status, join

int status(const ClusterOptions& options) {
  options.common.apply();
  const Job job = readJob(options.folder);
  const std::vector<std::uint32_t> left = job.left();
  const auto begun = std::count_if(left.begin(), left.end(), [&](auto task) { return fs::exists(job.part(task)); });
  const std::size_t done = job.tasks - left.size(), missing = left.size() - static_cast<std::size_t>(begun);
  if (!options.common.quiet)
    fmt::print("{}: {} tasks: {} done, {} begun, {} missing\n", options.folder, job.tasks, done, begun, missing);
  options.common.writeJson({{"tasks", job.tasks}, {"done", done}, {"begun", begun}, {"missing", missing}});
  return 0;
}

/// Merges all parts into one checkpoint, and becomes the command with it, which finds everything made.
int join(const ClusterOptions& options) {
  options.common.apply();
  const Job job = readJob(options.folder);
  if (const int code = exitCodeOf(job, job.left()); code != 0) return code;
  const fs::path whole = job.folder / (job.isPicture() ? "whole.film" : "whole");
  if (!fs::exists(whole)) {
    std::vector<fs::path> parts;
    for (std::uint32_t task = 0; task < job.tasks; ++task) parts.push_back(job.part(task));
    if (job.isPicture()) writeFileAtomically(whole, bytesOf(mergeFilms(parts)));
    else mergeParts(parts, whole);
  }
  std::vector<std::string> words = job.command;
  words.insert(words.end(), {"--checkpoint", whole.string()});
  if (job.isPicture()) words.insert(words.end(), {"-o", job.output});
  const std::string json = options.common.json.empty() ? job.json : fs::absolute(options.common.json).string();
  if (!json.empty()) words.insert(words.end(), {"--json", json});
  if (options.common.quiet) words.emplace_back("--quiet");
  become(words, job.directory);
}

}  // namespace

Work addCluster(Command app) {
  Subcommands commands(app);
  auto options = std::make_shared<ClusterOptions>();
  Command planned = commands.add("plan", "Divide a command's work into tasks: a job's folder, with scripts for Slurm",
                                 [options] { return plan(*options); });
  planned.addOption("COMMAND", options->command, "after --: " + listOfCuts()).required();
  planned.addOption("-o,--output", options->folder, "the job's folder").required();
  planned.addOption("--tasks", options->tasks, "into how many").showDefault().range(1u, 1000000u);
  planned
      .addOption("--time", options->time,
                 "Slurm's time limit per task; a task that reaches it keeps its work, and JOB/submit goes on with it")
      .showDefault();
  planned.addOption("--account", options->account, "Slurm's account");
  planned.addOption("--gpus", options->gpus,
                    "Slurm's GPUs per task, such as 1; the task's program uses the first of them");
  Command running = commands.add("run", "Work on a job's tasks until none is left, on one machine at a time",
                                 [options] { return runCluster(*options); });
  running.addOption("--jobs", options->jobs, "tasks at once").showDefault().range(1, 256);
  running
      .addOption("--devices", options->devices,
                 "EGL devices for the workers of --jobs in turn, such as 0,1: each is its worker's LUCERNA_EGL_DEVICE")
      .delimiter(',');
  Command asked =
      commands.add("status", "Show how many tasks are done, begun, missing", [options] { return status(*options); });
  Command joined = commands.add("join", "Compute the result from all parts", [options] { return join(*options); });
  for (Command command : {running, asked, joined})
    command.addOption("JOB", options->folder, "the job's folder").required();
  for (Command command : {planned, running, asked, joined}) options->common.declare(command);
  return commands.work();
}

}  // namespace lucerna::demo
