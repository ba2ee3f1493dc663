#include "bench/frame_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>
#include <sstream>

namespace lucerna::demo::bench {

namespace {

/// Lines of at most 120 columns.
std::string wrapped(const std::string& text, const std::string& first, const std::string& indent) {
  std::string result, line = first;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > 120) {
      result += line + "\n";
      line = indent;
    }
    line += (line.empty() || line.back() == ' ' ? "" : " ") + word;
  }
  return result + line + "\n";
}

std::string paragraph(const std::string& text) { return wrapped(text, "", "") + "\n"; }
std::string item(const std::string& text) { return wrapped(text, "- ", "  "); }

std::string percent(double error) { return fmt::format("{:.1f} %", 100.0 * error); }
std::string number(double ms) { return ms < 10.0 ? fmt::format("{:.2f}", ms) : fmt::format("{:.0f}", ms); }
std::string times(const MeasuredPass& p) {
  return fmt::format("{} ({} to {})", number(p.ms), number(p.low), number(p.high));
}

/// With what is missing then.
std::string withoutIt(const MeasuredPass& p) {
  const auto missing = [&]() -> std::string {
    switch (p.pass->gives) {
      case Pass::Gives::sunShadows: return "no shadows of the sun";
      case Pass::Gives::lampShadows: return "no shadows of lamps";
      case Pass::Gives::surfaces: return "no surfaces";
      case Pass::Gives::indirect: return "no indirect light";
      case Pass::Gives::environment: return "no environment";
      case Pass::Gives::shafts: return "no light shafts";
      case Pass::Gives::display: return "the same";
    }
    return "?";
  };
  if (!p.without) return "not measured";
  return fmt::format("{} ({})", percent(*p.without),
                     p.pass->without.empty() ? missing() : fmt::format("`{}`", p.pass->without));
}

std::vector<LightStep> stepsOf(const MeasuredFrame& frame, const Pass& pass) {
  std::vector<LightStep> steps;
  for (const LightStep& step : frame.steps)
    if (step.pass == pass.name) steps.push_back(step);
  return steps;
}

std::string capital(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

/// All passes with times and errors; below a pass, the light that it adds.
std::string table(const MeasuredFrame& frame) {
  std::string text =
      "| pass | ms | in a still view | error of the picture after it | removes | finished picture without it |\n"
      "|---|---|---|---|---|---|\n";
  double error = 1.0, sum = 0.0, still = 0.0;
  for (const MeasuredPass& p : frame.passes) {
    const std::vector<LightStep> steps = stepsOf(frame, *p.pass);
    const double after = steps.empty() ? error : steps.back().error;
    sum += p.ms;
    still += p.runsStill ? p.ms : 0.0;
    text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", p.pass->title, times(p), p.runsStill ? "runs" : "reused",
                        percent(after), steps.empty() ? "" : percent(error - after), withoutIt(p));
    if (steps.size() > 1)
      for (const LightStep& step : steps) {
        text +=
            fmt::format("| ... {} | | | {} | {} | |\n", step.name, percent(step.error), percent(error - step.error));
        error = step.error;
      }
    error = after;
  }
  return text +
         fmt::format("| **frame** | **{}** | **{}** | **{}** | | |\n\n", number(sum), number(still), percent(error));
}

std::string picture(const std::string& title, const std::string& folder, const std::string& file) {
  return fmt::format("![{}]({}/{})\n\n", title, folder, file);
}

/// A pass in its own section: what it does, its time and its sources, its result, and the picture with its light.
std::string section(const MeasuredPass& p, const MeasuredFrame& frame, std::size_t place, double before,
                    const std::string& folder, std::set<std::string>& shown) {
  const std::vector<LightStep> steps = stepsOf(frame, *p.pass);
  std::string text = fmt::format("### {}. {}\n", place, p.pass->title) + paragraph(std::string(p.pass->does));
  text += "| ms | error before | after | finished picture without it | sources |\n|---|---|---|---|---|\n";
  std::string sources;
  for (const std::string_view source : p.pass->sources)
    sources += fmt::format("{}`{}`", sources.empty() ? "" : ", ", source);
  text += fmt::format("| {} | {} | {} | {} | {} |\n\n", times(p), percent(before),
                      percent(steps.empty() ? before : steps.back().error), withoutIt(p), sources);
  for (const std::string& file : p.pictures) text += picture(std::string(p.pass->title), folder, file);
  for (const LightStep& step : steps) {
    const std::string line =
        fmt::format("{}: from {} to {}.", capital(step.name), percent(before), percent(step.error));
    before = step.error;
    // Techniques differ in indirect light alone.
    if (shown.insert(step.name == "indirect light" ? frame.label : line).second)
      text += paragraph(line) + picture(capital(step.name), folder, step.picture);
  }
  return text;
}

}  // namespace

