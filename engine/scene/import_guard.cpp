#include "scene/import_guard.hpp"

#include "base/error.hpp"

#include <unistd.h>

#include <cstring>
#include <string>

namespace lucerna {

namespace {

constexpr int kSignals[4] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE};
constexpr std::size_t kStackBytes = 64 * 1024;

thread_local std::string g_message;  // formatted in advance: a handler may only write it

/// Only async-signal-safe calls: write and exit. A fault of another thread proceeds as usual.
extern "C" void onFault(int signal) {
  if (g_message.empty()) {
    std::signal(signal, SIG_DFL);
    ::raise(signal);
    return;
  }
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, g_message.data(), g_message.size());
  ::_exit(static_cast<int>(ErrorKind::badInput));
}

}  // namespace

ImportGuard::ImportGuard(const std::filesystem::path& file) : stack_(kStackBytes) {
  g_message = fmt::format(
      "lucerna: {}: cannot be read as a model: the model library crashes on it (it is damaged, or nested too deep)\n",
      file.string());
  stack_t stack{};
  stack.ss_sp = stack_.data();
  stack.ss_size = stack_.size();
  ::sigaltstack(&stack, &stackBefore_);
  struct sigaction action {};
  action.sa_handler = onFault;
  action.sa_flags = SA_ONSTACK;
  for (std::size_t i = 0; i < std::size(kSignals); ++i) ::sigaction(kSignals[i], &action, &before_[i]);
}

ImportGuard::~ImportGuard() {
  for (std::size_t i = 0; i < std::size(kSignals); ++i) ::sigaction(kSignals[i], &before_[i], nullptr);
  ::sigaltstack(&stackBefore_, nullptr);
  g_message.clear();
}

}  // namespace lucerna
