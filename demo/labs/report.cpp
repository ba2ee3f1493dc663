// The hand-in as one page: answers, checks, pictures with sliders, plots, time per task.
#include "base/files.hpp"
#include "shared/html.hpp"
#include "labs/hand_in.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo::labs {

namespace {

using bench::escapeHtml;

constexpr std::string_view kStyle = R"(
body { font: 15px/1.5 system-ui, sans-serif; color: #1c1c1e; max-width: 1000px; margin: 2em auto; padding: 0 1.5em; }
h2 { margin-top: 2em; border-bottom: 2px solid #ddd; } table { border-collapse: collapse; }
  th, td { padding: .25em .8em .25em 0; text-align: left; border-bottom: 1px solid #e4e4e8; vertical-align: top; }
td.n { text-align: right; font-variant-numeric: tabular-nums; } .passed { color: #14732b; } .wrong { color: #b3261e; }
  .notdone, .waiting { color: #6b6b70; white-space: nowrap; }
pre { background: #f5f5f7; padding: .8em; white-space: pre-wrap; overflow-wrap: anywhere;
  font-size: 12.5px; }
.wipe { position: relative; width: 576px; image-rendering: pixelated; } .wipe img { width: 576px; display: block; }
  .wipe .top { position: absolute; top: 0; left: 0; clip-path: inset(0 50% 0 0); }
.wipe + input { width: 576px; } figure { margin: 1em 0; } figcaption { color: #555; }
  svg text { font: 12px system-ui, sans-serif; }
)";

std::string base64Png(const Image& image, float exposure) {
  // Through a file: DevIL can only write files.
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("lucerna-lab-{:x}.png", reinterpret_cast<std::uintptr_t>(&image));
  writePng(file, toneMapped(image, exposure));
  const std::string text = bench::base64(readFileBytes(file));
  std::filesystem::remove(file);
  return text;
}

/// Ticks of a logarithmic axis: 1, 2 and 5 of each decade, or only decades; both ends if that gives no scale.
std::vector<double> ticks(double least, double most) {
  const double decades = (most - least) / std::log(10.0);
  const int step = std::max(1, static_cast<int>(std::ceil(decades / 8.0)));
  std::vector<double> values;
  for (int k = static_cast<int>(std::floor(least / std::log(10.0))); k <= most / std::log(10.0); k += step)
    for (const double digit : {1.0, 2.0, 5.0})
      if (const double value = digit * std::pow(10.0, k), at = std::log(value);
          (digit == 1.0 || decades < 2.5) && at > least - 1e-9 && at < most + 1e-9)
        values.push_back(value);
  return values.size() < 2 ? std::vector{std::exp(least), std::exp(most)} : values;
}

/// A log-log plot as SVG; points that are not positive are left out.
std::string plot(const Curve& curve) {
  constexpr double kWidth = 576.0, kHeight = 320.0, kLeft = 80.0, kBottom = 45.0, kTop = 15.0, kRight = 15.0;
  glm::dvec2 least(1e300), most(-1e300);
  for (const auto* points : {&curve.mine, &curve.reference})
    for (const glm::dvec2& p : *points)
      if (p.x > 0.0 && p.y > 0.0) least = glm::min(least, glm::log(p)), most = glm::max(most, glm::log(p));
  if (!(least.x < most.x)) return "";
  if (most.y - least.y < 0.1) least.y -= 0.5, most.y += 0.5;
  const auto place = [&](const glm::dvec2& p) {
    const glm::dvec2 t = (glm::log(p) - least) / (most - least);
    return glm::dvec2(kLeft + t.x * (kWidth - kLeft - kRight), kHeight - kBottom - t.y * (kHeight - kBottom - kTop));
  };
  std::string svg = fmt::format(
      "<svg role=\"img\" aria-label=\"{}\" width=\"{}\" height=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" "
      "height=\"{}\" fill=\"none\" stroke=\"#999\"/>",
      escapeHtml(curve.name), kWidth, kHeight, kLeft, kTop, kWidth - kLeft - kRight, kHeight - kBottom - kTop);
  const auto draw = [&](const std::vector<glm::dvec2>& points, const char* style) {
    std::string line;
    for (const glm::dvec2& p : points)
      if (p.x > 0.0 && p.y > 0.0) line += fmt::format("{:.1f},{:.1f} ", place(p).x, place(p).y);
    svg += fmt::format("<polyline fill=\"none\" {} points=\"{}\"/>", style, line);
  };
  for (const double x : ticks(least.x, most.x)) {
    const double at = place({x, std::exp(least.y)}).x;
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\" stroke=\"#e4e4e8\"/><text x=\"{0:.1f}\" "
        "y=\"{3}\" text-anchor=\"middle\">{4:.3g}</text>",
        at, kTop, kHeight - kBottom, kHeight - kBottom + 16, x);
  }
  for (const double y : ticks(least.y, most.y)) {
    const double at = place({std::exp(least.x), y}).y;
    svg += fmt::format(
        "<line x1=\"{0}\" y1=\"{1:.1f}\" x2=\"{2}\" y2=\"{1:.1f}\" stroke=\"#e4e4e8\"/><text x=\"{3}\" "
        "y=\"{4:.1f}\" text-anchor=\"end\">{5:.3g}</text>",
        kLeft, at, kWidth - kRight, kLeft - 6, at + 4, y);
  }
  draw(curve.reference, "stroke=\"#777\" stroke-dasharray=\"5 4\" stroke-width=\"2\"");
  draw(curve.mine, "stroke=\"#1457b3\" stroke-width=\"2\"");
  svg += fmt::format(
      "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text><text transform=\"translate(14 {}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text></svg>",
      0.5 * (kLeft + kWidth - kRight), kHeight - 8, escapeHtml(curve.xLabel), 0.5 * (kTop + kHeight - kBottom),
      escapeHtml(curve.yLabel));
  return svg;
}

std::string classOf(Verdict verdict) { return verdict == Verdict::notDone ? "notdone" : nameOf(verdict); }

std::string duration(double seconds) {
  return seconds < 90     ? fmt::format("{:.0f} s", seconds)
         : seconds < 5400 ? fmt::format("{:.0f} min", seconds / 60)
                          : fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

std::string reportHtml(const Lab& lab, const Folder& folder, const Report& report) {
  const double started = folder.state.at("started").get<double>();
  std::string body =
      fmt::format("<h1>Lab {}: {}</h1>\n<p>Seed <b>{}</b>, {:.1f} of 100 points, {} (nonce {})</p>\n", lab.number,
                  escapeHtml(lab.title), escapeHtml(report.seed), report.compileError.empty() ? report.score(lab) : 0.0,
                  escapeHtml(report.renderer), report.nonce);
  if (folder.state.contains("solution_taken"))
    body += "<p class=\"wrong\">The sample solution was put into this hand-in.</p>\n";
  if (!report.compileError.empty()) body += "<pre class=\"wrong\">" + escapeHtml(report.compileError) + "</pre>\n";

  // Tasks: verdict, hints, and the time of the first check that found it right.
  body +=
      "<h2>Tasks</h2><table><tr><th>task</th><th>verdict</th><th>points</th><th>hints taken</th><th>first right "
      "after</th><th>time for it</th></tr>\n";
  const auto firstRight = [&](int task) {
    for (const auto& check : folder.state["checks"]) {
      const auto passed = check.value("passed", std::vector<int>{});
      if (std::find(passed.begin(), passed.end(), task) != passed.end()) return check.value("time", 0.0);
    }
    return 0.0;
  };
  for (const Task& task : lab.tasks) {
    const Verdict verdict = report.verdictOf(task.number);
    int hints = 0;
    for (const auto& hint : folder.state["hints"])
      hints = std::max(hints, hint.value("task", 0) == task.number ? hint.value("level", 0) : 0);
    // Time since the start, or since the previous task was right.
    const double first = firstRight(task.number);
    double before = started;
    for (const Task& other : lab.tasks)
      if (const double time = firstRight(other.number); time < first) before = std::max(before, time);
    body += fmt::format(
        "<tr><td>{}. {}</td><td class=\"{}\">{}</td><td class=\"n\">{} of {}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        task.number, escapeHtml(task.function), classOf(verdict), nameOf(verdict),
        verdict == Verdict::passed ? task.points : 0, task.points, hints, first == 0.0 ? "" : duration(first - started),
        first == 0.0 ? "" : duration(first - before));
  }
  if (lab.answerPoints > 0) {
    Lab questions = lab;
    questions.tasks.clear();
    body +=
        fmt::format("<tr><td>questions</td><td></td><td class=\"n\">{:g} of {}</td><td></td><td></td><td></td></tr>\n",
                    report.score(questions), lab.answerPoints);
  }
  body += "</table>\n";

  std::vector<std::string> yours;
  for (const auto& [name, value] : report.yours) yours.push_back(fmt::format("{} <b>{}</b>", escapeHtml(name), value));
  if (!yours.empty()) body += fmt::format("<h2>Parameters of the seed</h2><p>{}</p>\n", fmt::join(yours, ", "));
  const auto answers = folder.path / "answers.txt";
  if (std::filesystem::exists(answers))
    body += "<h2>Answers</h2><pre>" + escapeHtml(readFileText(answers)) + "</pre>\n";

  body +=
      "<h2>Checks</h2><table><tr><th>task</th><th>check</th><th>verdict</th><th>expected</th><th>measured</th><th>how "
      "far off</th></tr>\n";
  // By task; the questions come last.
  std::vector<CheckResult> checks = report.checks;
  std::stable_sort(checks.begin(), checks.end(), [](const CheckResult& a, const CheckResult& b) {
    return (a.task == 0 ? 1000 : a.task) < (b.task == 0 ? 1000 : b.task);
  });
  for (const CheckResult& c : checks)
    body += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"{}\">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        c.task == 0 ? "" : std::to_string(c.task), escapeHtml(c.name), classOf(c.verdict),
                        nameOf(c.verdict), escapeHtml(c.task == 0 ? "" : c.expected), escapeHtml(c.measured),
                        escapeHtml(c.verdict == Verdict::passed ? c.sigma
                                   : c.sigma.empty()            ? c.mistake.text
                                                                : c.sigma + "; " + c.mistake.text));
  body += "</table>\n";

  if (!report.pictures.empty())
    body += "<h2>Pictures</h2><p>Move the slider: yours to the left, the reference to the right.</p>\n";
  for (const PictureResult& p : report.pictures)
    body += fmt::format(
        "<figure><div class=\"wipe\"><img alt=\"reference\" src=\"data:image/png;base64,{}\"><img class=\"top\" "
        "alt=\"yours\" src=\"data:image/png;base64,{}\"></div>"
        "<input type=\"range\" aria-label=\"yours or the reference\" min=\"0\" max=\"100\" value=\"50\" "
        "oninput=\"this.previousElementSibling.lastElementChild.style.clipPath='inset(0 '+(100-this.value)+'% 0 0)'\">"
        "<figcaption>{}</figcaption></figure>\n",
        base64Png(p.reference, p.exposure), base64Png(p.mine, p.exposure), escapeHtml(p.caption));

  if (!report.curves.empty())
    body += "<h2>Plots</h2><p>Blue: yours; dashed: the theory. Both axes are logarithmic.</p>\n";
  for (const Curve& curve : report.curves)
    body += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", plot(curve), escapeHtml(curve.name));

  const auto tasks = folder.path / "tasks.glsl";
  if (std::filesystem::exists(tasks)) body += "<h2>tasks.glsl</h2><pre>" + escapeHtml(readFileText(tasks)) + "</pre>\n";
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Lab {}, "
      "{}</title><style>{}</style></head>\n<body>{}</body></html>\n",
      lab.number, escapeHtml(report.seed), kStyle, body);
}

}  // namespace lucerna::demo::labs
