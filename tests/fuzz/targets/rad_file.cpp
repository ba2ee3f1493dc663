// Triangle files of the radiosity original; what is read is written as the same bytes.
#include "fuzz.hpp"

#include "radiosity/original/rad_file.hpp"

#include <algorithm>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    const auto triangles = lucerna::decodeRadFile({data, size}, "fuzz.rad");
    if (const auto again = lucerna::encodeRadFile(triangles);
        !std::equal(again.begin(), again.end(), data, data + size))
      std::abort();
    lucerna::checkRadTriangles(triangles, "fuzz.rad");
  });
}
