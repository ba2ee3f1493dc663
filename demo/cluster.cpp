#include "cluster.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "bench/provenance.hpp"
#include "cluster_job.hpp"
#include "commands.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <mutex>
#include <string_view>
#include <thread>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;
using State = ClusterJob::State;

struct ClusterOptions {
  CommonOptions common;
  std::string folder, output, time = "1-00:00:00", account, gpus;
  std::vector<std::string> command, devices;
  std::uint32_t tasks = 40;
  int jobs = 1;
  std::optional<int> task;
  double deadAfter = 120.0, saveEvery = 60.0;
};

std::string thisProgram() { return fs::read_symlink("/proc/self/exe").string(); }

// ---------------------------------------------------------------------------------------------------- plan

/// Commands that --part divides, and their units.
struct Cut {
  std::vector<std::string> command;
  const char* units;
};
const std::vector<Cut>& cuts() {
  static const std::vector<Cut> all{{{"render"}, "samples"},
                                    {{"walk"}, "frames"},
                                    {{"bench", "references"}, "batches"},
                                    {{"bench", "error"}, "rows"},
                                    {{"bench", "stability"}, "rows"},
                                    {{"bench", "tables"}, "rows"},
                                    {{"radiosity", "solve"}, "rows of hemicubes"}};
  return all;
}

std::string listOfCuts() {
  std::string list;
  for (const Cut& cut : cuts())
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", fmt::join(cut.command, " "), cut.units);
  return list;
}

struct Planned {
  ClusterCommand command;
  std::string units;
};

Planned readCommand(std::vector<std::string> words, std::uint32_t tasks) {
  if (!words.empty() && (words[0] == "lucerna" || words[0].ends_with("/lucerna"))) words.erase(words.begin());
  Planned planned;
  for (const Cut& cut : cuts())
    if (words.size() >= cut.command.size() && std::equal(cut.command.begin(), cut.command.end(), words.begin()))
      planned.units = cut.units;
  if (planned.units.empty())
    throwBadInput("cluster plan: the command after -- must be one that can be divided into parts: {}", listOfCuts());
  const bool isPicture = words[0] == "render";
  bool isPath = false;
  std::uint32_t samples = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    // Handles both "--key value" and "--key=value".
    std::string key = words[i], value;
    if (const auto equals = key.find('='); key.starts_with("--") && equals != std::string::npos)
      value = key.substr(equals + 1), key = key.substr(0, equals);
    const auto next = [&]() -> const std::string& {
      if (value.empty() && i + 1 >= words.size()) throwBadInput("cluster plan: {} has no value", key);
      return value.empty() ? words[i + 1] : value;
    };
    const auto skip = [&] { i += value.empty(); };
    if (key == "--part" || key == "--checkpoint" ||
        (isPicture && (key == "--samples" || key == "--seconds" || key == "--error" || key == "--save-every")))
      throwBadInput("cluster plan: {}: a task's own{}", key, isPicture ? "; give --spp and -o" : "");
    if (key == "--quiet") continue;
    if (key == "--json") {
      planned.command.json = next();
      skip();
      continue;
    }
    if (isPicture && (key == "-o" || key == "--output")) {
      planned.command.output = next();
      skip();
      continue;
    }
    if (key == "--technique") isPath = next() == "path";
    if (isPicture && key == "--spp") {
      const std::string& text = next();
      if (text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos)
        throwBadInput("cluster plan: --spp {}: expected a whole number up to 999999999", text);
      samples = static_cast<std::uint32_t>(std::stoul(text));
    }
    planned.command.words.push_back(words[i]);
  }
  if (!isPicture) return planned;
  if (!isPath)
    throwBadInput("cluster plan: only pictures with --technique path can be divided, into parts of their samples");
  if (samples == 0) throwBadInput("cluster plan: --spp N is missing: the number of samples that the tasks share");
  if (tasks > samples) throwBadInput("--tasks {}: expected 1 to {}, the samples of a pixel", tasks, samples);
  if (!isWritableImageName(planned.command.output))
    throwBadInput("cluster plan: -o {}: the extension must be png, hdr, exr or pfm", planned.command.output);
  return planned;
}

