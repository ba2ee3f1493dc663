// lucerna bench dynamic SCENE: a sequence of moments, each against its own path traced reference: error, lag, ghosts,
// flicker and time of every technique and budget (measure/sequence.hpp). A scene moves, or the camera along its path,
// or both. Parts (shared/parts.hpp) are of moments: their references, which take nearly all of the time.
#include "base/clock.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/statistics.hpp"
#include "bench/bench.hpp"
#include "bench/sweep.hpp"
#include "gl/draw.hpp"
#include "measure/light_kinds.hpp"
#include "measure/reference.hpp"
#include "measure/sequence.hpp"
#include "pathtracer/path_frame.hpp"
#include "pathtracer/path_sampler.hpp"
#include "render/renderer.hpp"
#include "render/techniques.hpp"
#include "scene/key_frames.hpp"
#include "scene/motion.hpp"
#include "scene/scene_file.hpp"
#include "shared/parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna::demo {

namespace {

namespace fs = std::filesystem;

struct DynamicOptions {
  CommonOptions common;
  PictureOptions picture;
  PartOptions part;
  std::string scene, camera, out, keys, references;
  std::vector<std::string> techniques, points;
  int frames = 24, late = 0;
  unsigned samples = 256;
  double fps = 8.0, time = 0.0;
  bool live = false;
  bool followsKeys = false;  ///< whether `keys` has a path of the camera
};

struct Moment {
  double seconds;
  Camera camera;
  measure::Reference reference;
  Image seen;  ///< visible lights and background
  std::vector<bool> left;  ///< pixels that are not judged: emissive surfaces cover them in part
};

/// What is measured: a technique with a budget.
struct Requested {
  std::string name;  ///< such as "irradiance-cache samples=64"
  RenderSettings settings;
};

struct Row {
  std::string name;
  std::vector<Image> pictures;  ///< as drawn
  std::vector<double> ms, samples;  ///< of each moment; samples: of a pixel, in a frame of its own
  measure::SequenceErrors errors;
};

/// Without what is seen of lights themselves, and without pixels that are not judged.
Image scatteredOf(const Image& picture, const Moment& moment) {
  Image result = picture;
  for (std::size_t i = 0; i < result.pixels.size(); ++i)
    result.pixels[i] = moment.left[i] ? glm::vec3(0.0f) : result.pixels[i] - moment.seen.pixels[i];
  return result;
}

/// A name for files.
std::string fileNameOf(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == ' ' || c == '=' || c == '/'; }, '-');
  return name;
}

/// The moments, their references and where they are kept.
class Moments {
 public:
  Moments(const DynamicOptions& options, const gl::Context& context, gl::ProgramLibrary& programs, Scene& scene,
          const RenderSettings& settings)
      : options_(options),
        context_(context),
        programs_(programs),
        scene_(scene),
        size_(settings.size),
        filter_(settings.filter),
        transport_(transportOf(settings.component)),
        cache_(options.references.empty() ? measure::ReferenceCache::defaultFolder() : fs::path(options.references)) {
    if (options.followsKeys) path_.emplace(keyFramesOf(scene, scene.keyFrames));
    const int last = options.frames - 1;
    const std::string ends = referenceKey(posed(0), 0).name() + " to " + referenceKey(posed(last), last).name();
    part_.emplace(options.part, "bench dynamic",
                  fmt::format("{} moments, {:.17g} a second, {} paths, references {}", options.frames, options.fps,
                              options.samples, ends),
                  static_cast<std::size_t>(options.frames));
    if (part_->folder()) own_.emplace(*part_->folder());
  }

  /// Those of the part, each from what is kept or made now; fewer where it is interrupted.
  std::vector<Moment> obtain() {
    std::vector<Moment> moments;
    Progress progress("references", static_cast<int>(part_->last() - part_->first()), options_.common.quiet);
    for (std::size_t k = part_->first(); k < part_->last() && !interrupted(); ++k) {
      Moment moment = posed(static_cast<int>(k));
      if (!addReference(moment, static_cast<int>(k))) return moments;
      addSeen(moment);
      part_->store(k, {{"seconds", moment.seconds}});
      moments.push_back(std::move(moment));
      progress.update(static_cast<int>(moments.size()));
    }
    if (!interrupted()) part_->finish();
    return moments;
  }

