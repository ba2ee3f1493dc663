#include "support/faulty_shaders.hpp"

#include "base/data.hpp"
#include "base/error.hpp"
#include "base/files.hpp"

#include <cstdlib>

namespace lucerna::test {

FaultyShaders::FaultyShaders() {
  const char* asked = std::getenv("LUCERNA_SHADERS");
  std::filesystem::copy(asked && *asked ? std::filesystem::path(asked) : dataFolder() / "shaders", folder_.path(),
                        std::filesystem::copy_options::recursive);
}

void FaultyShaders::plant(const char* file, const std::string& from, const std::string& to) const {
  std::string text = readFileText(folder_ / file);
  const std::size_t at = text.find(from);
  CHECK(at != std::string::npos, "{} lacks {}", file, from);
  folder_.write(file, text.replace(at, from.size(), to));
}

}  // namespace lucerna::test