/// Writes the Slurm scripts: the array, one task each, and the join after it. Tasks ended by a signal, a node failure
/// or a preemption are given back, or are found abandoned; the join finishes what is left before it joins.
void writeSlurm(const fs::path& folder, const ClusterOptions& options) {
  const fs::path whole = fs::absolute(folder);
  const std::string program = bench::shellWord(thisProgram()), job = bench::shellWord(whole.string());
  std::string head =
      fmt::format("#!/bin/bash\n#SBATCH --time={}\n#SBATCH --requeue\n#SBATCH --open-mode=append\n", options.time);
  if (!options.account.empty()) head += fmt::format("#SBATCH --account={}\n", options.account);
  if (!options.gpus.empty()) head += fmt::format("#SBATCH --gpus-per-task={}\n", options.gpus);
  // Slurm's numbers and UUIDs are not EGL devices: the host finds the device they mean (host/egl_device.hpp).
  const std::string environment =
      "# Of a node's devices the first that Slurm gave to this task; NoDevFiles: it gave none.\n"
      "given=\"${CUDA_VISIBLE_DEVICES:+cuda:$CUDA_VISIBLE_DEVICES}\"\n"
      "given=\"${given:-${ROCR_VISIBLE_DEVICES:+rocm:$ROCR_VISIBLE_DEVICES}}\"\n"
      "case \"$given\" in ''|*:NoDevFiles) ;; *) export LUCERNA_EGL_DEVICE=\"${given%%,*}\" ;; esac\n";
  const std::string array =
      head +
      fmt::format(
          "#SBATCH --job-name=lucerna\n#SBATCH --array=0-{}\n#SBATCH --ntasks=1\n#SBATCH --signal=B:TERM@60\n#SBATCH "
          "--output={}/logs/slurm-%a.log\n",
          options.tasks - 1, whole.string()) +
      environment +
      fmt::format("exec {} cluster run {} --task \"$SLURM_ARRAY_TASK_ID\" --dead-after {:g} --save-every {:g}\n",
                  program, job, options.deadAfter, options.saveEvery);
  const std::string join =
      head +
      fmt::format("#SBATCH --job-name=lucerna-join\n#SBATCH --ntasks=1\n#SBATCH --output={}/logs/slurm-join.log\n",
                  whole.string()) +
      environment +
      fmt::format(
          "# What the array left: tasks of nodes that fell out.\n{0} cluster run {1} --dead-after {2:g} --quiet && "
          "exec {0} cluster join {1}\n",
          program, job, options.deadAfter);
  const std::string submit = fmt::format(
      "#!/bin/sh\n# Hands both to Slurm; prints their numbers.\nset -e\narray=$(sbatch --parsable "
      "{0}/array.sbatch)\njoin=$(sbatch --parsable --dependency=afterany:\"$array\" {0}/join.sbatch)\n"
      "echo \"$array $join\"\n",
      job);
  for (const auto& [name, text] : {std::pair{"array.sbatch", array}, {"join.sbatch", join}, {"submit", submit}}) {
    writeFileAtomically(folder / name, text);
    fs::permissions(folder / name, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                    fs::perm_options::add);
  }
}

int plan(const ClusterOptions& options) {
  options.common.apply();
  const Planned planned = readCommand(options.command, options.tasks);
  ClusterJob::plan(options.output, planned.command, options.tasks);
  writeSlurm(options.output, options);
  if (!options.common.quiet)
    fmt::print(
        "{0}: {1} tasks, parts of the {2}. On this machine: lucerna cluster run {0} --jobs N, then lucerna cluster "
        "join {0}. With Slurm: {0}/submit\n",
        options.output, options.tasks, planned.units);
  options.common.writeJson({{"job", options.output}, {"tasks", options.tasks}, {"units", planned.units}});
  return 0;
}

// ---------------------------------------------------------------------------------------------------- run

