// Captures frames for RenderDoc, if installed. Its library must be loaded before all others to intercept OpenGL, so the
// program restarts itself with the library preloaded. Source of the interface: RenderDoc's "In-application API"
// (https://renderdoc.org/docs/in_application_api.html, renderdoc_app.h, version 1.1.2).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace lucerna::demo {

class RenderDoc {
 public:
  /// Finds the library if it is already in this process, started by RenderDoc or preload().
  static std::optional<RenderDoc> find();
  /// Restarts this program with the same command line and the library preloaded. Returns only if there is no library,
  /// or if that did not help. Call it before anything is printed or opened.
  static void preload();

  void begin() const;
  /// The capture file of everything drawn since begin(); none if RenderDoc saw no frame.
  std::optional<std::string> end() const;

 private:
  // Indices into its table of functions.
  enum Function { kGetNumCaptures = 13, kGetCapture = 14, kStartFrameCapture = 19, kEndFrameCapture = 21 };
  using GetNumCaptures = std::uint32_t (*)();
  using GetCapture = std::uint32_t (*)(std::uint32_t index, char* file, std::uint32_t* length, std::uint64_t* time);
  using StartFrameCapture = void (*)(void* device, void* window);  // null: the only one
  using EndFrameCapture = std::uint32_t (*)(void* device, void* window);

  explicit RenderDoc(void** table) : table_(table) {}
  template <class T>
  T function(Function place) const {
    return reinterpret_cast<T>(table_[place]);
  }
  void** table_;
};

}  // namespace lucerna::demo
