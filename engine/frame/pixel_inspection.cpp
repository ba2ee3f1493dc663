#include "frame/pixel_inspection.hpp"

#include "base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace lucerna {

namespace {

double luminance(const glm::dvec3& c) { return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)); }  // IEC 61966-2-1

}  // namespace

bool PixelInspection::add(std::string group, std::string name, const glm::dvec3& light,
                          std::vector<glm::dvec3> places) {
  if (light == glm::dvec3(0.0)) return false;
  PixelShare share;
  share.group = std::move(group);
  share.name = std::move(name);
  share.radiance = light;
  share.places = std::move(places);
  shares.push_back(std::move(share));
  return true;
}

glm::dvec3 PixelInspection::sum() const {
  glm::dvec3 sum(0.0);
  for (const PixelShare& share : shares) sum += share.radiance;
  return sum;
}

void PixelInspection::checkSum() const {
  // Filters of 3D textures weigh the cells of a lookup with 8 bits; among them are brighter ones and negative ones.
  constexpr double kHalfFloats = 1e-3, kFilters = 0.02;
  double brightest = 0.0, largest = 0.0;
  for (int c = 0; c < 3; ++c) {
    brightest = std::max(brightest, std::abs(radiance[c]));
    for (const PixelShare& share : shares) largest = std::max(largest, std::abs(share.radiance[c]));
  }
  const glm::dvec3 all = sum(), off = glm::abs(all - radiance);
  const double most = isFiltered ? kFilters * std::max(brightest, largest) : kHalfFloats * brightest;
  if (!(std::max({off.x, off.y, off.z}) <= most))
    throw Error(ErrorKind::fault,
                fmt::format("internal error: pixel {}, {} is {} {} {}, but its parts add up to {} {} {}", pixel.x,
                            pixel.y, radiance.x, radiance.y, radiance.z, all.x, all.y, all.z));
}

double PixelInspection::shareOf(const glm::dvec3& part) const {
  const double all = luminance(radiance);
  return all > 0.0 ? luminance(part) / all : 0.0;
}

std::vector<std::pair<std::string, glm::dvec3>> PixelInspection::groups() const {
  std::map<std::string, glm::dvec3> sums;
  for (const PixelShare& share : shares) sums.try_emplace(share.group, 0.0).first->second += share.radiance;
  std::vector<std::pair<std::string, glm::dvec3>> result(sums.begin(), sums.end());
  std::ranges::stable_sort(result,
                           [](const auto& a, const auto& b) { return luminance(a.second) > luminance(b.second); });
  return result;
}

void PixelInspection::condense(std::size_t most) {
  const auto brighter = [](const PixelShare& a, const PixelShare& b) {
    return std::abs(luminance(a.radiance)) > std::abs(luminance(b.radiance));
  };
  std::ranges::stable_sort(shares, brighter);
  std::vector<PixelShare> kept;
  std::map<std::string, std::size_t> countOf;
  std::map<std::pair<std::string, bool>, PixelShare> others;
  for (PixelShare& share : shares) {
    if (countOf[share.group]++ < most) {
      kept.push_back(std::move(share));
      continue;
    }
    const bool isNegative = luminance(share.radiance) < 0.0;
    const auto [at, isNew] = others.try_emplace({share.group, isNegative}, PixelShare{});
    PixelShare& rest = at->second;
    if (isNew) rest.group = share.group;
    rest.count = isNew ? share.count : rest.count + share.count;
    rest.radiance += share.radiance;
    rest.name = fmt::format("{} others{}", rest.count, isNegative ? " that take light away" : "");
  }
  for (auto& [group, rest] : others) kept.push_back(std::move(rest));
  std::ranges::stable_sort(kept, brighter);
  shares = std::move(kept);
}

}  // namespace lucerna
