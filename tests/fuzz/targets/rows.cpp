// Rows of form factors on disk. The checksum of every block is put right, so that the fuzzer comes past it.
#include "fuzz.hpp"

#include "base/hash.hpp"
#include "radiosity/row_file.hpp"

#include <cstring>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kHeader = 24, kBlock = 24,
                        kSum = 16;  // of the file, of a block, where its sum stands: engine/radiosity/row_file.cpp
  constexpr std::uint64_t kFingerprint = 7;
  constexpr std::uint32_t kPatches = 16;
  std::string bytes(lucerna::fuzz::textOf(data, size));
  if (bytes.size() >= kHeader)
    std::memcpy(bytes.data() + 16, &kFingerprint, 8), std::memcpy(bytes.data() + 12, &kPatches, 4);
  for (std::size_t at = kHeader; bytes.size() >= at + kBlock;) {
    std::uint32_t rows = 0;
    std::uint64_t entries = 0;
    std::memcpy(&rows, bytes.data() + at + 4, 4);
    std::memcpy(&entries, bytes.data() + at + 8, 8);
    const std::size_t left = bytes.size() - at - kBlock;
    if (rows > left / 12 || entries > (left - 12 * std::size_t{rows}) / 8) break;
    const std::size_t block = 12 * std::size_t{rows} + 8 * entries;
    lucerna::Hash sum;
    sum.bytes(bytes.data() + at, kSum);
    sum.bytes(bytes.data() + at + kBlock, block);
    const std::uint64_t value = sum.value();
    std::memcpy(bytes.data() + at + kSum, &value, 8);
    at += kBlock + block;
  }
  return lucerna::fuzz::parse([&] {
    lucerna::RowFile file(lucerna::fuzz::write("fuzz.rows", bytes), kFingerprint, kPatches,
                          [](const lucerna::FormFactorRows& rows) {
                            for (const std::uint32_t patch : rows.patches)
                              if (patch >= kPatches) std::abort();
                          });
    file.forEach([](const lucerna::FormFactorRows&) {});
  });
}
