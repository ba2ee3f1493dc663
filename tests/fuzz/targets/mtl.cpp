// The MTL that a scene JSON is drafted from; what is drafted must be read again.
#include "fuzz.hpp"

#include "base/json.hpp"
#include "scene/media_catalogue.hpp"
#include "scene/original_scene_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    const std::string text =
        lucerna::draftOriginalScene(lucerna::fuzz::write("draft.mtl", lucerna::fuzz::textOf(data, size))).first;
    if (!nlohmann::json::parse(text).contains("scene")) std::abort();
  });
}
