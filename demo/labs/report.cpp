// The hand-in as one page: answers, checks, pictures with sliders, plots, time per task.
#include "base/files.hpp"
#include "bench/html.hpp"
#include "labs/hand_in.hpp"

#include <fmt/format.h>

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
  .notdone, .waiting { color: #6b6b70; }
pre { background: #f5f5f7; padding: .8em; white-space: pre-wrap; overflow-wrap: anywhere;
  font-size: 12.5px; }
.wipe { position: relative; width: 576px; image-rendering: pixelated; } .wipe img { width: 576px; display: block; }
  .wipe .top { position: absolute; top: 0; left: 0; clip-path: inset(0 50% 0 0); }
.wipe + input { width: 576px; } figure { margin: 1em 0; } figcaption { color: #555; }
  svg text { font: 12px system-ui, sans-serif; }
)";

std::string base64Png(const Image& image, float exposure) {
  // Through a file: DevIL writes files alone.
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("lucerna-lab-{:x}.png", reinterpret_cast<std::uintptr_t>(&image));
  writePng(file, toneMapped(image, exposure));
  const std::string text = bench::base64(readFileBytes(file));
  std::filesystem::remove(file);
  return text;
}

/// A log-log plot as SVG; points that are not above zero have no place on it.
std::string plot(const Curve& curve) {
  constexpr double kWidth = 576.0, kHeight = 320.0, kLeft = 70.0, kBottom = 45.0, kTop = 15.0, kRight = 15.0;
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
  draw(curve.reference, "stroke=\"#999\" stroke-dasharray=\"5 4\" stroke-width=\"2\"");
  draw(curve.mine, "stroke=\"#1457b3\" stroke-width=\"2\"");
  svg += fmt::format(
      "<text x=\"{}\" y=\"{}\" text-anchor=\"start\">{:.3g}</text><text x=\"{}\" y=\"{}\" "
      "text-anchor=\"end\">{:.3g}</text>",
      kLeft, kHeight - kBottom + 16, std::exp(least.x), kWidth - kRight, kHeight - kBottom + 16, std::exp(most.x));
  svg += fmt::format(
      "<text x=\"{0}\" y=\"{1}\" text-anchor=\"end\">{2:.2g}</text><text x=\"{0}\" y=\"{3}\" "
      "text-anchor=\"end\">{4:.2g}</text>",
      kLeft - 6, kHeight - kBottom, std::exp(least.y), kTop + 12, std::exp(most.y));
  return svg + fmt::format(
                   "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text></svg><div>{}: blue yours, dashed the "
                   "theory</div>",
                   0.5 * kWidth, kHeight - 8, escapeHtml(curve.xLabel), escapeHtml(curve.yLabel));
}

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

  // Tasks: verdict, hints, and when a check first found it right.
  body +=
      "<h2>Tasks</h2><table><tr><th>task</th><th>verdict</th><th>points</th><th>hints taken</th><th>first right "
      "after</th></tr>\n";
  double previous = started;
  for (const Task& task : lab.tasks) {
    const Verdict verdict = report.verdictOf(task.number);
    int hints = 0;
    double first = 0.0;
    for (const auto& hint : folder.state["hints"])
      hints = std::max(hints, hint.value("task", 0) == task.number ? hint.value("level", 0) : 0);
    for (const auto& check : folder.state["checks"]) {
      const auto passed = check.value("passed", std::vector<int>{});
      if (first == 0.0 && std::find(passed.begin(), passed.end(), task.number) != passed.end())
        first = check.value("time", 0.0);
    }
    body += fmt::format(
        "<tr><td>{}. {}</td><td class=\"{}\">{}</td><td class=\"n\">{} of {}</td><td "
        "class=\"n\">{}</td><td>{}</td></tr>\n",
        task.number, escapeHtml(task.function), verdict == Verdict::notDone ? "notdone" : nameOf(verdict),
        nameOf(verdict), verdict == Verdict::passed ? task.points : 0, task.points, hints,
        first == 0.0 ? ""
                     : fmt::format("{} ({} after the task before)", duration(first - started),
                                   duration(std::max(0.0, first - previous))));
    if (first != 0.0) previous = first;
  }
  body += "</table>\n";

  if (!report.yours.empty()) body += "<h2>Parameters of the seed</h2><p>";
  for (const auto& [name, value] : report.yours) body += fmt::format("{} <b>{}</b>; ", escapeHtml(name), value);
  if (!report.yours.empty()) body += "</p>\n";
  const auto answers = folder.path / "answers.txt";
  if (std::filesystem::exists(answers))
    body += "<h2>Answers</h2><pre>" + escapeHtml(readFileText(answers)) + "</pre>\n";

  body +=
      "<h2>Checks</h2><table><tr><th>task</th><th>check</th><th>verdict</th><th>expected</th><th>measured</th><th></"
      "th></tr>\n";
  for (const CheckResult& c : report.checks)
    body += fmt::format("<tr><td>{}</td><td>{}</td><td class=\"{}\">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        c.task == 0 ? "" : std::to_string(c.task), escapeHtml(c.name),
                        c.verdict == Verdict::notDone ? "notdone" : nameOf(c.verdict), nameOf(c.verdict),
                        escapeHtml(c.task == 0 ? "" : c.expected), escapeHtml(c.measured),
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

  if (!report.curves.empty()) body += "<h2>Plots</h2>\n";
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
