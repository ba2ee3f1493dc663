// The check of 8-bit pictures alone, which is many times as fast as with a decoder behind it.
#include "fuzz.hpp"

#include "base/picture_header.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] { lucerna::checkPicture({data, size}, "fuzz.tga"); });
}
