// The shaders under test with faults planted in them.
#pragma once

#include "support/temp_folder.hpp"

#include <filesystem>
#include <string>

namespace lucerna::test {

/// A copy of the shaders that a ProgramLibrary would use, LUCERNA_SHADERS or the project's.
class FaultyShaders {
 public:
  FaultyShaders();
  /// Replaces the first `from` in a file, which must be there.
  void plant(const char* file, const std::string& from, const std::string& to) const;
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  TempFolder folder_;
};

}  // namespace lucerna::test