/// This process's environment with another LUCERNA_EGL_DEVICE; empty: unchanged.
std::vector<std::string> environmentFor(const std::string& device) {
  constexpr std::string_view kName = "LUCERNA_EGL_DEVICE=";
  std::vector<std::string> all;
  for (char** variable = environ; *variable; ++variable)
    if (device.empty() || !std::string_view(*variable).starts_with(kName)) all.emplace_back(*variable);
  if (!device.empty()) all.push_back(std::string(kName) + device);
  return all;
}

/// This program with other arguments, as a child process. Ctrl-C and SIGTERM are forwarded to it.
class Child {
 public:
  /// Starts in `directory`; its output is appended to `log`, unless empty. A child with a log ends together with the
  /// thread that started it: a worker that is killed takes its task along. `device`: its LUCERNA_EGL_DEVICE; empty:
  /// this process's.
  Child(const std::vector<std::string>& words, const std::string& directory, const std::string& log = "",
        const std::string& device = "") {
    const std::string program = thisProgram();
    std::vector<char*> arguments{const_cast<char*>(program.c_str())};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const std::vector<std::string> variables = environmentFor(device);
    std::vector<char*> environment;
    for (const std::string& variable : variables) environment.push_back(const_cast<char*>(variable.c_str()));
    environment.push_back(nullptr);
    std::fflush(stdout);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ < 0) throwMissingCapability("cluster: cannot create process ({})", std::strerror(errno));
    if (process_ > 0) return;
    // Between fork and exec only async-signal-safe calls are allowed.
    if (!log.empty()) {
      ::prctl(PR_SET_PDEATHSIG, SIGTERM);
      if (::getppid() != parent) ::_exit(143);
      const int out = ::open(log.c_str(), O_CREAT | O_APPEND | O_WRONLY, 0644);
      if (out >= 0) ::dup2(out, 1), ::dup2(out, 2);
    }
    if (::chdir(directory.c_str()) != 0) ::_exit(126);
    ::execve(arguments[0], arguments.data(), environment.data());
    ::_exit(127);
  }
  void stop() {
    if (!asked_) asked_ = ::kill(process_, SIGTERM) == 0;
  }
  /// Its wait status, as from waitpid(), once it has ended. `meanwhile` is called regularly.
  template <class Meanwhile>
  int wait(const Meanwhile& meanwhile) {
    int status = 0;
    while (::waitpid(process_, &status, WNOHANG) == 0) {
      if (interrupted()) stop();
      meanwhile();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return status;
  }

 private:
  pid_t process_ = -1;
  bool asked_ = false;
};

/// Runs a task until it ends, should stop, or was taken over as dead. Returns whether it is done.
bool runTask(const ClusterJob& job, const ClusterTask& task, const fs::path& claim, const std::string& device,
             double saveEvery, bool quiet) {
  std::vector<std::string> words = job.command().words;
  // The result is written last: it marks the part as complete.
  words.insert(words.end(), {"--part", fmt::format("{}/{}", task.number, job.tasks().size()), "--checkpoint",
                             job.part(task).string(), "--json", job.result(task).string(), "--quiet"});
  if (job.command().isPicture()) words.insert(words.end(), {"--save-every", fmt::format("{:g}", saveEvery)});
  const std::string log = job.log(task).string();
  Child child(words, job.directory(), log, device);
  auto alive = Clock::now();
  bool lost = false;
  const int status = child.wait([&] {
    if (secondsSince(alive) <= 5.0) return;
    alive = Clock::now();
    lost = lost || !job.keep(claim);
    if (lost) child.stop();
  });
  const bool done = WIFEXITED(status) && WEXITSTATUS(status) == 0 && fs::exists(job.result(task));
  if (!done && !lost) job.giveBack(claim);
  if (!quiet)
    fmt::print("{}{}\n", task.name,
               done                  ? ""
               : WIFSIGNALED(status) ? fmt::format(", ended by signal {}", WTERMSIG(status))
                                     : fmt::format(", exit code {}: see {}", WEXITSTATUS(status), log));
  return done;
}

