// The check of OBJ text, and the repair of its numbers.
#include "fuzz.hpp"

#include "scene/scene_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = lucerna::fuzz::textOf(data, size);
  return lucerna::fuzz::parse([&] {
    lucerna::checkObj("fuzz.obj", text);
    lucerna::checkObj("fuzz.obj", lucerna::repairedObj(text));  // what was right stays right
  });
}
