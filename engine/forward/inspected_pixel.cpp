#include "forward/inspected_pixel.hpp"

#include <algorithm>

namespace lucerna {

// The first entry holds the count.
std::vector<InspectedPart> InspectedParts::read() const {
  std::vector<InspectedPart> parts = buffer_.read<InspectedPart>();
  const auto told = static_cast<std::size_t>(parts.front().number.x);
  parts.erase(parts.begin());
  parts.resize(std::min(told, parts.size()));
  return parts;
}

}  // namespace lucerna
