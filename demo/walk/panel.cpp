#include "walk/panel.hpp"

#include "scene/motion.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/statistics.hpp"
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "lpv/lpv_frame.hpp"
#include "pathtracer/path_frame.hpp"
#include "radiosity/radiosity_frame.hpp"
#include "render/techniques.hpp"
#include "walk/controls.hpp"
#include "walk/keys.hpp"
#include "walk/pixel_section.hpp"
#include "walk/recent_files.hpp"
#include "shared/shipped_scenes.hpp"
#include "walk/settings_section.hpp"
#include "walk/shots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace lucerna::demo {

namespace {

bool section(Ui& ui, const char* name, bool openAtStart) {
  ui.section("");
  const bool open = ImGui::CollapsingHeader(name, openAtStart ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  ui.note(name);
  ui.section(name);
  if (open) ImGui::PushID(name);
  return open;
}
void endSection() { ImGui::PopID(); }

// ---------------------------------------------------------------------------------------------------- sections

using Files = std::map<std::string, std::filesystem::path>;

Files recentByName() {
  Files files;
  for (const std::filesystem::path& file : recentFiles()) files.emplace(file.filename().string(), file);
  return files;
}

/// A menu of files, which are sought when it is opened.
void openMenu(Ui& ui, WalkState& s, const char* label, Files (*files)()) {
  if (!ImGui::BeginCombo(label, "open ...")) {
    ui.note(label);
    return;
  }
  if (ui.escapes()) ImGui::CloseCurrentPopup();
  for (const auto& [name, file] : files()) {
    if (ImGui::Selectable(name.c_str())) s.sceneToLoad = file;
    ui.note(std::string(label) + ": " + name);
  }
  ImGui::EndCombo();
}

void showScene(Ui& ui, WalkState& s) {
  const Scene& scene = *s.scene;
  line(scene.name);
  line(fmt::format("{} triangles, {} materials, {} textures", scene.triangleCount(), scene.materials.size(),
                   scene.textures.size()));
  line(fmt::format("{} spots, {} points{}{}{}", scene.spots.size(), scene.points.size(), scene.sun ? ", a sun" : "",
                   scene.defaultSun ? " of ours" : "", scene.environment ? ", a sky" : ""));
  const glm::dvec3 size = scene.bounds.extent();
  line(fmt::format("{:.4g} x {:.4g} x {:.4g} units of {:.4g} m", size.x, size.y, size.z, scene.metresPerUnit));
  if (textField(ui, "file", s.sceneText)) s.sceneToLoad = s.sceneText;
  explain(
      "A scene file: JSON, OBJ, glTF, PLY. Enter loads it; a file dropped on the window is loaded, too. If it "
      "cannot be read, this scene stays.");
  if (button(ui, "load")) s.sceneToLoad = s.sceneText;
  ImGui::SameLine();
  checkbox(ui, "on a floor", s.floor);
  explain("Models without light of their own get a grey floor when loaded here, in addition to our sun and sky.");
  openMenu(ui, s, "shipped scenes", shippedScenes);
  openMenu(ui, s, "recent files", recentByName);
}

void frameScene(WalkState& s) {
  const Bounds& bounds = s.scene->bounds;
  Camera camera = s.camera->camera();
  const double radius = 0.5 * std::max(glm::length(bounds.extent()), 1e-9);
  const double distance = camera.isOrthographic() ? radius : radius / std::sin(0.5 * camera.verticalFov);
  if (camera.isOrthographic()) camera.orthographicHeight = 2.0 * radius;
  camera.position = bounds.centre() - camera.direction * distance;
  s.camera->place(camera);
  s.path.follows = false;
}

/// The time of a scene that moves.
void showTime(Ui& ui, WalkState& s) {
  TimeState& time = s.time;
  const auto hideNotice = [&] { s.messageAge = std::numeric_limits<double>::max(); };  // of another time
  if (button(ui, time.held ? "let go on" : "hold")) time.held = !time.held, hideNotice();
  ImGui::SameLine();
  checkbox(ui, "loop time", time.loops);
  float seconds = static_cast<float>(time.seconds), speed = static_cast<float>(time.speed);
  if (slider(ui, "scene time", seconds, 0.0f, static_cast<float>(s.scene->motion->end), "%.2f s")) {
    time.seconds = static_cast<double>(seconds);
    time.held = true;
    hideNotice();
  }
  if (slider(ui, "time speed", speed, 0.0625f, 16.0f, "%.3g x", true)) time.speed = static_cast<double>(speed);
}

void showCamera(Ui& ui, WalkState& s, Host& host) {
  const Camera& c = s.camera->camera();
  line(fmt::format("at {:.4g}, {:.4g}, {:.4g}", c.position.x, c.position.y, c.position.z));
  line(fmt::format("looks along {:.3f}, {:.3f}, {:.3f}", c.direction.x, c.direction.y, c.direction.z));
  float degrees = static_cast<float>(glm::degrees(c.verticalFov));
  if (c.isOrthographic()) line(fmt::format("orthographic, {:.4g} high", c.orthographicHeight));
  else if (slider(ui, "field of view", degrees, 10.0f, 120.0f, "%.1f degrees")) {
    s.path.follows = false;
    s.camera->setFieldOfView(glm::radians(static_cast<double>(degrees)));
  }
  float speed = static_cast<float>(s.camera->speed());
  const float span = static_cast<float>(std::max(glm::length(s.scene->bounds.extent()), 1e-9));
  if (slider(ui, "speed", speed, 1e-4f * span, span, "%.3g units/s", true)) s.camera->setSpeed(speed);
  checkbox(ui, "around what is in the middle", s.orbits);
  explain("Left button: orbits; with shift, or the middle button: pans; wheel: closer and farther. Key C.");
  if (button(ui, "frame the scene")) frameScene(s);
  explain("Moves back along the line of sight until the whole scene is in view.");
  ImGui::SameLine();
  if (button(ui, "copy as --camera")) ImGui::SetClipboardText(("--camera " + cameraText(*s.scene, c)).c_str());
  if (s.scene->cameras.size() > 1 || !s.scene->cameras.front().name.empty())
    for (const Camera& camera : s.scene->cameras) {
      const std::string name = camera.name.empty() ? "first view" : camera.name;
      if (ImGui::SmallButton(name.c_str())) {
        s.camera->place(camera);
        s.path.follows = false;
      }
      ui.note(name);
      ImGui::SameLine();
    }
  ImGui::NewLine();
  checkbox(ui, "along the path", s.path.follows);
  ImGui::SameLine();
  if (button(ui, s.path.paused ? "play" : "pause")) s.path.paused = !s.path.paused;
  ImGui::SameLine();
  checkbox(ui, "loop", s.path.loops);
  float seconds = static_cast<float>(s.path.seconds), playSpeed = static_cast<float>(s.path.speed);
  if (slider(ui, "time", seconds, 0.0f, static_cast<float>(s.path.duration()), "%.2f s")) {
    s.path.seconds = std::min(static_cast<double>(seconds), s.path.duration() - 1e-6);
    s.path.follows = true;
  }
  if (slider(ui, "play speed", playSpeed, 0.0625f, 16.0f, "%.3g x", true)) s.path.speed = playSpeed;
  if (s.scene->motion) showTime(ui, s);
  (void)host;
}

void showSun(Ui& ui, DirectionalLight& sun) {
  const glm::dvec3 to = -sun.direction;
  float height = static_cast<float>(glm::degrees(std::asin(std::clamp(to.y, -1.0, 1.0))));
  float azimuth = static_cast<float>(glm::degrees(std::atan2(to.x, -to.z)));
  const bool raised = slider(ui, "sun height", height, 1.0f, 90.0f, "%.1f degrees");  // both are drawn, whichever moved
  const bool turned = slider(ui, "sun azimuth", azimuth, -180.0f, 180.0f, "%.1f degrees");
  const bool moved = raised || turned;
  if (moved) {
    const double h = glm::radians(std::clamp(static_cast<double>(height), 0.5, 89.9)),
                 a = glm::radians(static_cast<double>(azimuth));
    sun.direction = -glm::dvec3(std::cos(h) * std::sin(a), std::sin(h), -std::cos(h) * std::cos(a));
  }
  float strength = std::max({sun.irradiance.x, sun.irradiance.y, sun.irradiance.z});
  if (strength > 0.0f) {
    float asked = strength;
    if (slider(ui, "sun irradiance", asked, 1e-3f, 1e4f, "%.4g W/unit^2", true)) sun.irradiance *= asked / strength;
  }
}

void showLight(Ui& ui, WalkState& s) {
  slider(ui, "exposure", s.exposure, 1e-3f, 1e3f, "%.4g", true);
  explain("Multiplies radiance before the tone curve, in all pictures.");
  checkbox(ui, "automatic exposure", s.autoExposure);
  explain(
      "Follows the picture's mean luminance. Turn it off for measurements: pictures are compared before exposure "
      "anyway.");
  ImGui::SameLine();
  if (button(ui, "meter once")) s.meterWanted = true;
  Scene& scene = *s.scene;
  if (scene.sun) showSun(ui, *scene.sun);
  const auto lamp = [&](const std::string& name, glm::vec3& intensity, glm::dvec3& position) {
    ImGui::PushID(name.c_str());
    line(name);
    float strength = std::max({intensity.x, intensity.y, intensity.z});
    if (strength > 0.0f) {
      float asked = strength;
      const bool moved =
          ImGui::SliderFloat("intensity", &asked, 1e-4f, 1e5f, "%.4g W/sr", ImGuiSliderFlags_Logarithmic);
      ui.note(name + " intensity");
      if (moved) intensity *= asked / strength;
    }
    glm::vec3 place(position);
    const float step = 1e-3f * static_cast<float>(std::max(glm::length(scene.bounds.extent()), 1e-9));
    const bool moved = ImGui::DragFloat3("position", &place.x, step);
    ui.note(name + " position");
    if (moved) position = glm::dvec3(place);
    ImGui::PopID();
  };
  if (!scene.spots.empty() || !scene.points.empty()) {
    checkbox(ui, "move lamps in the picture", s.movesLamps);
    explain("Each lamp has three axes: drag it along one.");
  }
  for (std::size_t i = 0; i < scene.spots.size() && i < 16; ++i)
    lamp(fmt::format("spot {}", i + 1), scene.spots[i].intensity, scene.spots[i].position);
  for (std::size_t i = 0; i < scene.points.size() && i < 16; ++i)
    lamp(fmt::format("point {}", i + 1), scene.points[i].intensity, scene.points[i].position);
  const bool shines = std::any_of(s.materialsAsLoaded.begin(), s.materialsAsLoaded.end(),
                                  [](const Material& m) { return m.emission != glm::vec3(0.0f); });
  if (float factor = s.emissionFactor; shines && slider(ui, "emissive surfaces", factor, 0.01f, 100.0f, "%.3g x", true))
    setEmission(s, factor);
  if (scene.environment) {
    float strength =
        std::max({scene.environment->radiance.x, scene.environment->radiance.y, scene.environment->radiance.z});
    if (strength > 0.0f) {
      float asked = strength;
      if (slider(ui, "sky", asked, 1e-4f, 1e4f, "%.4g x", true)) scene.environment->radiance *= asked / strength;
    }
  }
}

void showSide(Ui& ui, WalkState& s, int index) {
  SideState& side = s.sides[static_cast<std::size_t>(index)];
  const std::vector<std::string> techniques = techniqueNames();
  static constexpr auto kComponents = namesOf(Component{});
  static constexpr auto kFidelities = namesOf(Fidelity{});
  int shows = static_cast<int>(side.shows);
  if (menu(ui, "shows", shows, kShowsNames)) {
    side.shows = static_cast<Shows>(shows);
    if (side.shows == Shows::reference) s.liveReferenceOn = true;
  }
  if (side.shows == Shows::picture) {
    textField(ui, "picture", side.pictureFile);
    explain(
        "hdr, exr or pfm in linear radiance, png or jpg taken as sRGB. Enter loads it; a picture dropped on the window "
        "comes here as B.");
  }
  if (std::string technique = side.options.technique; menu(ui, "technique", technique, techniques))
    chooseTechnique(side.options, technique);
  menu(ui, "light", side.options.component, kComponents);
  menu(ui, "fidelity", side.options.fidelity, kFidelities);
  if (side.renderer && side.built.technique != side.options.technique)
    line("shown until it is ready: " + side.built.technique);
  else if (side.renderer)
    line(fmt::format("made in {:.2f} s, {:.1f} MiB on the GPU", side.buildSeconds,
                     static_cast<double>(side.renderer->gpuBytes()) / 1048576.0));
  if (const PathFrame* path = side.renderer ? pathFrameOf(side.renderer->technique()) : nullptr;
      path && path->denoisedSamples() > 0) {
    const DenoisedError& e = path->denoisedError();
    line(e.known ? fmt::format("denoised at {} samples: error {:.2f} %, {:.2f} to {:.2f} (99 %)",
                               path->denoisedSamples(), 100.0 * e.value, 100.0 * e.low, 100.0 * e.high)
                 : fmt::format("denoised at {} samples; error from {} on", path->denoisedSamples(),
                               Denoiser::kFewestSamples));
    explain(
        "Root mean square error over the picture's mean, from the two halves of its samples alone. It is denoised anew "
        "when the samples have doubled, and at the end.");
  }
  const auto inColour = [](ImU32 colour, const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    wrapped(text);
    ImGui::PopStyleColor();
  };
  if (side.renderer)
    for (const std::string& warning : side.renderer->warnings()) inColour(IM_COL32(255, 190, 80, 255), warning);
  if (!side.failure.empty()) inColour(IM_COL32(255, 120, 90, 255), side.failure);
}

void showJudgement(WalkState& s, int index) {
  SideState& side = s.sides[static_cast<std::size_t>(index)];
  if (side.shows == Shows::reference || !s.isVisible(index)) return;
  const char* name = index == 0 ? "A" : "B";
  if (!side.judgement.known()) {
    line(fmt::format("{}: waits for {} samples per pixel", name, LiveReference::kFewest));
    return;
  }
  const measure::ErrorInterval& e = side.judgement.nrmse();
  line(
      fmt::format("{}: error {:.2f} %, {:.2f} to {:.2f} (99 %)", name, 100.0 * e.value, 100.0 * e.low, 100.0 * e.high));
  explain(
      "Root mean square difference from the path-traced reference of this view, over the reference's mean, with the "
      "reference's own noise subtracted. The interval contains the true error with 99 % confidence.");
  const auto flip = side.judgement.flip();
  line(fmt::format("   bias {:+.2f} %, FLIP {}", 100.0 * side.judgement.bias(),
                   flip ? fmt::format("{:.4f}", *flip) : std::string("...")));
}

void showCompare(Ui& ui, WalkState& s) {
  int layout = static_cast<int>(s.layout), show = static_cast<int>(s.show);
  if (menu(ui, "layout", layout, kLayoutNames)) s.layout = static_cast<Layout>(layout);
  if (menu(ui, "shown as", show, kShowNames)) {
    s.show = static_cast<Show>(show);
    if (s.show != Show::picture) s.liveReferenceOn = true;
  }
  static constexpr std::array<std::string_view, 2> kSides{"A", "B"};
  menu(ui, "shown", s.shown, kSides);
  if (s.layout == Layout::wipe) slider(ui, "wipe", s.split, 0.0f, 1.0f, "%.2f");
  slider(ui, "zoom", s.zoom, 1.0f, 64.0f, "%.2f x", true);
  checkbox(ui, "magnifier", s.magnifier);
  if (s.show == Show::signedError)
    slider(ui, "colours end at", s.errorScale, 0.0f, 100.0f, s.errorScale > 0.0f ? "%.4g radiance" : "half of the mean",
           true);
  ImGui::Separator();
  checkbox(ui, "live reference", s.liveReferenceOn);
  explain(
      "While the camera rests, the path tracer computes the reference of this view; it is stored with the bench's "
      "references.");
  checkbox(ui, "denoise its picture", s.referenceDenoised);
  explain(
      "Shows the reference denoised, and says so. Errors are measured against the samples as they are, and those alone "
      "are stored.");
  slider(ui, "share of a frame", s.referenceShare, 0.01f, 0.9f, "%.2f");
  explain(
      "Share of a frame's time for the path tracer while the picture is still being computed; on a still view it uses "
      "all idle time.");
  if (!s.liveReferenceOn) return;
  if (s.timeRuns()) {
    line("reference: moving; P holds the time");
    return;
  }
  if (!s.reference || s.reference->samples() == 0) {
    line("the reference: when the camera rests");
    return;
  }
  line(fmt::format("reference: {} sample{} a pixel, {:.1f} s", s.reference->samples(),
                   s.reference->samples() == 1 ? "" : "s", s.reference->seconds()));
  showJudgement(s, 0);
  showJudgement(s, 1);
}

/// Single steps of propagation, and their energy.
void showLpvSteps(Ui& ui, WalkState& s) {
  if (button(ui, "measure the steps of propagation")) s.lpvStepsWanted = true;
  explain("Propagates anew with 0, 1, 2, ... steps in one cascade: the light that each step brought, and its share.");
  if (!s.lpvSteps || s.lpvSteps->steps() < 0) return;
  const std::vector<float>& energies = s.lpvSteps->energies();
  ImGui::PlotHistogram("flux", energies.data(), static_cast<int>(energies.size()), 0, nullptr, 0.0f, 1.0f,
                       ImVec2(0.0f, 4.0f * ImGui::GetFontSize()));
  ImGui::SliderInt("step", &s.lpvStep, -1, s.lpvSteps->steps(), s.lpvStep < 0 ? "the picture" : "%d");
  ui.note("step");
  if (s.lpvStep < 0) return;
  slider(ui, "step brightness", s.stageFactor, -20.0f, 40.0f, "2^%.1f");
  wrapped(fmt::format("{:.2f} % of the injected light is in the cells{}",
                      100.0f * energies[static_cast<std::size_t>(std::min(s.lpvStep, s.lpvSteps->steps()))],
                      s.lpvStep == 1 ? "; clamped lobes gain up to 14 % in the first step" : ""));
  ImGui::SliderInt("slice", &s.stageLayer, 0, s.lpvSteps->slices() - 1);
  ui.note("slice");
}

/// What a patch sees.
void showHemicube(Ui& ui, WalkState& s) {
  if (button(ui, "hemicube of the middle")) s.hemicubeWanted = true;
  explain("The five faces of the hemicube of the patch in the middle of the picture, as its form factors are found.");
  checkbox(ui, "hemicubes by clicking", s.hemicubeByClick);
  explain("A click on the picture shows the hemicube of the patch there; another one shows the picture again.");
  if (s.hemicube && button(ui, "back to the picture")) s.hemicube.reset();
}

void showStages(Ui& ui, WalkState& s) {
  const SideState& side = s.side();
  if (!side.renderer) {
    line("of a technique's picture alone");
    return;
  }
  std::vector<std::string> names{"the frame"};
  int layers = 1;
  bool isLight = false;
  for (const StagePicture& picture : side.renderer->stagePictures()) {
    names.push_back(picture.name);
    if (picture.name == s.stage) {
      layers = picture.texture->size().z;
      isLight = picture.isLight();
    }
  }
  std::string chosen = s.stage.empty() ? names.front() : s.stage;
  if (menu(ui, "picture of", chosen, names)) s.stage = chosen == names.front() ? "" : chosen;
  if (layers > 1) {
    ImGui::SliderInt("layer", &s.stageLayer, 0, layers - 1);
    ui.note("layer");
  }
  if (isLight) slider(ui, "brightness", s.stageFactor, -20.0f, 40.0f, "2^%.1f");
  if (volumeOf(side.renderer->technique())) showLpvSteps(ui, s);
  if (radiosityOf(side.renderer->technique())) showHemicube(ui, s);
  if (s.solving.curve().size() > 1) {
    const auto& last = s.solving.curve().back();
    line(fmt::format("residual {:.1e} after {:.4g} products", last.residual, last.products));
    plotResidual(s.solving, 5.0f);
    explain(
        "Of the last radiosity solution, max |E + rho F B - B| over the mean of B, by products with the form factors, "
        "in "
        "powers of ten. A sweep is a product, as are as many shots as there are patches.");
  }
  int count = static_cast<int>(s.countView), glyphs = static_cast<int>(s.glyphs);
  if (menu(ui, "count of", count, kCountViewNames)) s.countView = static_cast<CountView>(count);
  explain("Replaces the picture: black is none, then red, yellow, and white for the number set by the slider.");
  if (s.countView != CountView::none) {
    slider(ui, "white is", s.countWhite, 1.0f, 512.0f, "%.0f", true);
    if (s.countViews)
      line(fmt::format("{:.1f} on average, {:.0f} at most", s.countViews->mean(), s.countViews->most()));
  }
  if (menu(ui, "in the scene", glyphs, kGlyphNames)) s.glyphs = static_cast<Glyphs>(glyphs);
  explain(
      "As lines: the light in the brightest cells of a propagated volume by direction (its intensity, the largest half "
      "a cell long), the corners of cells that block light, or cache records: disks on their surfaces, in "
      "the colour of their irradiance.");
  if (s.glyphs == Glyphs::none) return;
  ImGui::SliderInt("at most", &s.glyphMost, 10, 5000, "%d", ImGuiSliderFlags_Logarithmic);
  ui.note("at most");
  if (s.glyphs == Glyphs::boxes) {
    ImGui::SliderInt("level", &s.glyphLevel, 0, BVH_MAX_DEPTH - 1);
    ui.note("level");
    return;
  }
  const RenderSettings& settings = side.renderer->settings();
  const int last = (s.glyphs == Glyphs::records ? settings.of<IrradianceCacheSettings>().cascades
                                                : settings.of<LpvSettings>().cascades)
                       .cascades -
                   1;
  s.glyphCascade = std::clamp(s.glyphCascade, 0, last);
  ImGui::SliderInt("cascade", &s.glyphCascade, 0, last);
  ui.note("cascade");
  if (s.glyphs == Glyphs::records && !cacheOf(side.renderer->technique()))
    wrapped("Available only for technique irradiance-cache.");
  else if ((s.glyphs == Glyphs::lobes || s.glyphs == Glyphs::geometry) && !volumeOf(side.renderer->technique()))
    wrapped("Available only for technique lpv.");
  else if (s.glyphs == Glyphs::geometry && !volumeOf(side.renderer->technique())->geometryVolume())
    wrapped("Not available with lpv.blocking=off.");
}

/// Distribution of frame times, with the budget as a line.
void showHistogram(const WalkState& s, double most) {
  constexpr std::size_t kBins = 48;
  std::array<float, kBins> bins{};
  const double end = 1.5 * std::max(most, 1e-3);
  std::size_t beyond = 0;
  for (const float ms : s.frameMs) {
    const double at = static_cast<double>(ms) / end * kBins;
    if (at < kBins) ++bins[static_cast<std::size_t>(at)];
    else ++beyond;
  }
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::GetContentRegionAvail().x, 3.0f * ImGui::GetFontSize());
  ImGui::PlotHistogram("##histogram", bins.data(), static_cast<int>(kBins), 0, nullptr, 0.0f, FLT_MAX, size);
  explain(fmt::format("Frames by their time, 0 to {:.1f} ms from left to right; {} took longer.", end, beyond));
  if (const float x = s.budgetMs / static_cast<float>(end); x < 1.0f)
    ImGui::GetWindowDrawList()->AddLine({corner.x + x * size.x, corner.y}, {corner.x + x * size.x, corner.y + size.y},
                                        IM_COL32(255, 170, 40, 255));
}

std::string timeText(double ms) { return std::isnan(ms) ? "no time" : fmt::format("{:.2f} ms", ms); }

void showTimings(Ui& ui, WalkState& s) {
  if (!s.frameMs.empty()) {
    const std::vector<double> ms(s.frameMs.begin(), s.frameMs.end());
    const double middle = median(ms), most = percentile(ms, 0.95);
    line(fmt::format("frame {:.2f} ms, 95 % {:.2f} ms", middle, most));
    const float top = std::max(1.2f * static_cast<float>(most), 1.3f * s.budgetMs);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 size(ImGui::GetContentRegionAvail().x, 4.0f * ImGui::GetFontSize());
    ImGui::PlotLines("##frames", s.frameMs.data(), static_cast<int>(s.frameMs.size()), 0, nullptr, 0.0f, top, size);
    const float y = corner.y + size.y * (1.0f - s.budgetMs / top);
    ImGui::GetWindowDrawList()->AddLine({corner.x, y}, {corner.x + size.x, y}, IM_COL32(255, 170, 40, 255));
    showHistogram(s, most);
    const auto over = std::count_if(ms.begin(), ms.end(), [&](double t) { return t > s.budgetMs; });
    line(fmt::format("{:.0f} % of {} frames over the budget",
                     100.0 * static_cast<double>(over) / static_cast<double>(ms.size()), ms.size()));
  }
  slider(ui, "budget", s.budgetMs, 1.0f, 1000.0f, "%.1f ms", true);
  for (int i = 0; i < 2; ++i) {
    SideState& side = s.sides[static_cast<std::size_t>(i)];
    if (!side.renderer || !s.isVisible(i)) continue;
    line(fmt::format("{}: {}", i == 0 ? "A" : "B", side.built.technique));
    const std::vector<gl::StageStatistics> stages = side.renderer->timer().statistics();
    double longest = 1e-9;
    for (const gl::StageStatistics& stage : stages)
      longest = std::max(longest, std::isnan(stage.medianMs) ? 0.0 : stage.medianMs);
    for (const gl::StageStatistics& stage : stages) {
      const double ms = std::isnan(stage.medianMs) ? 0.0 : stage.medianMs;
      const double reused =
          stage.frames > 0 ? 1.0 - static_cast<double>(stage.ran) / static_cast<double>(stage.frames) : 0.0;
      ImGui::ProgressBar(static_cast<float>(ms / longest), {6.0f * ImGui::GetFontSize(), 0.0f},
                         timeText(stage.medianMs).c_str());
      ImGui::SameLine();
      line(stage.name + (reused > 0.0 ? fmt::format(", reused {:.0f} %", 100.0 * reused) : ""));
      explain(fmt::format("median {}, 95 % {} of {} samples; ran in {} of {} frames; {} queries refused",
                          timeText(stage.medianMs), timeText(stage.p95Ms), stage.count, stage.ran, stage.frames,
                          stage.refused));
    }
  }
  if (button(ui, "begin again"))
    for (SideState& side : s.sides)
      if (side.renderer) side.renderer->timer().reset();
  wrapped(s.rendererName);
}

void showMemory(Ui& ui, WalkState& s) {
  double total = static_cast<double>(ui.gpuBytes());
  const auto mebibytes = [&](const std::string& name, std::size_t bytes) {
    total += static_cast<double>(bytes);
    line(fmt::format("{:8.2f} MiB  {}", static_cast<double>(bytes) / 1048576.0, name));
  };
  for (int i = 0; i < 2; ++i)
    if (const SideState& side = s.sides[static_cast<std::size_t>(i)]; side.renderer)
      mebibytes(std::string(i == 0 ? "A, " : "B, ") + side.built.technique, side.renderer->gpuBytes());
  if (s.reference) mebibytes("path tracer", s.reference->gpuBytes());
  line(fmt::format("{:8.2f} MiB  in all", total / 1048576.0));
  const SideState& side = s.side();
  if (!side.renderer) return;
  std::string left;
  for (const std::string& name : side.renderer->leftOut()) left += (left.empty() ? "" : ", ") + name;
  wrapped("Left out, since nothing here needs it: " + left);
}

void showRecord(Ui& ui, WalkState& s, Host& host) {
  if (button(ui, "save the picture")) s.shotWanted = true;
  explain("PNG as shown and HDR with linear radiance, both with embedded settings, camera and exposure.");
  ImGui::BeginDisabled(!s.canRecord);
  if (button(ui, s.records ? "end the video" : "record a video")) s.records = !s.records;
  explain("Records the picture's part of the window with ffmpeg, 30 pictures per second. Key V does the same.");
  ImGui::EndDisabled();
  if (!s.canRecord) wrapped("No video: ffmpeg is not installed (apt install ffmpeg).");
  if (!s.recording.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32(255, 90, 80, 255));
    wrapped(s.recording);
    ImGui::PopStyleColor();
  }
  if (s.canCapture) {
    if (button(ui, "RenderDoc capture")) s.captureWanted = true;
  }
  std::string folder = s.shotFolder.string();
  if (textField(ui, "into", folder)) s.shotFolder = folder;
  // Key frames
  ImGui::Separator();
  if (button(ui, "add key frame")) {
    const Camera& c = s.camera->camera();
    s.keyFrames.push_back({c.position, c.direction, c.up, c.verticalFov});
  }
  ImGui::SameLine();
  if (button(ui, "remove the last") && !s.keyFrames.empty()) s.keyFrames.pop_back();
  for (std::size_t i = 0; i < s.keyFrames.size(); ++i) {
    const KeyFrame& key = s.keyFrames[i];
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::SmallButton(
            fmt::format("{}: {:.3g}, {:.3g}, {:.3g}", i + 1, key.position.x, key.position.y, key.position.z).c_str())) {
      Camera camera = s.camera->camera();
      camera.position = key.position;
      camera.direction = key.direction;
      camera.up = key.up;
      camera.verticalFov = key.verticalFov.value_or(camera.verticalFov);
      s.camera->place(camera);
      s.path.follows = false;
    }
    ImGui::SameLine();
    if (ImGui::SmallButton("set")) {
      const Camera& c = s.camera->camera();
      s.keyFrames[i] = {c.position, c.direction, c.up, c.verticalFov};
    }
    ImGui::PopID();
  }
  textField(ui, "key frame file", s.keyFramesFile);
  if (button(ui, "write")) {
    try {
      if (s.keyFrames.size() < 2) throwBadInput("a path has at least two key frames; there are {}", s.keyFrames.size());
      std::vector<KeyFrame> keys = s.keyFrames;
      for (KeyFrame& key : keys) key.position += s.scene->origin;
      writeFileAtomically(s.keyFramesFile, textOfKeyFrames(keys, "Recorded in " + s.scene->name + "."));
      s.say(fmt::format("{}: {} key frames", s.keyFramesFile, s.keyFrames.size()));
    } catch (const Error& error) { s.say(error.what()); }
  }
  ImGui::SameLine();
  if (button(ui, "walk along them") && s.keyFrames.size() >= 2) {
    s.path.spline = Spline(s.keyFrames);
    s.path.first = 0;
    s.path.last = s.path.spline->viewCount() - 1;
    s.path.seconds = 0.0;
    s.path.follows = true;
    s.path.paused = false;
  }
  // The window
  ImGui::Separator();
  bool full = host.isFullScreen();
  if (checkbox(ui, "full screen", full)) host.setFullScreen(full);
  ImGui::SameLine();
  if (checkbox(ui, "wait for the display", s.swapAtRefresh)) host.setSwapInterval(s.swapAtRefresh ? 1 : 0);
  int limit = s.frameLimit;
  ImGui::SliderInt("frames a second", &limit, 0, 240, limit == 0 ? "no limit" : "%d at most");
  ui.note("frames a second");
  s.frameLimit = limit;
  checkbox(ui, "draw at rest", s.drawsAtRest);
  explain("A picture that has converged is not drawn again, and costs nothing. On: it is, so that timings go on.");
  slider(ui, "render scale", s.renderScale, 0.25f, 2.0f, "%.2f x");
  explain(
      "Size of the computed picture relative to the window's, per side. 2: four samples per pixel, averaged after the "
      "tone curve.");
  checkbox(ui, "coarser in motion", s.coarseInMotion);
  explain(
      "While something moves and whole frames take longer than 0.2 s, a half or a quarter of the picture's side is "
      "computed; at rest the whole. Not while a video is recorded.");
}

}  // namespace

