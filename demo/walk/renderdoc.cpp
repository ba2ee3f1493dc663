#include "walk/renderdoc.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include <dlfcn.h>
#include <unistd.h>

namespace lucerna::demo {

namespace {

constexpr const char* kLibrary = "librenderdoc.so";
constexpr const char* kBegunAgain = "LUCERNA_UNDER_RENDERDOC";  // RenderDoc takes itself out of LD_PRELOAD

}  // namespace

std::optional<RenderDoc> RenderDoc::find() {
  constexpr int kVersion = 10102;  // 1.1.2
  void* library = dlopen(kLibrary, RTLD_NOW | RTLD_NOLOAD);
  if (!library) return {};
  const auto getApi = reinterpret_cast<int (*)(int version, void** table)>(dlsym(library, "RENDERDOC_GetAPI"));
  void* table = nullptr;
  if (!getApi || getApi(kVersion, &table) != 1 || !table) return {};
  return RenderDoc(static_cast<void**>(table));
}

void RenderDoc::preload() {
  if (std::getenv(kBegunAgain)) return;
  // Read the settings now: the library changes the environment when it is loaded.
  std::vector<std::string> settings;
  for (char** setting = environ; *setting; ++setting)
    if (!std::string_view(*setting).starts_with("LD_PRELOAD=")) settings.emplace_back(*setting);
  const char* before = std::getenv("LD_PRELOAD");
  settings.push_back(fmt::format("LD_PRELOAD={}{}{}", kLibrary, before ? ":" : "", before ? before : ""));
  settings.push_back(fmt::format("{}=1", kBegunAgain));
  void* library = dlopen(kLibrary, RTLD_LAZY);
  if (!library) return;
  dlclose(library);
  std::ifstream line("/proc/self/cmdline", std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(line), {}};
  std::vector<char*> arguments;
  for (std::size_t at = 0; at < bytes.size(); ++at)
    if (at == 0 || bytes[at - 1] == 0) arguments.push_back(&bytes[at]);
  arguments.push_back(nullptr);
  std::vector<char*> environment;
  for (std::string& setting : settings) environment.push_back(setting.data());
  environment.push_back(nullptr);
  execve("/proc/self/exe", arguments.data(), environment.data());
}

void RenderDoc::begin() const { function<StartFrameCapture>(kStartFrameCapture)(nullptr, nullptr); }

std::optional<std::string> RenderDoc::end() const {
  if (function<EndFrameCapture>(kEndFrameCapture)(nullptr, nullptr) != 1) return {};
  const std::uint32_t count = function<GetNumCaptures>(kGetNumCaptures)();
  std::uint32_t length = 0;
  const auto getCapture = function<GetCapture>(kGetCapture);
  if (count == 0 || getCapture(count - 1, nullptr, &length, nullptr) != 1) return {};
  std::string file(length, '\0');
  getCapture(count - 1, file.data(), &length, nullptr);
  while (!file.empty() && file.back() == '\0') file.pop_back();
  return file;
}

}  // namespace lucerna::demo
