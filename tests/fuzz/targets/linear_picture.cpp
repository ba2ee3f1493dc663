// hdr, exr and pfm.
#include "fuzz.hpp"

#include "base/image.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = lucerna::fuzz::textOf(data, size);
  if (!text.starts_with("#?") && !text.starts_with("PF") && !text.starts_with("Pf") &&
      !text.starts_with("\x76\x2f\x31\x01"))
    return -1;
  return lucerna::fuzz::parse([&] { lucerna::readImage(lucerna::fuzz::write("fuzz.pfm", text)); });
}
