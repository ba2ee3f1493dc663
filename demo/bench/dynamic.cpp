// lucerna bench dynamic SCENE: a sequence of moments, each against its own path traced reference: error, lag, ghosts,
// flicker and time of every technique (measure/sequence.hpp). A scene moves, or the camera along its path, or both.
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/statistics.hpp"
#include "bench/bench.hpp"
#include "gl/draw.hpp"
#include "measure/sequence.hpp"
#include "pathtracer/path_sampler.hpp"
#include "render/renderer.hpp"
#include "render/techniques.hpp"
#include "scene/key_frames.hpp"
#include "scene/motion.hpp"
#include "scene/scene_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;

struct DynamicOptions {
  CommonOptions common;
  PictureOptions picture;
  std::string scene, camera, out, keys, references;
  std::vector<std::string> techniques;
  int frames = 24;
  unsigned samples = 256;
  double fps = 8.0, time = 0.0;
  bool live = false;
};

struct Moment {
  double seconds;
  Camera camera;
  measure::Reference reference;
  Image seen;  ///< visible lights and background
  std::vector<bool> left;  ///< pixels that are not judged: emissive surfaces cover them in part
};

struct Row {
  std::string technique;
  std::vector<Image> pictures;  ///< as drawn
  std::vector<double> ms;
  measure::SequenceErrors errors;
};

/// Without what is seen of lights themselves, and without pixels that are not judged.
Image scatteredOf(const Image& picture, const Moment& moment) {
  Image result = picture;
  for (std::size_t i = 0; i < result.pixels.size(); ++i)
    result.pixels[i] = moment.left[i] ? glm::vec3(0.0f) : result.pixels[i] - moment.seen.pixels[i];
  return result;
}

/// The moments with their references; fewer where it is interrupted.
std::vector<Moment> momentsOf(const DynamicOptions& options, const gl::Context& context, gl::ProgramLibrary& programs,
                              Scene& scene, const RenderSettings& settings) {
  std::optional<Spline> path;
  if (!options.keys.empty()) path.emplace(keyFramesOf(scene, options.keys));
  const measure::ReferenceCache cache(options.references.empty() ? measure::ReferenceCache::defaultFolder()
                                                                 : fs::path(options.references));
  std::vector<Moment> moments;
  Progress progress("references", options.frames, options.common.quiet);
  for (int k = 0; k < options.frames && !interrupted(); ++k) {
    Moment moment{options.time + k / options.fps, {}, {}, {}, {}};
    poseAt(scene, moment.seconds);
    moment.camera = path ? path->at(path->segmentCount() * (k / std::max(options.frames - 1.0, 1.0)))
                         : chooseCamera(scene, options.camera);
    PathSampler sampler(context, programs, scene, moment.camera, settings.size, settings.filter, Transport::all, true);
    // Paths of their own for each moment: otherwise what noise two moments share would count as what they show.
    const std::uint64_t begin = static_cast<std::uint64_t>(k) * options.samples;
    const measure::ReferenceKey key = measure::keyOf(scene, moment.camera, settings.size, Transport::all,
                                                     fmt::format("{}, from {}", sampler.version(), begin));
    measure::SamplingGoal goal;
    goal.samples = options.samples;
    auto reference = measure::obtainReference(
        cache, key,
        [&](std::uint64_t first, std::uint32_t samples) { return sampler.asSampler()(begin + first, samples); },
        Transport::all, goal, context.capabilities().renderer, interrupted);
    if (!reference || interrupted()) break;
    moment.reference = std::move(*reference);
    moment.seen = seenLights(context, programs, scene, moment.camera, settings.size, settings.filter);
    moment.left = emitterEdges(context, programs, scene, moment.camera, settings.size, settings.filter);
    moments.push_back(std::move(moment));
    progress.update(k + 1);
  }
  return moments;
}

Row draw(const DynamicOptions& options, const gl::Context& context, gl::ProgramLibrary& programs, Scene& scene,
         const RenderSettings& settings, const std::vector<Moment>& moments) {
  Row row{std::string(settings.technique), {}, {}, {}};
  poseAt(scene, moments.front().seconds);
  auto renderer = std::make_unique<Renderer>(context, programs, scene, settings);
  renderer->renderToTheEnd(moments.front().camera);  // drivers finish shaders on first use
  for (const Moment& moment : moments) {
    if (interrupted()) return row;
    const auto start = Clock::now();
    if (!renderer->follow(context, programs, scene, poseAt(scene, moment.seconds)))
      renderer = std::make_unique<Renderer>(context, programs, scene, settings);
    if (options.live) renderer->render(moment.camera);
    else renderer->renderToTheEnd(moment.camera);
    gl::finish();
    row.ms.push_back(1e3 * secondsSince(start));
    row.pictures.push_back(renderer->readRadiance());
  }
  renderer->drain();
  std::vector<Image> pictures;
  std::vector<measure::Reference> references;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    pictures.push_back(scatteredOf(row.pictures[k], moments[k]));
    measure::Reference& reference = references.emplace_back(moments[k].reference);
    reference.mean = scatteredOf(reference.mean, moments[k]);
    for (std::size_t i = 0; i < moments[k].left.size(); ++i)
      if (moments[k].left[i]) reference.standardError.pixels[i] = glm::vec3(0.0f);
  }
  row.errors = measure::sequenceErrors(pictures, references);
  return row;
}

