#include "rays/texture_atlas.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <numeric>

namespace lucerna {

AtlasLayout layOutAtlas(const std::vector<glm::ivec2>& sizes, int limit) {
  AtlasLayout layout;
  layout.places.resize(sizes.size());
  int side = 1;
  long area = 0;
  for (const glm::ivec2& size : sizes) {
    CHECK(size.x > 0 && size.y > 0 && std::max(size.x, size.y) <= limit, "{} x {} in an atlas of at most {}", size.x,
          size.y, limit);
    side = std::max({side, size.x, size.y});
    area += static_cast<long>(size.x) * size.y;
  }
  // Layers as wide as the widest texture, or wider while one of twice the side would still be filled.
  while (2 * side <= limit && area >= 4L * side * side) side *= 2;
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return sizes[a].y > sizes[b].y; });
  int layer = 0, x = 0, y = 0, shelf = 0, top = 0, right = 0;
  for (const std::size_t i : order) {
    if (x + sizes[i].x > side) {
      y += shelf;
      x = shelf = 0;
    }
    if (y + sizes[i].y > side) {
      ++layer;
      x = y = shelf = 0;
    }
    layout.places[i] = {layer, {x, y}};
    x += sizes[i].x;
    shelf = std::max(shelf, sizes[i].y);
    right = std::max(right, x);
    top = std::max(top, y + sizes[i].y);
  }
  layout.size = sizes.empty() ? glm::ivec3(0) : glm::ivec3(right, top, layer + 1);
  return layout;
}

}  // namespace lucerna
