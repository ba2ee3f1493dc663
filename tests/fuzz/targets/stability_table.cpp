// Tables of bench stability that were kept, compared with themselves and with none.
#include "fuzz.hpp"

#include "bench/stability.hpp"

#include <nlohmann/json.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lucerna::fuzz::parse([&] {
    const std::string file = lucerna::fuzz::write("fuzz.json", lucerna::fuzz::textOf(data, size)).string();
    const nlohmann::ordered_json rows = lucerna::demo::bench::readKept(file);
    lucerna::demo::bench::worseRows(rows, rows, "", file);
    lucerna::demo::bench::worseRows(nlohmann::ordered_json::array(), rows, "lpv", file);
  });
}
