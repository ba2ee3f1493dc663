// Checkpoints of the radiosity original. The digest is put right, so that the fuzzer comes past it.
#include "fuzz.hpp"

#include "radiosity/original/checkpoint.hpp"

#include <cstring>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(lucerna::fuzz::textOf(data, size));
  if (bytes.size() > 8) {
    const std::uint64_t digest =
        lucerna::digestOf(std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size() - 8));
    std::memcpy(bytes.data() + bytes.size() - 8, &digest, 8);
  }
  return lucerna::fuzz::parse([&] { lucerna::readCheckpoint(lucerna::fuzz::write("fuzz.sweep", bytes)); });
}
