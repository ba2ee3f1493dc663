// The cache of references. The checksum is put right, so that the fuzzer comes past it; what is not as it was written
// is not taken.
#include "fuzz.hpp"

#include "base/hash.hpp"
#include "measure/reference.hpp"

#include <cstring>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const lucerna::measure::ReferenceCache cache(lucerna::fuzz::folder());
  constexpr lucerna::measure::ReferenceKey kKey{5};
  std::string bytes(lucerna::fuzz::textOf(data, size));
  if (bytes.size() >= 16 + 8) {
    std::memcpy(bytes.data() + 8, &kKey.value, 8);
    const std::uint64_t sum = lucerna::Hash::of(bytes.data(), bytes.size() - 8);
    std::memcpy(bytes.data() + bytes.size() - 8, &sum, 8);
  }
  lucerna::fuzz::write(kKey.name() + ".lucref", bytes);
  return lucerna::fuzz::parse([&] {
    if (const auto reference = cache.load(kKey);
        reference && reference->mean.pixels.size() != reference->standardError.pixels.size())
      std::abort();
  });
}