std::string percent(double share) { return std::isnan(share) ? "-" : fmt::format("{:.1f} %", 100.0 * share); }
std::string number(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", value); }

/// One line a technique.
std::string tableOf(const std::vector<Row>& rows) {
  std::string text =
      "technique          mean error  worst     lag, frames  ghosts    flicker  ms a frame, median (quartiles)\n";
  for (const Row& row : rows)
    text += fmt::format("{:<18} {:<11} {:<9} {:<12} {:<9} {:<8} {:.1f} ({:.1f} to {:.1f})\n", row.technique,
                        percent(row.errors.mean), percent(row.errors.worst), number(row.errors.lag),
                        percent(row.errors.ghosts), number(row.errors.flicker), median(row.ms),
                        percentile(row.ms, 0.25), percentile(row.ms, 0.75));
  return text;
}

/// A film of each row with the curve of its error below; one slider scrubs all.
std::string pageOf(const DynamicOptions& options, const std::vector<Moment>& moments, const std::vector<Row>& rows,
                   const std::string& renderer) {
  double most = 1e-6;
  for (const Row& row : rows)
    for (const double e : row.errors.l2) most = std::isfinite(e) ? std::max(most, e) : most;
  std::string figures;
  const auto figure = [&](const std::string& name, const measure::SequenceErrors* errors) {
    std::string strip, curve;
    for (std::size_t k = 0; k < moments.size(); ++k)
      strip += fmt::format("<img src='frames/{}_{:04}.png' alt='' data-k='{}'>", name, k, k);
    if (errors) {
      std::string points;
      for (std::size_t k = 0; k < errors->l2.size(); ++k)
        points +=
            fmt::format("{:.1f},{:.1f} ", 1000.0 * (static_cast<double>(k) + 0.5) / static_cast<double>(moments.size()),
                        100.0 - 95.0 * std::min(errors->l2[k] / most, 1.0));
      curve = fmt::format(
          "<svg viewBox='0 0 1000 100' preserveAspectRatio='none'><polyline points='{}'/><line y1='0' y2='100'/></svg>",
          points);
    }
    figures += fmt::format("<h2>{}</h2><img class='large' data-name='{}' alt='{}'><div class='strip'>{}</div>{}\n",
                           name, name, name, strip, curve);
  };
  figure("reference", nullptr);
  for (const Row& row : rows) figure(row.technique, &row.errors);
  std::string times;
  for (const Moment& moment : moments) times += fmt::format("{}{:.6g}", times.empty() ? "" : ",", moment.seconds);
  return fmt::format(
      "<!doctype html><html lang='en'><meta charset='utf-8'><title>{0}, moment by moment</title><style>"
      "body{{font:15px sans-serif;max-width:62em;margin:1em auto;padding:0 1em}} pre{{overflow-x:auto}}"
      ".strip{{display:flex}} .strip img{{flex:1;min-width:0}} .strip img.now{{outline:2px solid #06c}}"
      ".large{{width:32em;max-width:100%;image-rendering:pixelated;display:block}}"
      "svg{{width:100%;height:6em;background:#f2f2f2}} "
      "polyline{{fill:none;stroke:#c30;vector-effect:non-scaling-stroke}}"
      "svg line{{stroke:#06c;vector-effect:non-scaling-stroke}} "
      "#bar{{position:sticky;top:0;background:#fff;padding:.5em 0}}"
      "input{{width:100%}}</style><h1>{0}, moment by moment</h1>"
      "<p>{1} moments, {2} a second from {3} s, {4} paths a pixel; {5}. Curves: error of each moment, up to {6}.</p>"
      "<pre>{7}</pre><div id='bar'><label>moment <output id='t'></output><input id='k' type='range' min='0' max='{8}' "
      "value='0'></label></div>{9}<script>const T=[{10}],k=document.getElementById('k');function show(){{"
      "const i=+k.value;document.getElementById('t').textContent=T[i]+' s';"
      "for(const m of document.querySelectorAll('.large'))m.src='frames/'+m.dataset.name+'_'+String(i).padStart(4,'0')+"
      "'.png';for(const m of document.querySelectorAll('.strip img'))m.classList.toggle('now',+m.dataset.k==i);"
      "for(const l of document.querySelectorAll('svg line')){{const x=1000*(i+.5)/T.length;l.setAttribute('x1',x);"
      "l.setAttribute('x2',x);}}}}k.oninput=show;for(const m of document.querySelectorAll('.strip img'))"
      "m.onclick=()=>{{k.value=m.dataset.k;show();}};show();</script></html>\n",
      fs::path(options.scene).stem().string(), moments.size(), options.fps, options.time, options.samples, renderer,
      percent(most), tableOf(rows), moments.size() - 1, figures, times);
}

int runDynamic(DynamicOptions options) {
  options.common.apply();
  options.picture.technique = "direct";
  options.picture.readSettingsFile();
  if (options.scene.empty()) options.scene = bench::asset("cornell/moving.json");
  if (options.techniques.empty()) options.techniques = {"direct", "rsm", "lpv", "irradiance-cache"};
  std::vector<RenderSettings> settings;
  for (const std::string& technique : options.techniques) {
    options.picture.technique = technique;
    settings.push_back(options.picture.parse());
    settings.back().technique = techniqueNamed(technique).name;
    settings.back().fullFloatTarget = true;
  }
  Scene scene = loadScene(options.scene);
  if (!scene.motion && options.keys.empty())
    throwBadInput("{}: nothing moves: it has no curves and no animations, and no camera path is given (--keys)",
                  options.scene);
  fs::create_directories(fs::path(options.out) / "frames");
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const std::vector<Moment> moments = momentsOf(options, context, programs, scene, settings.front());
  if (interrupted()) return exitCode();

  std::vector<Row> rows;
  const auto save = [&](const std::string& name, std::size_t k, const Image& picture) {
    writePng(fs::path(options.out) / "frames" / fmt::format("{}_{:04}.png", name, k),
             toneMapped(picture, scene.exposure));
  };
  for (std::size_t k = 0; k < moments.size(); ++k) save("reference", k, moments[k].reference.mean);
  Progress progress("techniques", static_cast<int>(settings.size()), options.common.quiet);
  for (const RenderSettings& one : settings) {
    rows.push_back(draw(options, context, programs, scene, one, moments));
    if (interrupted()) return exitCode();
    for (std::size_t k = 0; k < moments.size(); ++k) save(rows.back().technique, k, rows.back().pictures[k]);
    progress.update(static_cast<int>(rows.size()));
  }
  const std::string renderer = context.capabilities().renderer;
  writeFileAtomically(fs::path(options.out) / "dynamic.html", pageOf(options, moments, rows, renderer));
  if (!options.common.quiet)
    fmt::print("{} moments of {}, {} paths a pixel, on {}\n{}{}/dynamic.html\n", moments.size(), options.scene,
               options.samples, renderer, tableOf(rows), options.out);
  nlohmann::ordered_json json{{"scene", options.scene}, {"renderer", renderer},       {"moments", moments.size()},
                              {"fps", options.fps},     {"samples", options.samples}, {"live", options.live}};
  const auto orNull = [](double v) { return std::isnan(v) ? nlohmann::ordered_json() : nlohmann::ordered_json(v); };
  for (const Row& row : rows)
    json["techniques"].push_back({{"technique", row.technique},
                                  {"mean", row.errors.mean},
                                  {"worst", row.errors.worst},
                                  {"lag", orNull(row.errors.lag)},
                                  {"ghosts", orNull(row.errors.ghosts)},
                                  {"flicker", orNull(row.errors.flicker)},
                                  {"l2", row.errors.l2},
                                  {"ms", row.ms}});
  writeFileAtomically(fs::path(options.out) / "dynamic.json", json.dump(2) + "\n");
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addBenchDynamic(Command app) {
  auto options = std::make_shared<DynamicOptions>();
  options->picture.size = "160x90";
  options->out = "dynamic";
  app.addOption("SCENE", options->scene, "a scene file that moves (default: the Cornell box with a block and a lamp)");
  app.addOption("--techniques", options->techniques, "what is measured (direct, rsm, lpv, irradiance-cache)");
  app.addOption("--frames", options->frames, "moments").range(2, 100000).showDefault();
  app.addOption("--fps", options->fps, "moments a second of the scene's time").range(1e-6, 1e6).showDefault();
  app.addOption("--time", options->time, "seconds at the first moment").range(-1e12, 1e12).showDefault();
  app.addOption("--reference-samples", options->samples, "paths a pixel of each reference")
      .range(16u, 1u << 24)
      .showDefault();
  app.addFlag("--live", options->live, "one frame a moment, as in the window, not each picture to its end");
  app.addOption("--camera", options->camera, "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  app.addOption("--keys", options->keys, "the camera goes along these key frames, from the first to the last");
  app.addOption("--references", options->references, "folder of the references (LUCERNA_REFERENCES)");
  app.addOption("--out", options->out, "folder for dynamic.html, dynamic.json and the pictures").showDefault();
  options->picture.declare(app);
  options->common.declare(app);
  return [options] { return runDynamic(*options); };
}

}  // namespace lucerna::demo
