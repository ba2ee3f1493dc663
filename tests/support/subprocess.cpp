#include "support/subprocess.hpp"

#include "support/temp_folder.hpp"
#include "support/test_host.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <sys/wait.h>

namespace lucerna::test {

namespace {
std::string contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}
}  // namespace

RunResult run(const std::string& command) {
  setenv("LUCERNA_HOST", std::string(nameOf(testHost())).c_str(), 1);  // the program draws where the tests do
  const TempFolder folder;
  const auto out = folder.path() / "out", err = folder.path() / "err";
  const int status = std::system(("{ " + command + "\n} >'" + out.string() + "' 2>'" + err.string() + "'").c_str());
  RunResult result;
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = contents(out);
  result.err = contents(err);
  return result;
}

}  // namespace lucerna::test
