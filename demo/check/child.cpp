#include "check/child.hpp"

#include "base/clock.hpp"
#include "base/error.hpp"
#include "shared/commands.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string_view>
#include <thread>

namespace lucerna::demo::check {

namespace {

/// What a child says, line by line.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& log) : log_(log, std::ios::app) {}

  void add(std::string_view bytes) {
    log_ << bytes << std::flush;
    for (const char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      read();
      line_.clear();
    }
  }
  std::string place() const {
    return pass_.empty() ? at_ : fmt::format("{}{}pass {}", at_, at_.empty() ? "" : ", ", pass_);
  }
  const std::string& message() const { return message_; }

 private:
  void read() {
    constexpr std::string_view kAt = "at ", kPass = "pass ", kMessage = "lucerna: ", kWarning = "lucerna: warning: ";
    if (line_.starts_with(kAt)) {
      at_ = line_.substr(kAt.size());
      pass_.clear();
    }
    if (line_.starts_with(kPass)) pass_ = line_.substr(kPass.size());
    if (line_.starts_with(kMessage) && !line_.starts_with(kWarning)) message_ = line_.substr(kMessage.size());
  }

  std::ofstream log_;
  std::string line_, at_, pass_, message_;
};

/// The child, in a process group of its own; its outputs come through `pipe`.
struct Started {
  pid_t process;
  int pipe;
};

Started start(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
  std::string name = "lucerna";
  std::vector<char*> words{name.data()}, variables;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  for (const std::string& variable : environment) variables.push_back(const_cast<char*>(variable.c_str()));
  for (char** variable = environ; *variable; ++variable) variables.push_back(*variable);  // the first one counts
  variables.push_back(nullptr);
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throwMissingCapability("check: no pipe ({})", std::strerror(errno));
  std::fflush(stdout);
  const pid_t parent = ::getpid(), process = ::fork();
  if (process < 0) throwMissingCapability("check: cannot create process ({})", std::strerror(errno));
  if (process == 0) {
    // Between fork and exec only async-signal-safe calls are allowed.
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(143);
    ::dup2(ends[1], 1), ::dup2(ends[1], 2);
    // The file that this process runs, even if another build has replaced it meanwhile.
    ::execve("/proc/self/exe", words.data(), variables.data());
    ::_exit(127);
  }
  ::close(ends[1]);
  return {process, ends[0]};
}

}  // namespace

ChildEnd runChild(const std::vector<std::string>& arguments, const std::vector<std::string>& environment,
                  const std::filesystem::path& log, double seconds) {
  constexpr double kPatience = 5.0;  // from the kill to the end of a process that the driver holds
  Lines lines(log);
  const Started child = start(arguments, environment);
  const auto begun = Clock::now();
  auto heard = begun;
  ChildEnd end;
  std::optional<Clock::time_point> killed;
  int status = 0;
  const auto read = [&](int milliseconds) {
    pollfd ready{child.pipe, POLLIN, 0};
    if (::poll(&ready, 1, milliseconds) <= 0) return false;
    std::array<char, 4096> bytes{};
    const ssize_t count = ::read(child.pipe, bytes.data(), bytes.size());
    if (count <= 0) {  // closed; the process may live on
      std::this_thread::sleep_for(std::chrono::milliseconds(std::min(milliseconds, 10)));
      return false;
    }
    lines.add({bytes.data(), static_cast<std::size_t>(count)});
    heard = Clock::now();
    return true;
  };
  while (::waitpid(child.process, &status, WNOHANG) == 0) {
    read(20);
    if (!killed && (interrupted() || secondsSince(begun) > seconds)) {
      end.stopped = interrupted();
      end.timedOut = !end.stopped;
      end.quiet = secondsSince(heard);
      ::kill(-child.process, SIGKILL);
      killed = Clock::now();
    }
    if (killed && secondsSince(*killed) > kPatience) {
      end.stuck = true;
      break;
    }
  }
  ::kill(-child.process, SIGKILL);  // children of its own
  while (read(0)) {}
  ::close(child.pipe);
  end.seconds = secondsSince(begun);
  end.place = lines.place();
  end.message = lines.message();
  if (!end.stuck && WIFEXITED(status)) end.code = WEXITSTATUS(status);
  if (!end.stuck && WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  return end;
}

}  // namespace lucerna::demo::check