 private:
  /// The scene at a moment, and its camera.
  Moment posed(int k) {
    Moment moment{options_.time + k / options_.fps, {}, {}, {}, {}};
    poseAt(scene_, moment.seconds);
    moment.camera = path_ ? path_->at(path_->segmentCount() * (k / std::max(options_.frames - 1.0, 1.0)))
                          : chooseCamera(scene_, options_.camera);
    return moment;
  }

  // Paths of their own for each moment: otherwise what noise two moments share would count as what they show.
  std::uint64_t firstPath(int k) const { return static_cast<std::uint64_t>(k) * options_.samples; }

  measure::ReferenceKey referenceKey(const Moment& moment, int k) const {
    return measure::keyOf(scene_, moment.camera, size_, transport_,
                          fmt::format("{}, from {}", PathSampler::versionOf(filter_, true), firstPath(k)));
  }

  std::optional<measure::Reference> kept(const measure::ReferenceKey& key) const {
    return own_ ? own_->load(key) : std::nullopt;
  }
  void keep(const measure::ReferenceKey& key, const measure::Reference& reference) const {
    if (own_) own_->store(key, reference);
  }

  /// False: interrupted.
  bool addReference(Moment& moment, int k) const {
    const measure::ReferenceKey key = referenceKey(moment, k);
    auto reference = kept(key);
    if (!reference) {
      PathSampler sampler(context_, programs_, scene_, moment.camera, size_, filter_, transport_, true);
      measure::SamplingGoal goal;
      goal.samples = options_.samples;
      reference = measure::obtainReference(
          cache_, key,
          [&](std::uint64_t first, std::uint32_t samples) {
            return sampler.asSampler()(firstPath(k) + first, samples);
          },
          transport_, goal, context_.capabilities().renderer, interrupted);
      if (!reference || interrupted()) return false;
      keep(key, *reference);
    }
    moment.reference = std::move(*reference);
    return true;
  }

  /// A picture of camera rays through `lit`, kept as a reference is. Moments that look alike share it in the cache; in
  /// a part's folder each has its own, since drivers of other machines may differ in the last bits.
  template <class Make>
  Image seenPicture(const Scene& lit, const Moment& moment, const char* what, const Make& make) const {
    const std::string text = fmt::format("{}, {}", what, PathSampler::versionOf(filter_));
    const auto keyOf = [&](const std::string& sampler) {
      return measure::keyOf(lit, moment.camera, size_, Transport::all, sampler);
    };
    const measure::ReferenceKey key = keyOf(text), ownKey = keyOf(fmt::format("{} at {:.17g} s", text, moment.seconds));
    auto found = kept(ownKey);
    const bool isOwn = found.has_value();
    if (!found) found = cache_.load(key);
    if (!found) {
      found.emplace();
      found->mean = make();
      found->standardError = Image(size_.x, size_.y);
      found->samples = 1;
      found->renderer = context_.capabilities().renderer;
      cache_.store(key, *found);
    }
    if (!isOwn) keep(ownKey, *found);
    return std::move(found->mean);
  }

  /// Sun and lamps are not seen: that they move makes no other picture.
  void addSeen(Moment& moment) const {
    const Scene shining = measure::litBy(scene_, {false, false, true, true});
    moment.seen = seenPicture(shining, moment, "seen lights",
                              [&] { return seenLights(context_, programs_, shining, moment.camera, size_, filter_); });
    moment.left.resize(moment.seen.pixels.size());
    if (!measure::kindsOf(scene_).surfaces) return;
    Scene emitters = measure::litBy(scene_, {false, false, true, false});
    emitters.background = glm::vec3(0.0f);
    const Image edges = seenPicture(emitters, moment, "edges of emitters", [&] {
      Image picture(size_.x, size_.y);
      const std::vector<bool> isEdge = emitterEdges(context_, programs_, emitters, moment.camera, size_, filter_);
      for (std::size_t i = 0; i < isEdge.size(); ++i)
        if (isEdge[i]) picture.pixels[i] = glm::vec3(1.0f);
      return picture;
    });
    for (std::size_t i = 0; i < edges.pixels.size(); ++i) moment.left[i] = edges.pixels[i].x > 0.0f;
  }