int Panel::widthOf(float scale) { return static_cast<int>(std::lround(310.0f * scale)); }

void Panel::show(Ui& ui, WalkState& s, Host& host) {
  const auto width = static_cast<float>(widthOf(ui.scale()));
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x - std::min(width, screen.x), 0.0f}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({std::min(width, screen.x), screen.y}, ImGuiCond_Always);
  // Beside the picture nothing is behind it but what it was in the frame before.
  if (screen.x > 2.0f * width) ImGui::SetNextWindowBgAlpha(1.0f);
  ImGui::Begin(
      "Lucerna", nullptr,
      ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar);
  ui.noteWindow();
  ImGui::PushItemWidth(0.52f * ImGui::GetContentRegionAvail().x);
  const auto part = [&](const char* name, bool open, auto content) {
    if (!section(ui, name, open)) return;
    content();
    endSection();
  };
  part("Technique A", true, [&] { showSide(ui, s, 0); });
  part("Technique B", false, [&] { showSide(ui, s, 1); });
  if (s.answerIsNew) ImGui::SetNextItemOpen(true);
  part("Pixel", false, [&] {
    if (std::exchange(s.answerIsNew, false)) ImGui::SetScrollHereY(0.0f);
    showPixel(ui, s);
  });
  part("Settings and deviations", false, [&] { showSettings(ui, s); });
  part("Compare", true, [&] { showCompare(ui, s); });
  part("Light", false, [&] { showLight(ui, s); });
  part("Camera", false, [&] { showCamera(ui, s, host); });
  part("Scene", false, [&] { showScene(ui, s); });
  part("Debug view", false, [&] { showStages(ui, s); });
  part("Timings", true, [&] { showTimings(ui, s); });
  part("Memory and left out", false, [&] { showMemory(ui, s); });
  part("Record and window", false, [&] { showRecord(ui, s, host); });
  ui.section("");
  ImGui::PopItemWidth();
  ImGui::End();
}

