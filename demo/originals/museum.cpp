#include "originals/museum.hpp"

#include "base/data.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"
#include "lpv/settings.hpp"
#include "radiosity/radiosity_view.hpp"
#include "render/techniques.hpp"
#include "shared/html.hpp"
#include "labs/lab.hpp"
#include "measure/heat_map.hpp"
#include "pathtracer/path_tracer.hpp"
#include "render/deviations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lucerna::demo::labs {

namespace {

using bench::escapeHtml;

const Scene& box() {
  static const Scene scene = loadScene(dataFolder() / "assets/cornell/cornell.json");
  return scene;
}

RenderSettings settingsOf(const std::string& technique, const std::string& deviation) {
  RenderSettings settings;
  applyFidelity(settings, Fidelity::corrected);
  settings.technique = techniqueNamed(technique).name;
  settings.component = Component::indirect;
  settings.size = {96, 96};
  settings.fullFloatTarget = true;
  if (!deviation.empty()) applyDeviation(settings, deviation + "=on");
  return settings;
}

Image rendered(const gl::Context& context, gl::ProgramLibrary& programs, const RenderSettings& settings) {
  Renderer renderer(context, programs, box(), settings);
  renderer.renderToTheEnd(box().cameras.front());
  return renderer.readRadiance();
}
double meanOfAll(const Image& image) {
  const glm::dvec3 mean = meanOf(image);
  return (mean.x + mean.y + mean.z) / 3.0;
}

/// A picture of the path tracer, of demo/labs/museum/NAME.json. Both pictures of a pair use the same random numbers.
struct Traced {
  Image image;
  double error = 0.0;  ///< standard error of its mean
};
Traced traced(const gl::Context& context, gl::ProgramLibrary& programs, const std::string& name,
              const std::string& deviation, bool lamps = true, std::uint32_t samples = 32) {
  const Scene scene = loadScene(labsFolder() / "museum" / (name + ".json"));
  RenderSettings shared;
  if (!deviation.empty()) applyDeviation(shared, deviation + "=on");
  PathTracer::Settings settings;
  settings.size = {96, 96};
  settings.deviations = shared.of<PathSettings>().deviations;
  settings.nextEvent = lamps;  // a point lamp cannot be found otherwise
  PathTracer tracer(context, programs, scene, settings);
  tracer.setCamera(scene.cameras.front());
  tracer.record(samples);
  const glm::dvec3 error = tracer.statistics().meanError;
  return {tracer.mean(), (error.x + error.y + error.z) / 3.0};
}

/// The scene that shows a deviation of the path tracer best.
std::string sceneOf(const std::string& deviation) {
  if (deviation == "path.distance-without-pdf" || deviation.starts_with("path.roulette")) return "furnace";
  return deviation == "path.fixed-epsilon" ? "small" : "lamp";
}

std::string techniqueOf(const std::string& deviation) { return deviation.substr(0, deviation.find('.')); }

std::string png(const Bitmap& bitmap) {
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("lucerna-museum-{:x}.png", reinterpret_cast<std::uintptr_t>(&bitmap));
  writePng(file, bitmap);
  const std::string text = bench::base64(readFileBytes(file));
  std::filesystem::remove(file);
  return text;
}

constexpr std::string_view kStyle = R"(
body { font: 15px/1.5 system-ui, sans-serif; color: #1c1c1e; max-width: 1000px; margin: 2em auto; padding: 0 1.5em; }
section { border-top: 2px solid #ddd; padding: .6em 0 1em; overflow: hidden; } h2 { margin: .3em 0;
  font-size: 1.15em; } dt { color: #6b6b70; font-size: 13px; } dd { margin: 0 0 .45em; }
code { background: #f5f5f7; padding: .1em .3em; } .pair { float: right; margin-left: 1.5em; font-size: 12px;
  color: #555; } .pair img { width: 144px; image-rendering: pixelated; display: block; }
  .pair figure { display: inline-block; margin: 0 .3em; vertical-align: top; }
.none { width: 144px; height: 144px; box-sizing: border-box; padding: 3.5em .5em; text-align: center;
  background: #f5f5f7; }
nav { columns: 3; font-size: 13px; margin-bottom: 1.5em; } nav a { display: block; }
)";

}  // namespace

std::string museumHtml(const gl::Context& context, gl::ProgramLibrary& programs, std::span<const Room> rooms,
                       bool small, const std::function<void(int, int)>& progress) {
  std::string index = "<nav>", body;
  int done = 0;
  std::map<std::string, Traced> sound;
  for (const Room& room : rooms) {
    progress(done++, static_cast<int>(rooms.size()));
    const std::string technique = techniqueOf(room.deviation),
                      scene = technique == "path" ? sceneOf(room.deviation) : technique;
    const auto shown = [&](const std::string& deviation) {
      if (technique == "path") return traced(context, programs, scene, deviation, true, small ? 8 : 32);
      RenderSettings settings = settingsOf(technique, deviation);
      if (small) {
        settings.of<RadiosityView::Settings>().solution.patches.longestEdge = 0.1;  // of a box of half a metre
        settings.of<LpvSettings>().cascades.cells = 16;
      }
      return Traced{rendered(context, programs, settings)};
    };
    if (!sound.contains(scene)) sound[scene] = shown("");
    // Both pictures and their difference.
    const Traced &right = sound[scene], wrong = shown(room.deviation);
    const double change = meanOfAll(wrong.image) / meanOfAll(right.image) - 1.0,
                 noise = std::hypot(wrong.error, right.error) / meanOfAll(right.image);
    const float exposure = technique == "path" ? 1.0f : 4.0f;
    const double scale = measure::heatMapScale(wrong.image, right.image);
    std::string pictures = fmt::format(
        "<div class=\"pair\"><figure><img alt=\"right\" src=\"data:image/png;base64,{}\">right</figure><figure><img "
        "alt=\"with the mistake\" src=\"data:image/png;base64,{}\">mean {:+.2f} %{}</figure>",
        png(toneMapped(right.image, exposure)), png(toneMapped(wrong.image, exposure)), 100.0 * change,
        technique == "path" ? fmt::format(" ({:.2f})", 100.0 * noise) : "");
    pictures +=
        scale > 0.0
            ? fmt::format(
                  "<figure><img alt=\"difference\" src=\"data:image/png;base64,{}\">difference, full at "
                  "{:.2g}</figure></div>",
                  png(measure::heatMap(wrong.image, right.image, measure::HeatMap::signedLuminance, scale)), scale)
            : std::string("<figure><div class=\"none\">not seen in this scene</div>no difference</figure></div>");
    // The room's entry and its section.
    index += fmt::format("<a href=\"#{0}\">{0}</a>", room.deviation);
    body += fmt::format(
        "<section "
        "id=\"{0}\">{1}<h2>{0}</h2><dl><dt>symptom</dt><dd>{2}</dd><dt>cause</dt><dd>{3}</dd><dt>formula</"
        "dt><dd><code>{4}</code> for <code>{5}</code></dd><dt>what finds it</dt><dd>{6}</dd><dt>the test that catches "
        "it</dt><dd><code>{7}</code></dd></dl></section>\n",
        room.deviation, pictures, escapeHtml(room.symptom), escapeHtml(room.cause), escapeHtml(room.published),
        escapeHtml(room.right), escapeHtml(room.instrument), escapeHtml(room.test));
  }
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Museum of "
      "mistakes</title><style>{}</style></head>\n<body><h1>Museum of mistakes</h1>\n"
      "<p>Every one of these was published or shipped. <code>--deviation NAME=on</code> turns one on. Pictures: "
      "indirect light alone in a Cornell box of 96 by 96 pixels; for path.* a white furnace, or a ball of fog and one "
      "of water below a lamp, with the mean's standard error in brackets. Red is too bright, blue too dark. On "
      "{}.</p>{}</nav>\n{}</body></html>\n",
      kStyle, escapeHtml(context.capabilities().renderer), index, body);
}

Mystery mysteryOf(const std::string& seed) {
  // The deviations with a visible effect in the Cornell box: the readings of any two differ.
  static const std::vector<std::pair<std::string, std::vector<std::string>>> kPool{
      {"lpv",
       {"lpv.flux-units", "lpv.sum-cascades", "lpv.side-directions", "lpv.four-pi-kernel", "lpv.fewer-steps",
        "lpv.block-first-step", "lpv.unwindowed", "lpv.blocking-direction"}},
      {"rsm", {"rsm.flux-cosine", "rsm.gather-weight"}},
      {"path",
       {"path.distance-without-pdf", "path.boosted-interaction", "path.roulette-without-division",
        "path.unattenuated-shadow-rays", "path.straight-shadow-rays"}}};
  Random random(Hash::of(seed.data(), seed.size()));
  random.word();
  std::vector<std::pair<std::string, std::string>> all;
  for (const auto& [technique, names] : kPool)
    for (const std::string& name : names) all.emplace_back(technique, name);
  const auto& [technique, hidden] = all[static_cast<std::size_t>(random.word() % all.size())];
  Mystery mystery{technique, {}, hidden};
  for (const auto& [key, names] : kPool)
    if (key == technique) mystery.candidates = names;
  return mystery;
}

Readings readInstruments(const gl::Context& context, gl::ProgramLibrary& programs, const std::string& technique,
                         const std::string& deviation) {
  Readings result;
  if (technique == "path") {
    const auto pair = [&](const std::string& scene, bool lamps) {
      return std::pair{traced(context, programs, scene, "", lamps).image,
                       traced(context, programs, scene, deviation, lamps).image};
    };
    // The ball of fog is in the left half, the ball of water in the right one.
    const auto mean = [](const Image& image, int first, int last) {
      double sum = 0.0;
      for (int y = 0; y < image.height; ++y)
        for (int x = first; x < last; ++x) sum += (image.at(x, y).x + image.at(x, y).y + image.at(x, y).z) / 3.0;
      return sum / ((last - first) * image.height);
    };
    const auto read = [&](const std::string& name, const std::pair<Image, Image>& both, int first, int last) {
      result.readings.push_back({name, mean(both.first, first, last), mean(both.second, first, last)});
    };
    const auto furnace = pair("furnace", true), lit = pair("lamp", true), dark = pair("lamp", false);
    read("white furnace", furnace, 0, 96);
    read("lamp and sky, fog", lit, 0, 48);
    read("lamp and sky, water", lit, 48, 96);
    read("sky alone, fog", dark, 0, 48);
    read("sky alone, water", dark, 48, 96);
    result.sound = lit.first, result.hidden = lit.second;
    return result;
  }
  const auto read = [&](const std::string& name, const std::function<void(RenderSettings&)>& change) {
    Reading reading{name};
    for (const bool hidden : {false, true}) {
      RenderSettings settings = settingsOf(technique, hidden ? deviation : "");
      change(settings);
      Image image = rendered(context, programs, settings);
      (hidden ? reading.hidden : reading.sound) = meanOfAll(image);
      if (result.readings.empty()) (hidden ? result.hidden : result.sound) = std::move(image);
    }
    result.readings.push_back(reading);
  };
  read("as it is", [](RenderSettings&) {});
  read("rsm.size doubled", [](RenderSettings& s) { s.of<ReflectiveShadowMap::Settings>().size *= 2; });
  if (technique == "lpv") {
    read("one cascade", [](RenderSettings& s) { s.of<LpvSettings>().cascades.cascades = 1; });
    read("one step", [](RenderSettings& s) { s.of<LpvSettings>().iterations = 1; });
    read("two steps", [](RenderSettings& s) { s.of<LpvSettings>().iterations = 2; });
    read("nothing blocks", [](RenderSettings& s) { s.of<LpvSettings>().blocking = false; });
  }
  return result;
}

}  // namespace lucerna::demo::labs
