#include "rsm/lamp_choice.hpp"

#include "base/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string>

namespace lucerna {

std::vector<LightViews> keepMostImportant(gl::ProgramLibrary& programs, const GpuScene& scene,
                                          std::vector<LightViews>& views, std::size_t most, std::string_view lack) {
  if (views.size() <= most) return {};
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
  const double all = std::accumulate(reflected.begin(), reflected.end(), 0.0);
  std::vector<LightViews> kept, others;
  std::string names;
  double lost = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k < most) {
      kept.push_back(std::move(views[order[k]]));
      continue;
    }
    if (!(reflected[order[k]] > 0.0)) continue;  // it lights nothing
    constexpr std::size_t kMostNames = 8;
    LightViews& other = others.emplace_back(std::move(views[order[k]]));
    if (others.size() <= kMostNames)
      names += fmt::format("{}{}[{}]", names.empty() ? "" : ", ", other.isPoint ? "points" : "spots", other.index);
    else if (others.size() == kMostNames + 1) names += ", ...";
    lost += reflected[order[k]];
  }
  if (!others.empty() && !lack.empty())
    logWarning(
        "{} {} lights: {} that light the scene most have all; others, with {:.2g} % of it, {}: {} (shadow.lamps; the "
        "path tracer and radiosity have all)",
        views.size(), points ? "omnidirectional" : "spot", most, 100.0 * lost / all, lack, names);
  views = std::move(kept);
  return others;
}

}  // namespace lucerna
