// Density grids; the first byte chooses among NRRD, KTX 2 and raw.
#include "fuzz.hpp"

#include "scene/density_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return -1;
  constexpr const char* kNames[] = {"fuzz.nrrd", "fuzz.ktx2", "fuzz.raw"};
  const unsigned kind = data[0] % 3u;
  return lucerna::fuzz::parse([&] {
    lucerna::readDensityGrid(lucerna::fuzz::write(kNames[kind], lucerna::fuzz::textOf(data + 1, size - 1)),
                             kind == 2 ? std::optional(glm::ivec3(2)) : std::nullopt);
  });
}
