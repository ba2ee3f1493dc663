// Compares a stored table of bench stability with a new one (no GL).
#include "bench/stability.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"

#include <cmath>
#include <map>

namespace lucerna::demo::bench {

nlohmann::ordered_json readKept(const std::string& file) {
  const auto json = parseJson<nlohmann::ordered_json>(readFileText(file), "--compare " + file);
  if (!json.is_object() || !json.contains("rows"))
    throwBadInput("--compare {}: no table of bench stability --json", file);
  return json.at("rows");
}

std::vector<std::string> worseRows(const nlohmann::ordered_json& now, const nlohmann::ordered_json& kept,
                                   const std::string& technique, const std::string& file) {
  std::vector<std::string> worse;
  try {
    const auto key = [](const nlohmann::ordered_json& row) {
      return fmt::format("{}: {}, {}", row.at("technique").get<std::string>(), row.at("case").get<std::string>(),
                         row.at("parameter").get<std::string>());
    };
    std::map<std::string, const nlohmann::ordered_json*> rows;
    for (const auto& row : now) rows.emplace(key(row), &row);
    if (!kept.is_array())
      throwBadInput("--compare {}: not a table of bench stability --json: \"rows\" is not an array", file);
    for (const auto& before : kept) {
      const std::string name = key(before);
      if (!technique.empty() && before.at("technique") != technique) continue;
      const auto found = rows.find(name);
      if (found == rows.end()) {
        worse.push_back(name + ": gone");
        continue;
      }
      const auto& row = *found->second;
      if (before.at("verdict") == "pass" && row.at("verdict") != "pass")
        worse.push_back(
            fmt::format("{}: measured {}, was {}", name, row.at("measured").dump(), before.at("measured").dump()));
      if (before.at("rule") != row.at("rule"))
        worse.push_back(
            fmt::format("{}: the rule is {}, was {}", name, row.at("rule").dump(), before.at("rule").dump()));
      // Statistical rows allow multiples of their own standard error, which differs slightly between processors.
      const double allowed = row.at("tolerance"), allowedBefore = before.at("tolerance");
      if (!(allowed <= 1.05 * allowedBefore))
        worse.push_back(fmt::format("{}: allows {}, was {}", name, allowed, allowedBefore));
      const double expected = row.at("expected"), expectedBefore = before.at("expected");
      if (!(std::abs(expected - expectedBefore) <= 1e-9 * std::abs(expectedBefore)))
        worse.push_back(fmt::format("{}: expects {}, was {}", name, expected, expectedBefore));
    }
  } catch (const nlohmann::json::exception& error) {
    throwBadInput("--compare {}: no table of bench stability --json ({})", file, error.what());
  }
  return worse;
}

}  // namespace lucerna::demo::bench
