#include "radiosity/form_factor_rows.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>

namespace lucerna {

namespace {

FormFactorRows rowsOfListed(const DrawnHemicubes& drawn) {
  struct Entry {
    std::uint32_t at;
    float byPixels, factor;
  };
  std::vector<Entry> entries;
  entries.reserve(drawn.kept.size());
  for (const glm::uvec2& kept : drawn.kept)
    entries.push_back({kept.x, std::bit_cast<float>(kept.y), std::bit_cast<float>(kept.y)});
  for (const glm::uvec2& exact : drawn.exact) entries[exact.x].factor = std::bit_cast<float>(exact.y);
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.at < b.at; });
  FormFactorRows result;
  result.first = drawn.first;
  auto entry = entries.begin();
  for (int row = 0; row < drawn.count; ++row) {
    const auto begin = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(drawn.patchCount);
    const std::size_t before = result.patches.size();
    double front = 0.0, back = 0.0;
    for (; entry != entries.end() && entry->at - begin < static_cast<std::uint32_t>(drawn.patchCount); ++entry) {
      (entry->byPixels > 0.0f ? front : back) += std::abs(static_cast<double>(entry->byPixels));
      if (!(entry->factor > 0.0f)) continue;
      result.patches.push_back(entry->at - begin);
      result.factors.push_back(entry->factor);
    }
    result.fronts.push_back(static_cast<float>(front));
    result.backs.push_back(static_cast<float>(back));
    result.counts.push_back(static_cast<std::uint32_t>(result.patches.size() - before));
  }
  return result;
}

}  // namespace

FormFactorRows rowsOf(DrawnHemicubes drawn) {
  if (drawn.factors.empty()) return rowsOfListed(drawn);
  const auto patches = static_cast<std::size_t>(drawn.patchCount), rowCount = static_cast<std::size_t>(drawn.count);
  FormFactorRows result;
  result.first = drawn.first;
  std::size_t entries = 0;
  for (std::size_t row = 0; row < rowCount; ++row) {
    // Eight sums side by side, so that the processor adds them at once; always the same eight, for identical bits.
    const float* factors = drawn.factors.data() + row * patches;
    double fronts[8] = {}, backs[8] = {};
    std::size_t seen = 0;
    for (std::size_t i = 0; i < patches; ++i) {
      fronts[i % 8] += static_cast<double>(std::max(factors[i], 0.0f));
      backs[i % 8] += static_cast<double>(std::max(-factors[i], 0.0f));
      seen += factors[i] > 0.0f;
    }
    entries += seen;
    result.fronts.push_back(static_cast<float>(std::accumulate(fronts, fronts + 8, 0.0)));
    result.backs.push_back(static_cast<float>(std::accumulate(backs, backs + 8, 0.0)));
  }
  for (const glm::uvec2& exact : drawn.exact) drawn.factors[exact.x] = std::bit_cast<float>(exact.y);
  result.patches.resize(entries + drawn.exact.size() + 1);
  result.factors.resize(result.patches.size());
  std::size_t at = 0;
  for (std::size_t row = 0; row < rowCount; ++row) {
    const float* factors = drawn.factors.data() + row * patches;
    const std::size_t before = at;
    for (std::size_t i = 0; i < patches; ++i) {  // overwritten by the next entry if empty: avoids a mispredicted branch
      result.patches[at] = static_cast<std::uint32_t>(i);
      result.factors[at] = factors[i];
      at += factors[i] > 0.0f;
    }
    result.counts.push_back(static_cast<std::uint32_t>(at - before));
  }
  result.patches.resize(at);
  result.factors.resize(at);
  return result;
}

FormFactorRows meanRowsOf(std::vector<DrawnHemicubes> drawn) {
  if (drawn.size() == 1) return rowsOf(std::move(drawn.front()));
  std::vector<FormFactorRows> rolls;
  for (DrawnHemicubes& one : drawn) rolls.push_back(rowsOf(std::move(one)));
  const double share = 1.0 / static_cast<double>(rolls.size());
  std::vector<std::size_t> at(rolls.size(), 0);
  FormFactorRows mean;
  mean.first = rolls.front().first;
  for (std::size_t row = 0; row < rolls.front().counts.size(); ++row) {
    std::map<std::uint32_t, double> factors;  // by patch
    double fronts = 0.0, backs = 0.0;
    for (std::size_t r = 0; r < rolls.size(); ++r) {
      for (const std::size_t end = at[r] + rolls[r].counts[row]; at[r] < end; ++at[r])
        factors[rolls[r].patches[at[r]]] += share * static_cast<double>(rolls[r].factors[at[r]]);
      fronts += share * static_cast<double>(rolls[r].fronts[row]);
      backs += share * static_cast<double>(rolls[r].backs[row]);
    }
    for (const auto& [patch, factor] : factors) {
      mean.patches.push_back(patch);
      mean.factors.push_back(static_cast<float>(factor));
    }
    mean.counts.push_back(static_cast<std::uint32_t>(factors.size()));
    mean.fronts.push_back(static_cast<float>(fronts));
    mean.backs.push_back(static_cast<float>(backs));
  }
  return mean;
}

}  // namespace lucerna
