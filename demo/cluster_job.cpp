#include "cluster_job.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

namespace lucerna::demo {

namespace fs = std::filesystem;

namespace {

std::string hostName() {
  char name[256] = "unknown";
  ::gethostname(name, sizeof name - 1);
  return name;
}

/// Creates the file; false if it already exists.
bool createNew(const fs::path& file, const std::string& text) {
  const int descriptor = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0644);
  if (descriptor < 0) {
    if (errno == EEXIST) return false;
    throwBadInput("{}: cannot create file ({})", file.string(), std::strerror(errno));
  }
  const auto written = ::write(descriptor, text.data(), text.size());  // for people: the file's existence is the claim
  static_cast<void>(written);
  ::close(descriptor);
  return true;
}

fs::path claimFile(const fs::path& folder, const std::string& task, int number) {
  return folder / "claims" / fmt::format("{}.{}", task, number);
}

}  // namespace

void ClusterJob::plan(const fs::path& folder, const ClusterCommand& command, std::uint32_t tasks) {
  if (fs::exists(folder / "job.json"))
    throwBadInput("-o {}: holds a job; choose another folder, or resume with lucerna cluster run {}", folder.string(),
                  folder.string());
  std::error_code error;
  for (const char* part : {"claims", "parts", "done", "logs"}) {
    fs::create_directories(folder / part, error);
    if (error) throwBadInput("-o {}: cannot create folder ({})", folder.string(), error.message());
  }
  nlohmann::ordered_json job;
  job["lucerna_cluster_job"] = 2;
  job["command"] = command.words;
  // Results lie where they would without a job, wherever it is joined.
  job["output"] = command.isPicture() ? fs::absolute(command.output).string() : "";
  job["json"] = command.json.empty() ? "" : fs::absolute(command.json).string();
  job["directory"] = fs::current_path().string();
  job["tasks"] = tasks;
  writeFileAtomically(folder / "job.json", job.dump(1) + "\n");
}

ClusterJob::ClusterJob(fs::path folder) : folder_(fs::absolute(folder)) {
  const fs::path file = folder_ / "job.json";
  if (!fs::exists(file)) throwBadInput("{}: holds no job (lucerna cluster plan creates one)", folder.string());
  const auto job = parseJson<nlohmann::ordered_json>(readFileText(file), file.string());
  try {
    if (job.at("lucerna_cluster_job") != 2) throwBadInput("{}: a job of a different version", file.string());
    command_ = {job.at("command").get<std::vector<std::string>>(), job.at("output").get<std::string>(),
                job.at("json").get<std::string>()};
    directory_ = job.at("directory").get<std::string>();
    const auto tasks = job.at("tasks").get<std::uint32_t>();
    const std::size_t digits = std::to_string(std::max(tasks, 1u) - 1).size();
    for (std::uint32_t i = 0; i < tasks; ++i) tasks_.push_back({fmt::format("{:0{}}", i, digits), i});
  } catch (const nlohmann::json::exception& error) {
    throwBadInput("{}: not a job of lucerna cluster plan ({})", file.string(), error.what());
  }
}

double ClusterJob::age(const fs::path& file) const {
  struct stat claim {
  }, now{};
  if (::stat(file.c_str(), &claim) != 0) return 0.0;  // given back meanwhile: look again
  const fs::path clock =
      folder_ / "claims" /
      fmt::format(".clock.{}.{}.{}", hostName(), ::getpid(), std::hash<std::thread::id>{}(std::this_thread::get_id()));
  const int descriptor = ::open(clock.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
  if (descriptor < 0) return 0.0;
  const bool known = ::futimens(descriptor, nullptr) == 0 && ::fstat(descriptor, &now) == 0;
  ::close(descriptor);
  ::unlink(clock.c_str());
  const auto seconds = [](const struct stat& s) {
    return static_cast<double>(s.st_mtim.tv_sec) + 1e-9 * static_cast<double>(s.st_mtim.tv_nsec);
  };
  return known ? seconds(now) - seconds(claim) : 0.0;
}

int ClusterJob::claimsOf(const ClusterTask& task) const {
  int count = 0;
  while (fs::exists(claimFile(folder_, task.name, count)) ||
         fs::exists(claimFile(folder_, task.name, count).concat(".back")))
    ++count;
  return count;
}

ClusterJob::State ClusterJob::state(const ClusterTask& task, double deadAfter) const {
  if (fs::exists(result(task))) return State::done;
  const int count = claimsOf(task);
  if (count == 0) return State::waiting;
  const fs::path last = claimFile(folder_, task.name, count - 1);
  return !fs::exists(last) || age(last) > deadAfter ? State::abandoned : State::running;
}

std::optional<fs::path> ClusterJob::claim(const ClusterTask& task, double deadAfter) const {
  if (fs::exists(result(task))) return std::nullopt;
  // The count is read once: a worker that claims the task before this one takes that number.
  const int count = claimsOf(task);
  if (count > 0) {
    const fs::path last = claimFile(folder_, task.name, count - 1);
    if (fs::exists(last) && age(last) <= deadAfter) return std::nullopt;
  }
  const fs::path file = claimFile(folder_, task.name, count);
  if (!createNew(file, fmt::format("{} process {}\n", hostName(), ::getpid()))) return std::nullopt;
  // The previous worker may have finished between the check and the claim.
  if (fs::exists(result(task))) return std::nullopt;
  return file;
}

bool ClusterJob::keep(const fs::path& claim) const {
  ::utimensat(AT_FDCWD, claim.c_str(), nullptr, 0);
  const std::string name = claim.filename().string(), task = name.substr(0, name.find('.'));
  return !fs::exists(claimFile(folder_, task, std::stoi(name.substr(name.find('.') + 1)) + 1));
}

void ClusterJob::giveBack(const fs::path& claim) const {
  std::error_code ignored;
  fs::rename(claim, fs::path(claim).concat(".back"), ignored);  // its number stays taken
}

}  // namespace lucerna::demo
