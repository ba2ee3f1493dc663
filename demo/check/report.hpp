// The report of lucerna check: rows, one per unit, as JSON and as a page of text.
#pragma once

#include <nlohmann/json.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna::demo::check {

/// How a unit ended. `slow`: it was still making progress at its limit.
enum class Status { right, wrong, failed, reset, crashed, hung, slow, notRun };
constexpr std::array<std::string_view, 8> namesOf(Status) {
  return {"right", "wrong", "failed", "reset", "crashed", "hung", "slow", "not run"};
}
/// Whether the verdict is that something is wrong.
constexpr bool isFault(Status status) {
  return status != Status::right && status != Status::slow && status != Status::notRun;
}

struct Row {
  std::string part, name;
  Status status = Status::notRun;
  std::string text;  ///< a line
  double seconds = 0.0;
  nlohmann::ordered_json figures = nlohmann::ordered_json::object();

  std::string key() const { return part + "/" + name; }
};

nlohmann::ordered_json toJson(const Row& row);
Row rowOf(const nlohmann::ordered_json& json);

struct Report {
  std::vector<Row> rows;
  std::string command;
  double seconds = 0.0;

  int faults() const;
  nlohmann::ordered_json json() const;
  /// For a bug report: identity, verdict, a line a row; parts whose rows are all right are condensed.
  std::string page() const;
};

}  // namespace lucerna::demo::check
