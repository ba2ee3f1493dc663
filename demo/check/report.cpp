#include "check/report.hpp"

#include "base/named_values.hpp"
#include "base/provenance.hpp"

#include <fmt/core.h>

#include <sys/utsname.h>
#include <gnu/libc-version.h>

#include <algorithm>
#include <map>
#include <set>

namespace lucerna::demo::check {

namespace {

std::string systemName() {
  utsname name{};
  ::uname(&name);
  return fmt::format("{} {} {}, glibc {}", name.sysname, name.release, name.machine, gnu_get_libc_version());
}

/// A figure of the part context; empty if that part did not end.
std::string identity(const std::vector<Row>& rows, const char* key) {
  for (const Row& row : rows)
    if (row.part == "context" && row.figures.contains(key)) return row.figures.at(key).get<std::string>();
  return "unknown";
}

/// All programs of all techniques, each once.
std::string programsLine(const std::vector<const Row*>& rows) {
  std::map<std::string, double> seconds;
  for (const Row* row : rows)
    for (const auto& program : row->figures.value("programs", nlohmann::ordered_json::array())) {
      double& longest = seconds[program.at("name").get<std::string>()];
      longest = std::max(longest, program.at("seconds").get<double>());
    }
  double all = 0.0;
  std::pair<std::string, double> slowest;
  int slow = 0;
  for (const auto& program : seconds) {
    all += program.second;
    slow += program.second > 3.0;
    if (program.second > slowest.second) slowest = program;
  }
  return fmt::format("{} programs in {:.1f} s, {} of them over 3 s; slowest {}, {:.2f} s", seconds.size(), all, slow,
                     slowest.first, slowest.second);
}

std::string line(std::string_view status, std::string_view name, std::string_view text) {
  std::string whole = fmt::format("  {:<8} {:<28} {}", status, name, text);
  if (whole.size() > 180) whole = whole.substr(0, 177) + "...";
  return whole + "\n";
}

}  // namespace

nlohmann::ordered_json toJson(const Row& row) {
  return {{"part", row.part}, {"name", row.name},       {"status", nameOf(row.status)},
          {"text", row.text}, {"seconds", row.seconds}, {"figures", row.figures}};
}

Row rowOf(const nlohmann::ordered_json& json) {
  return {json.at("part").get<std::string>(),
          json.at("name").get<std::string>(),
          parseName<Status>(json.at("status").get<std::string>(), "status"),
          json.at("text").get<std::string>(),
          json.at("seconds").get<double>(),
          json.at("figures")};
}

int Report::faults() const {
  return static_cast<int>(std::ranges::count_if(rows, [](const Row& row) { return isFault(row.status); }));
}

nlohmann::ordered_json Report::json() const {
  nlohmann::ordered_json json{{"program", programVersion()}, {"command", command},
                              {"system", systemName()},      {"cpu", cpuName()},
                              {"seconds", seconds},          {"verdict", faults() == 0 ? "right" : "wrong"},
                              {"faults", faults()}};
  for (const char* key : {"renderer", "vendor", "opengl", "host"}) json[key] = identity(rows, key);
  for (const Row& row : rows) json["rows"].push_back(toJson(row));
  return json;
}

std::string Report::page() const {
  std::string text = fmt::format("lucerna {}\nrenderer  {}\nOpenGL    {}\nhost      {}\nsystem    {}\nCPU       {}\n",
                                 programVersion(), identity(rows, "renderer"), identity(rows, "opengl"),
                                 identity(rows, "host"), systemName(), cpuName());
  const auto ran = static_cast<std::size_t>(
      std::ranges::count_if(rows, [](const Row& row) { return row.status != Status::notRun; }));
  text += fmt::format("command   {}, {:.0f} s\nverdict   {}\n", command, seconds,
                      faults() == 0 ? fmt::format("{}; {} of {} units ran",
                                                  ran == rows.size() ? "all right" : "nothing wrong in those that ran",
                                                  ran, rows.size())
                                    : fmt::format("{} of {} units are wrong or failed", faults(), rows.size()));
  std::vector<std::string> parts;
  for (const Row& row : rows)
    if (std::ranges::find(parts, row.part) == parts.end()) parts.push_back(row.part);
  for (const std::string& part : parts) {
    std::vector<const Row*> ofPart;
    for (const Row& row : rows)
      if (row.part == part) ofPart.push_back(&row);
    text += "\n" + part + "\n";
    if (part == "programs") text += line("", "all", programsLine(ofPart));
    std::string skipped;
    for (const Row* row : ofPart) {
      const bool condensed = part == "programs" && row->status == Status::right;
      if (row->status == Status::notRun) skipped += (skipped.empty() ? "" : ", ") + row->name;
      else if (!condensed) text += line(nameOf(row->status), row->name, row->text);
    }
    if (!skipped.empty()) text += line("not run", skipped, "");
  }
  return text;
}

}  // namespace lucerna::demo::check
