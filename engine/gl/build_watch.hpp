// Who waits for programs to be built is told before each, so that a window can show what is going on, and stop it.
#pragma once

#include <functional>
#include <string>

namespace lucerna::gl {

/// For its lifetime, `watch` is called on this thread before each program that is built, with its name. It may draw
/// with passes of its own, and may throw, which ends what the program was built for. The innermost watch alone is told.
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
