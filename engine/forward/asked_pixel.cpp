#include "forward/asked_pixel.hpp"

#include <algorithm>

namespace lucerna {

// The first entry holds the count.
std::vector<AskedPart> AskedParts::read() const {
  std::vector<AskedPart> parts = buffer_.read<AskedPart>();
  const auto told = static_cast<std::size_t>(parts.front().number.x);
  parts.erase(parts.begin());
  parts.resize(std::min(told, parts.size()));
  return parts;
}

}  // namespace lucerna