int runCluster(const ClusterOptions& options) {
  options.common.apply();
  const ClusterJob job(options.folder);
  const int count = static_cast<int>(job.tasks().size());
  if (options.task && (*options.task < 0 || *options.task >= count))
    throwBadInput("--task {}: the job has 0 to {}", *options.task, count - 1);
  watchForInterrupt();
  // A task that keeps failing is not retried forever.
  constexpr int kTries = 3;
  std::mutex mutex;
  std::map<std::string, int> failures;
  std::atomic<int> finished = 0;
  std::string fault;
  const auto work = [&](int worker) {
    const std::string device = options.devices.empty()
                                   ? std::string()
                                   : options.devices[static_cast<std::size_t>(worker) % options.devices.size()];
    try {
      while (!interrupted()) {
        bool isBusy = false, did = false;
        for (int k = 0; k < count && !interrupted(); ++k) {
          if (options.task && k != *options.task) continue;
          // Workers start at different tasks, so that they rarely want the same one.
          const ClusterTask& task = job.tasks()[static_cast<std::size_t>(
              (k + (options.task ? 0 : worker * count / std::max(options.jobs, 1))) % count)];
          if (const std::scoped_lock lock(mutex); failures[task.name] >= kTries) continue;
          const State state = job.state(task, options.deadAfter);
          if (state == State::done) continue;
          const auto claim = job.claim(task, options.deadAfter);
          if (!claim) {
            isBusy = isBusy || job.state(task, options.deadAfter) == State::running;
            continue;
          }
          did = true;
          if (runTask(job, task, *claim, device, options.saveEvery, options.common.quiet)) ++finished;
          else if (!interrupted()) {
            const std::scoped_lock lock(mutex);
            ++failures[task.name];
          }
        }
        if (did) continue;
        // A worker of an array leaves the other tasks to their workers; otherwise a task in progress may yet be
        // abandoned.
        if (!isBusy || options.task) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
      }
    } catch (const std::exception& error) {
      const std::scoped_lock lock(mutex);
      fault = error.what();
    }
  };
  std::vector<std::thread> workers;
  for (int i = 0; i < options.jobs; ++i) workers.emplace_back(work, i);
  for (std::thread& worker : workers) worker.join();
  if (!fault.empty()) throwBadInput("{}", fault);
  if (interrupted()) throw Stopped(fmt::format("stopped; lucerna cluster run {} resumes", options.folder));
  int left = 0;
  for (int k = 0; k < count; ++k)
    if (!options.task || k == *options.task)
      left += job.state(job.tasks()[static_cast<std::size_t>(k)], options.deadAfter) != State::done;
  if (!options.common.quiet) fmt::print("{} tasks done here, {} left\n", finished.load(), left);
  options.common.writeJson({{"done_here", finished.load()}, {"left", left}});
  // It is no failure if another worker has the one requested task.
  return left == 0 || (options.task && job.state(job.tasks()[static_cast<std::size_t>(*options.task)],
                                                 options.deadAfter) == State::running)
             ? 0
             : 1;
}

// ---------------------------------------------------------------------------------------------------- status, join

int status(const ClusterOptions& options) {
  options.common.apply();
  const ClusterJob job(options.folder);
  std::map<State, int> counts;
  for (const ClusterTask& task : job.tasks()) ++counts[job.state(task, options.deadAfter)];
  if (!options.common.quiet)
    fmt::print("{}: {} tasks: {} done, {} running, {} abandoned, {} waiting\n", options.folder, job.tasks().size(),
               counts[State::done], counts[State::running], counts[State::abandoned], counts[State::waiting]);
  options.common.writeJson({{"tasks", job.tasks().size()},
                            {"done", counts[State::done]},
                            {"running", counts[State::running]},
                            {"abandoned", counts[State::abandoned]},
                            {"waiting", counts[State::waiting]}});
  return 0;
}

