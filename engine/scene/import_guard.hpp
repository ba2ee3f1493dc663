// A last line of defence around the model library (no GL; private to engine/scene). Assimp 5.2.5 recurses once per
// level of nesting in most of its readers, and Debian's build aborts if its assumptions fail: a small broken file ends
// the process silently. While a guard lives, such a crash of its thread instead prints one line on standard error and
// exits with code 2, as for every other unreadable file.
#pragma once

#include <csignal>
#include <filesystem>
#include <vector>

namespace lucerna {

class ImportGuard {
 public:
  explicit ImportGuard(const std::filesystem::path& file);
  ~ImportGuard();
  ImportGuard(const ImportGuard&) = delete;
  ImportGuard& operator=(const ImportGuard&) = delete;

 private:
  std::vector<char> stack_;  ///< the handler's stack: the thread's own may be exhausted
  stack_t stackBefore_{};
  struct sigaction before_[4]{};
};

}  // namespace lucerna