void Panel::showHelp(Ui& ui, WalkState& s) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.02f * screen.x, 0.04f * screen.y}, ImGuiCond_Always);
  ImGui::SetNextWindowSizeConstraints({0.0f, 0.0f}, {0.96f * screen.x, 0.92f * screen.y});
  ImGui::SetNextWindowBgAlpha(1.0f);  // opaque, since it may cover the panel
  ImGui::Begin("Keys", nullptr,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove);
  ui.noteWindow();
  line(keysHelp());
  if (ImGui::Button("close")) s.help = false;
  ui.section("Keys");
  ui.note("close");
  ui.section("");
  ImGui::End();
}

void Panel::showQuestion(Ui& ui, WalkState& s) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * screen.x, 0.5f * screen.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowBgAlpha(1.0f);
  ImGui::SetNextWindowFocus();
  ImGui::Begin("##question", nullptr,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
  ui.noteWindow();
  line(s.recording.empty() ? "Quit?" : "Quit, and end the video?");
  ui.section("Question");
  if (button(ui, "quit (Enter)")) s.endWanted = true;
  ImGui::SameLine();
  if (button(ui, "stay (Escape)")) s.asksToEnd = false;
  ui.section("");
  ImGui::End();
}

void Panel::showMessage(const WalkState& s, const std::string& work, double share) {
  std::string text = work.empty() ? "" : work + " ... Escape stops it";
  if (work.empty() && !s.messages.empty() && s.messageAge < 8.0) text = s.messages.back();
  else if (work.empty() && s.hint) text = "F1 keys, F2 panel, W A S D and dragging move, X wipe, T live reference";
  if (text.empty()) return;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({8.0f, screen.y - 8.0f}, ImGuiCond_Always, {0.0f, 1.0f});
  // Of this text's size: a window that sizes itself has that of the last frame's text.
  const ImGuiStyle& style = ImGui::GetStyle();
  const float wrap = 0.58f * screen.x, bar = 20.0f * ImGui::GetFontSize();
  ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  if (share >= 0.0) size = {std::max(size.x, bar), size.y + style.ItemSpacing.y + ImGui::GetFrameHeight()};
  ImGui::SetNextWindowSize({size.x + 2.0f * style.WindowPadding.x, size.y + 2.0f * style.WindowPadding.y});
  ImGui::SetNextWindowBgAlpha(work.empty() ? 0.6f : 1.0f);
  ImGui::Begin("##message", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoNav);
  ImGui::PushTextWrapPos(style.WindowPadding.x + wrap);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  if (share >= 0.0) ImGui::ProgressBar(static_cast<float>(share), {bar, 0.0f});
  ImGui::End();
}

