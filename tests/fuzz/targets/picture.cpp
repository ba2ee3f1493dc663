// 8-bit pictures: the check of headers and chunks, then DevIL. The name's extension is that of Targa, which has no
// magic number.
#include "fuzz.hpp"

#include "base/image.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] { lucerna::decodeBitmap({data, size}, "fuzz.tga"); });
}