std::string frameMarkdown(const FramePage& page, const std::string& folder) {
  std::string text = "# A frame, pass by pass\n\n```\n" + page.command + "\n```\n" +
                     paragraph(fmt::format(
                         "makes this page; `docs/frame/make` runs it for docs/frame.md, turns its pictures into JPEG "
                         "and links its sources. Scene {}, {}. Renderer {}, on {}: times are of that renderer.",
                         page.scene, page.view, page.renderer, page.cpu));
  text += item(fmt::format(
      "**ms**: median time of the pass, with the 5th and 95th percentile, over the first {} frames of a view; every "
      "pass runs in each (`frame.reuse=off`).",
      page.timedFrames));
  text += item("**in a still view**: whether the pass runs again when nothing changes, with `frame.reuse=on`.");
  text += item(fmt::format(
      "**error**: relative L2 distance of the linear picture from a path traced reference of all light, {} samples per "
      "pixel. A black picture has 100 %. The reference's own noise, {}, is subtracted in squares. Surfaces are "
      "Lambertian, as in the reference: highlights are left out. Pictures are finished: a cache has all its paths, "
      "which "
      "it traces over many frames.",
      page.samples, percent(page.noise)));
  text +=
      item(
          "**finished picture without it**: its error if the pass, or the light that needs the pass, is left out. This "
          "measures passes that prepare for others and change no pixel themselves.") +
      "\n";
  std::set<std::string_view> described;
  std::set<std::string> shown;
  for (const MeasuredFrame& frame : page.frames) {
    text += fmt::format("## {}\n", frame.label) + table(frame);
    double before = 1.0;
    for (std::size_t i = 0; i < frame.passes.size(); ++i) {
      const MeasuredPass& p = frame.passes[i];
      const std::vector<LightStep> steps = stepsOf(frame, *p.pass);
      if (described.insert(p.pass->name).second || p.pass->gives == Pass::Gives::surfaces)
        text += section(p, frame, i + 1, before, folder, shown);
      if (!steps.empty()) before = steps.back().error;
    }
    std::string rest = fmt::format("{} of {}. Blue is too dark, red too bright, full colour {:.2g} of radiance.",
                                   percent(before), frame.label, page.restScale);
    if (frame.unfiltered)
      rest += fmt::format(" With `texture.mipmaps=off`, as the reference reads textures, it is {}.",
                          percent(*frame.unfiltered));
    text += "### The error that remains\n" + paragraph(rest) + picture("The error that remains", folder, frame.rest);
  }
  text.pop_back();
  return text;
}

nlohmann::ordered_json frameJson(const FramePage& page) {
  nlohmann::ordered_json json{{"scene", page.scene},           {"view", page.view},     {"command", page.command},
                              {"renderer", page.renderer},     {"cpu", page.cpu},       {"program", page.program},
                              {"reference_spp", page.samples}, {"noise_l2", page.noise}};
  for (const MeasuredFrame& frame : page.frames) {
    nlohmann::ordered_json f{
        {"label", frame.label}, {"technique", frame.technique}, {"timed_frames", page.timedFrames}};
    for (const MeasuredPass& p : frame.passes) {
      f["passes"].push_back({{"name", p.pass->name},
                             {"title", p.pass->title},
                             {"ms", p.ms},
                             {"ms_spread", {p.low, p.high}},
                             {"runs_still", p.runsStill},
                             {"l2_without", nullptr},
                             {"pictures", p.pictures}});
      if (p.without) f["passes"].back()["l2_without"] = *p.without;
    }
    if (frame.unfiltered) f["l2_unfiltered"] = *frame.unfiltered;
    for (const LightStep& step : frame.steps)
      f["light"].push_back({{"name", step.name}, {"pass", step.pass}, {"l2", step.error}, {"picture", step.picture}});
    json["frames"].push_back(f);
  }
  return json;
}

}  // namespace lucerna::demo::bench