void Panel::showValues(const WalkState& s) {
  if (!s.magnifier || !s.pixel) return;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (!ImGui::IsMousePosValid(&mouse) || ImGui::GetIO().WantCaptureMouse) return;
  // Next to the magnifier; if the panel or the window's edge is in the way, below or above it.
  const float scale = ImGui::GetFontSize() / 13.0f, beside = 90.0f, width = 300.0f * scale, height = 80.0f * scale;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float end = screen.x - (s.panel ? static_cast<float>(widthOf(scale)) : 0.0f);
  ImVec2 place(mouse.x + beside, mouse.y);
  if (place.x + width > end)
    place = {std::max(std::min(mouse.x - 0.5f * width, end - width), 0.0f),
             mouse.y + beside + height > screen.y ? mouse.y - beside - height : mouse.y + beside};
  ImGui::SetNextWindowPos(place, ImGuiCond_Always);
  ImGui::SetNextWindowBgAlpha(1.0f);
  ImGui::Begin("##values", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
  line(fmt::format("pixel {}, {}, radiance", s.pixel->x, s.pixel->y));
  const auto value = [](const char* name, const std::optional<glm::vec3>& v) {
    if (v) line(fmt::format("{:<6} {:10.4g} {:10.4g} {:10.4g}", name, v->x, v->y, v->z));
  };
  value("A", s.values.a);
  value("B", s.values.b);
  value("reference", s.values.reference);
  value("+-", s.values.error);
  ImGui::End();
}

}  // namespace lucerna::demo
