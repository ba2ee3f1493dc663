// Frames for RenderDoc, where it is installed. Its library must be there before all others, so that it sees what OpenGL
// is asked for: the program begins again with it preloaded. Source of the interface: RenderDoc's "In-application API"
// (https://renderdoc.org/docs/in_application_api.html, renderdoc_app.h, version 1.1.2).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace lucerna::demo {

class RenderDoc {
 public:
  /// Where the library is in this process already: RenderDoc or preload() has begun it.
  static std::optional<RenderDoc> find();
  /// Begins this program again, with the same command line, under the library. Returns only where there is none, or
  /// where it did not help. Before anything is printed or opened.
  static void preload();

  void begin() const;
  /// The file of what was drawn since begin(); nothing where RenderDoc saw no frame.
  std::optional<std::string> end() const;

 private:
  // Places in its table of functions.
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
