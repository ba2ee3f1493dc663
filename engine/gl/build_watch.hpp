// Notifies a listener before each program is built, so that a window can show progress and stop it.
#pragma once

#include <functional>
#include <string>

namespace lucerna::gl {

/// During its lifetime, `watch` is called on this thread before each program is built, with the program's name. It may
/// draw with passes of its own. It may throw, which aborts the operation that needed the program. Only the innermost
/// watch is called.
class BuildWatch {
 public:
  explicit BuildWatch(std::function<void(const std::string& name)> watch);
  ~BuildWatch();
  BuildWatch(const BuildWatch&) = delete;
  BuildWatch& operator=(const BuildWatch&) = delete;

  static void say(const std::string& name);  ///< for ProgramLibrary

 private:
  std::function<void(const std::string&)> watch_;
  BuildWatch* outer_;
};

}  // namespace lucerna::gl