  const DynamicOptions& options_;
  const gl::Context& context_;
  gl::ProgramLibrary& programs_;
  Scene& scene_;
  glm::ivec2 size_;
  PixelFilter filter_;
  Transport transport_;
  std::optional<Spline> path_;
  measure::ReferenceCache cache_;
  std::optional<PartFolder> part_;
  std::optional<measure::ReferenceCache> own_;  ///< in the part's folder
};

Row draw(const DynamicOptions& options, const gl::Context& context, gl::ProgramLibrary& programs, Scene& scene,
         const Requested& asked, const std::vector<Moment>& moments) {
  Row row{asked.name, {}, {}, {}, {}};
  const RenderSettings& settings = asked.settings;
  poseAt(scene, moments.front().seconds);
  auto renderer = std::make_unique<Renderer>(context, programs, scene, settings);
  const auto follow = [&](const Moment& moment) {
    if (!renderer->follow(context, programs, scene, poseAt(scene, moment.seconds)))
      renderer = std::make_unique<Renderer>(context, programs, scene, settings);
  };
  renderer->renderToTheEnd(moments.front().camera);  // drivers finish shaders on first use
  if (options.live && moments.size() > 1) {
    // In the window a view has moved before, and rested for a while. Here it moves away and back a few times until the
    // number of samples in motion has settled, and rests.
    constexpr int kMoves = 6;
    for (int k = 1; k <= (settings.motionSamples > 0 ? 1 : kMoves) && !interrupted(); ++k)
      for (const std::size_t place : {std::size_t{1}, std::size_t{0}}) {
        follow(moments[place]);
        renderer->render(moments[place].camera);
      }
    for (int sample = 0; sample < settings.pixelSamples && !interrupted(); ++sample)
      renderer->render(moments[0].camera);
  }
  for (std::size_t k = 0; k < moments.size(); ++k) {
    if (interrupted()) return row;
    const Moment& moment = moments[k - std::min(k, static_cast<std::size_t>(options.late))];
    const auto start = Clock::now();
    follow(moment);
    if (options.live) renderer->render(moment.camera);
    else renderer->renderToTheEnd(moment.camera);
    gl::finish();
    row.ms.push_back(1e3 * secondsSince(start));
    const int samples = options.live ? renderer->motionSamples() : settings.pixelSamples;
    row.samples.push_back(pathOf(renderer->technique()) ? std::nan("") : samples);  // paths have settings of their own
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
  constexpr std::string_view kHead = "technique";
  std::size_t longest = kHead.size();
  for (const Row& row : rows) longest = std::max(longest, row.name.size());
  std::string text = fmt::format(
      "{:<{}}  mean error  worst     lag, frames  ghosts    flicker  samples  ms a frame, "
      "median (quartiles)\n",
      kHead, longest);
  for (const Row& row : rows)
    text += fmt::format("{:<{}}  {:<11} {:<9} {:<12} {:<9} {:<8} {:<8} {:.1f} ({:.1f} to {:.1f})\n", row.name, longest,
                        percent(row.errors.mean), percent(row.errors.worst), number(row.errors.lag),
                        percent(row.errors.ghosts), number(row.errors.flicker),
                        std::isnan(row.samples.front()) ? "-" : fmt::format("{}", median(row.samples)), median(row.ms),
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
      strip += fmt::format("<img src='frames/{}_{:04}.png' alt='' data-k='{}'>", fileNameOf(name), k, k);
    if (errors) {
      std::string points;
      for (std::size_t k = 0; k < errors->l2.size(); ++k)
        points +=
            fmt::format("{:.1f},{:.1f} ", 1000.0 * (static_cast<double>(k) + 0.5) / static_cast<double>(moments.size()),
                        100.0 - 100.0 * std::min(errors->l2[k] / most, 1.0));
      curve = fmt::format(
          "<div class='curve'><b>{}</b><i>0</i><svg viewBox='0 0 1000 100' preserveAspectRatio='none'>"
          "<polyline points='{}'/><line y1='0' y2='100'/></svg></div>"
          "<div class='times'><span>{:.6g} s</span><span>{:.6g} s</span></div>",
          percent(most), points, moments.front().seconds, moments.back().seconds);
    }
    figures += fmt::format("<h2>{}</h2><img class='large' data-name='{}' alt='{}'><div class='strip'>{}</div>{}\n",
                           name, fileNameOf(name), name, strip, curve);
  };
  figure("reference", nullptr);
  for (const Row& row : rows) figure(row.name, &row.errors);
  std::string times;
  for (const Moment& moment : moments) times += fmt::format("{}{:.6g}", times.empty() ? "" : ",", moment.seconds);
  return fmt::format(
      "<!doctype html><html lang='en'><meta charset='utf-8'><title>{0}, moment by moment</title><style>"
      "body{{font:15px sans-serif;max-width:62em;margin:1em auto;padding:0 1em}} pre{{overflow-x:auto;font-size:11px}}"
      ".strip{{display:flex}} .strip img{{flex:1;min-width:0}} .strip img.now{{outline:2px solid #06c}}"
      ".large{{width:32em;max-width:100%;image-rendering:pixelated;display:block}}"
      ".curve{{position:relative;font-size:12px}} .curve b,.curve i{{position:absolute;left:0;padding:0 "
      "4px;font:inherit;background:#f2f2f2}} "
      ".curve i{{bottom:8px}} .times{{display:flex;justify-content:space-between;font-size:12px}} "
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
  if (options.techniques.empty() && options.points.empty())
    options.techniques = {"direct", "rsm", "lpv", "irradiance-cache"};

  // Techniques and budgets
  std::vector<Requested> asked;
  const auto ask = [&](const std::string& name, const PictureOptions& picture) {
    RenderSettings settings = picture.parse();
    settings.technique = techniqueNamed(picture.technique, "--techniques").name;
    settings.fullFloatTarget = true;
    asked.push_back({name, settings});
  };
  for (const std::string& technique : options.techniques) {
    options.picture.technique = technique;
    ask(technique, options.picture);
  }
  for (const std::string& text : options.points) {
    const bench::SweepPoint point = bench::parseSweepPoint(text, "--point", true);
    options.picture.technique = point.picture.technique;
    PictureOptions picture = options.picture;
    picture.settings.insert(picture.settings.end(), point.picture.settings.begin(), point.picture.settings.end());
    ask(point.label(), picture);
  }
  Scene scene = loadScene(options.scene);
  if (!options.keys.empty()) {
    scene.keyFrames.clear();
    setKeyFrames(scene, options.keys, false);
    finishMotion(scene);
    options.followsKeys = !scene.keyFrames.empty();
  }
  if (!scene.motion && !options.followsKeys)
    throwBadInput("{}: nothing moves: it has no curves and no animations, and no camera path is given (--keys)",
                  options.scene);

  // References
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  const std::vector<Moment> moments = Moments(options, context, programs, scene, asked.front().settings).obtain();
  if (interrupted()) return exitCode();
  if (options.part.isPart()) {
    options.common.writeJson({{"scene", options.scene}, {"moments", moments.size()}});
    return 0;
  }

  // Pictures
  fs::create_directories(fs::path(options.out) / "frames");
  std::vector<Row> rows;
  const auto save = [&](const std::string& name, std::size_t k, const Image& picture) {
    writePng(fs::path(options.out) / "frames" / fmt::format("{}_{:04}.png", fileNameOf(name), k),
             toneMapped(picture, scene.exposure));
  };
  for (std::size_t k = 0; k < moments.size(); ++k) save("reference", k, moments[k].reference.mean);
  Progress progress("techniques", static_cast<int>(asked.size()), options.common.quiet);
  for (const Requested& one : asked) {
    rows.push_back(draw(options, context, programs, scene, one, moments));
    if (interrupted()) return exitCode();
    for (std::size_t k = 0; k < moments.size(); ++k) save(rows.back().name, k, rows.back().pictures[k]);
    progress.update(static_cast<int>(rows.size()));
  }

  // The report
  const std::string renderer = context.capabilities().renderer;
  writeFileAtomically(fs::path(options.out) / "dynamic.html", pageOf(options, moments, rows, renderer));
  if (!options.common.quiet)
    fmt::print("{} moments of {}, {} paths a pixel, on {}\n{}{}/dynamic.html\n", moments.size(), options.scene,
               options.samples, renderer, tableOf(rows), options.out);
  nlohmann::ordered_json json{{"scene", options.scene}, {"renderer", renderer},       {"moments", moments.size()},
                              {"fps", options.fps},     {"samples", options.samples}, {"live", options.live}};
  if (options.late > 0) json["late"] = options.late;
  const auto radianceOf = [](const Image& picture) {
    const glm::dvec3 mean = meanOf(picture);
    return (mean.x + mean.y + mean.z) / 3.0;
  };
  for (const Moment& moment : moments) json["radiance"].push_back(radianceOf(moment.reference.mean));
  const auto orNull = [](double v) { return std::isnan(v) ? nlohmann::ordered_json() : nlohmann::ordered_json(v); };
  for (const Row& row : rows) {
    auto radiance = nlohmann::ordered_json::array();
    for (const Image& picture : row.pictures) radiance.push_back(radianceOf(picture));
    json["techniques"].push_back({{"technique", row.name},
                                  {"mean", row.errors.mean},
                                  {"worst", row.errors.worst},
                                  {"lag", orNull(row.errors.lag)},
                                  {"ghosts", orNull(row.errors.ghosts)},
                                  {"flicker", orNull(row.errors.flicker)},
                                  {"l2", row.errors.l2},
                                  {"radiance", radiance},
                                  {"samples", row.samples},
                                  {"ms", row.ms}});
  }
  writeFileAtomically(fs::path(options.out) / "dynamic.json", json.dump(2) + "\n");
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addBenchDynamic(Command app) {
  auto options = std::make_shared<DynamicOptions>();
  options->picture.size = "160x90";
  options->out = "dynamic";
  app.addOption("SCENE", options->scene, "a scene file that moves (default: the Cornell box with a block and a lamp)")
      .scene();
  app.addOption("--techniques", options->techniques, "what is measured (direct, rsm, lpv, irradiance-cache)");
  app.addOption("--point", options->points,
                "\"TECHNIQUE [SETTING=VALUE]...\": measured too, as a budget of its own (irradiance-cache "
                "cache.samples=64)");
  app.addOption("--frames", options->frames, "moments").range(2, 100000).showDefault();
  app.addOption("--fps", options->fps, "moments a second of the scene's time").range(1e-6, 1e6).showDefault();
  app.addOption("--time", options->time, "seconds at the first moment").range(-1e12, 1e12).showDefault();
  app.addOption("--reference-samples", options->samples, "paths a pixel of each reference")
      .range(16u, 1u << 24)
      .showDefault();
  app.addOption("--late", options->late, "draw the picture of so many moments before: a known lag, to check the figure")
      .range(0, 1000)
      .showDefault();
  app.addFlag("--live", options->live, "one frame a moment, as in the window, not each picture to its end");
  app.addOption("--camera", options->camera, "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  app.addOption("--keys", options->keys,
                "key frames of what is carried, and of the camera, which goes from the first to the last");
  app.addOption("--references", options->references, "folder of the references (LUCERNA_REFERENCES)");
  app.addOption("--out", options->out, "folder for dynamic.html, dynamic.json and the pictures").showDefault();
  options->part.declare(app, "moments");
  options->picture.declare(app);
  options->common.declare(app);
  return [options] { return runDynamic(*options); };
}

}  // namespace lucerna::demo