/// Runs lucerna in the folder where the job was planned; returns its exit code.
int runHere(const std::vector<std::string>& words, const std::string& directory) {
  const int status = Child(words, directory).wait([] {});
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int join(const ClusterOptions& options) {
  options.common.apply();
  const ClusterJob job(options.folder);
  for (const ClusterTask& task : job.tasks()) {
    if (!fs::exists(job.result(task)))
      throwBadInput("{}: task {} is not done (lucerna cluster status {}, then cluster run)", options.folder, task.name,
                    options.folder);
  }
  watchForInterrupt();
  const ClusterCommand& command = job.command();
  const std::string parts = (job.folder() / "parts").string(),
                    json = options.common.json.empty() ? command.json : fs::absolute(options.common.json).string();
  std::vector<std::string> last;
  if (!json.empty()) last.insert(last.end(), {"--json", json});
  if (options.common.quiet) last.emplace_back("--quiet");
  // Merges all parts into one checkpoint, then runs the command with it, which finds everything computed.
  const std::string whole = (job.folder() / (command.isPicture() ? "whole.film" : "whole")).string();
  if (!fs::exists(whole))
    if (const int code = runHere({"merge", "--parts", parts, "--checkpoint", whole, "--quiet"}, job.directory());
        code != 0)
      return code;
  std::vector<std::string> words = command.words;
  words.insert(words.end(), {"--checkpoint", whole});
  if (command.isPicture()) words.insert(words.end(), {"-o", command.output});
  words.insert(words.end(), last.begin(), last.end());
  return runHere(words, job.directory());
}

}  // namespace

Work addCluster(Command app) {
  Subcommands commands(app);
  auto options = std::make_shared<ClusterOptions>();
  Command planned = commands.add(
      "plan", "Divide a command's work into tasks, in a folder that all machines see; with scripts for Slurm",
      [options] { return plan(*options); });
  planned.addOption("COMMAND", options->command, "after --: " + listOfCuts()).required();
  planned.addOption("-o,--output", options->output, "the job's folder").required();
  planned.addOption("--tasks", options->tasks, "into how many").showDefault().range(1u, 1000000u);
  planned
      .addOption("--time", options->time,
                 "Slurm's time limit per task; a task that reaches it is given back, and the join finishes it")
      .showDefault();
  planned.addOption("--account", options->account, "Slurm's account");
  planned.addOption("--gpus", options->gpus,
                    "Slurm's GPUs per task, such as 1; the task's program uses the first of them");
  const auto deadAfter = [&](Command command) {
    command
        .addOption("--dead-after", options->deadAfter,
                   "seconds without a sign of life after which another worker takes over a task; signs come every 5 s")
        .showDefault()
        .range(6.0, 1e6);
  };
  deadAfter(planned);
  const auto saveEvery = [&](Command command) {
    command
        .addOption("--save-every", options->saveEvery,
                   "of a path traced picture: seconds between a task's checkpoints; other work is stored unit by unit")
        .showDefault()
        .range(0.0, 1e6);
  };
  saveEvery(planned);
  Command running = commands.add("run", "Work on a job's tasks until none is left; any number of machines at once",
                                 [options] { return runCluster(*options); });
  running.addOption("JOB", options->folder, "the job's folder").required();
  running.addOption("--jobs", options->jobs, "tasks at once").showDefault().range(1, 256);
  running
      .addOption("--devices", options->devices,
                 "EGL devices for the workers of --jobs in turn, such as 0,1: each is its worker's LUCERNA_EGL_DEVICE")
      .delimiter(',');
  running.addOption("--task", options->task, "only that task, for example of a Slurm array");
  deadAfter(running);
  saveEvery(running);
  Command asked = commands.add("status", "Show how many tasks are done, running, abandoned, waiting",
                               [options] { return status(*options); });
  asked.addOption("JOB", options->folder, "the job's folder").required();
  deadAfter(asked);
  Command joined = commands.add("join", "Compute the result from all parts", [options] { return join(*options); });
  joined.addOption("JOB", options->folder, "the job's folder").required();
  for (Command command : {planned, running, asked, joined}) options->common.declare(command);
  return commands.work();
}

}  // namespace lucerna::demo
