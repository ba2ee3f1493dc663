#include "rsm/lamp_choice.hpp"

#include "base/log.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <string>

namespace lucerna {

void keepMostImportant(gl::ProgramLibrary& programs, const GpuScene& scene, std::vector<LightViews>& views,
                       std::size_t most) {
  if (views.size() <= most) return;
  const bool points = views.front().omnidirectional();
  ReflectiveShadowMap::Settings settings;
  settings.light = points ? ReflectiveShadowMap::Light::point : ReflectiveShadowMap::Light::spot;
  settings.size = points ? 32 : 64;
  ReflectiveShadowMap map(programs, scene, settings);
  std::vector<double> reflected;  // W, channels averaged
  for (const LightViews& view : views) {
    double sum = 0.0;
    for (const glm::vec4& texel : map.record(scene, view).flux.readRgba())
      sum += (static_cast<double>(texel.x) + static_cast<double>(texel.y) + static_cast<double>(texel.z)) / 3.0;
    reflected.push_back(sum);
  }
  std::vector<std::size_t> order(views.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return reflected[a] > reflected[b]; });
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most));
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(most), order.end());
  const double all = std::accumulate(reflected.begin(), reflected.end(), 0.0);
  std::vector<LightViews> kept;
  std::vector<std::string> leftOut;
  double lost = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k < most) {
      kept.push_back(std::move(views[order[k]]));
      continue;
    }
    leftOut.push_back(std::to_string(views[order[k]].index));
    lost += reflected[order[k]];
  }
  logWarning(
      "{} {} lights, only the {} that light the scene most are drawn; left out, with {:.2g} % of the light: {}[{}] "
      "(the path tracer uses all)",
      views.size(), points ? "omnidirectional" : "spot", most, all > 0.0 ? 100.0 * lost / all : 0.0,
      points ? "points" : "spots", fmt::join(leftOut, ", "));
  views = std::move(kept);
}

}  // namespace lucerna
