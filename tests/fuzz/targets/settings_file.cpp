// Settings files, as --settings takes them.
#include "fuzz.hpp"

#include "shared/settings_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    lucerna::demo::readSettingsFile(lucerna::fuzz::write("fuzz.json", lucerna::fuzz::textOf(data, size)).string());
  });
}
