// A check's result for the terminal, as JSON, as JUnit XML and for Gradescope.
#include "shared/html.hpp"
#include "labs/hand_in.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna::demo::labs {

using Json = nlohmann::ordered_json;

namespace {

std::string lineOf(const CheckResult& check) {
  if (check.verdict == Verdict::notDone || check.verdict == Verdict::waiting)
    return fmt::format("    {:<8}  {}\n", nameOf(check.verdict), check.mistake.text);
  std::string line = fmt::format("    {:<8}  {}", nameOf(check.verdict), check.name);
  if (check.verdict == Verdict::passed)
    return check.expected.empty() ? line + fmt::format(" ({})\n", check.sigma)
                                  : line + fmt::format("\n              expected {}, measured {} ({})\n",
                                                       check.expected, check.measured, check.sigma);
  if (!check.expected.empty())
    line += fmt::format("\n              expected {}\n              measured {}", check.expected, check.measured);
  line += fmt::format("\n              {}\n", check.sigma);
  return line + fmt::format("              likeliest: {}\n", check.mistake.text);
}

struct Item {
  std::string title;
  int number, points;
};
/// Tasks, then the questions.
std::vector<Item> itemsOf(const Lab& lab) {
  std::vector<Item> items;
  for (const Task& task : lab.tasks)
    items.push_back({fmt::format("task {} {}", task.number, task.function), task.number, task.points});
  if (lab.answerPoints > 0) items.push_back({"questions", 0, lab.answerPoints});
  return items;
}
double earned(const Lab& lab, const Report& report, const Item& item) {
  Lab one = lab;
  one.answerPoints = item.number == 0 ? item.points : 0;
  std::erase_if(one.tasks, [&](const Task& t) { return t.number != item.number; });
  return report.compileError.empty() ? report.score(one) : 0.0;
}
std::string textOf(const Report& report, int task) {
  std::string text;
  for (const CheckResult& check : report.checks)
    if (check.task == task) text += lineOf(check);
  return text;
}

}  // namespace

std::string reportText(const Lab& lab, const Report& report) {
  std::string text = fmt::format("Lab {}: {}\nseed {}, {}, {:.1f} s, nonce {}\n", lab.number, lab.title, report.seed,
                                 report.renderer, report.seconds, report.nonce);
  for (const auto& [name, value] : report.yours)
    text += fmt::format("{}{} {}", &name == &report.yours.front().first ? "yours: " : ", ", name, value);
  if (!report.yours.empty()) text += "\n";
  if (!report.compileError.empty())
    return text + report.compileError + "\nNothing can be judged before that compiles.\n";
  for (const Item& item : itemsOf(lab))
    text += fmt::format("{:<44} {:>5.1f} of {}\n{}", item.title, earned(lab, report, item), item.points,
                        textOf(report, item.number));
  return text + fmt::format("{:<44} {:>5.1f} of 100\n", "together", report.score(lab));
}

Json reportJson(const Lab& lab, const Report& report) {
  Json json{{"lab", lab.number},
            {"title", lab.title},
            {"seed", report.seed},
            {"nonce", report.nonce},
            {"renderer", report.renderer},
            {"seconds", report.seconds},
            {"score", report.compileError.empty() ? report.score(lab) : 0.0},
            {"compile_error", report.compileError},
            {"checks", Json::array()}};
  for (const CheckResult& c : report.checks) {
    Json check{{"task", c.task},         {"name", c.name},         {"verdict", nameOf(c.verdict)},
               {"expected", c.expected}, {"measured", c.measured}, {"sigma", c.sigma}};
    if (c.pValue >= 0.0) check["p"] = c.pValue;
    if (c.verdict != Verdict::passed) check["mistake"] = c.mistake.id, check["hint"] = c.mistake.text;
    json["checks"].push_back(std::move(check));
  }
  return json;
}

std::string reportJunit(const Lab& lab, const Report& report) {
  using bench::escapeHtml;
  std::string cases;
  int failures = 0;
  if (!report.compileError.empty()) {
    ++failures;
    cases += fmt::format(
        "  <testcase classname=\"lab{}\" name=\"compiles\"><failure message=\"does not "
        "compile\">{}</failure></testcase>\n",
        lab.number, escapeHtml(report.compileError));
  }
  for (const CheckResult& c : report.checks) {
    cases += fmt::format("  <testcase classname=\"lab{}.task{}\" name=\"{}\">", lab.number, c.task, escapeHtml(c.name));
    if (c.verdict != Verdict::passed) {
      ++failures;
      cases += fmt::format("<failure message=\"{}\">{}</failure>", escapeHtml(c.mistake.text), escapeHtml(lineOf(c)));
    }
    cases += "</testcase>\n";
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"lab {}\" tests=\"{}\" failures=\"{}\" "
      "time=\"{:.2f}\">\n{}</testsuite>\n",
      lab.number, report.checks.size() + (report.compileError.empty() ? 0 : 1), failures, report.seconds, cases);
}

std::string reportGradescope(const Lab& lab, const Report& report) {
  // results.json as Gradescope's autograder reads it: score, tests with score, max_score, status, output.
  Json json{{"score", report.compileError.empty() ? report.score(lab) : 0.0},
            {"execution_time", report.seconds},
            {"output", report.compileError},
            {"visibility", "visible"},
            {"tests", Json::array()}};
  for (const Item& item : itemsOf(lab)) {
    const double points = earned(lab, report, item);
    json["tests"].push_back({{"name", item.title},
                             {"score", points},
                             {"max_score", item.points},
                             {"status", points == item.points ? "passed" : "failed"},
                             {"output", textOf(report, item.number)}});
  }
  return json.dump(2) + "\n";
}

}  // namespace lucerna::demo::labs
