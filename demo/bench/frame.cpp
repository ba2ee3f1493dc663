// lucerna bench frame SCENE -o PAGE.md: a frame pass by pass, as a page: what each pass does, its result as a picture,
// its time, and the error that it removes, measured against a path traced reference.
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/statistics.hpp"
#include "base/provenance.hpp"
#include "bench/bench.hpp"
#include "bench/error_bench.hpp"
#include "bench/frame_page.hpp"
#include "gl/draw.hpp"
#include "measure/heat_map.hpp"
#include "pathtracer/path_sampler.hpp"
#include "scene/scene_file.hpp"
#include "shared/shell.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna::demo {

namespace bench {

namespace {

namespace fs = std::filesystem;

struct FrameOptions {
  CommonOptions common;
  std::string scene, camera, size = "640x360", output, references;
  std::vector<std::string> techniques;
  std::uint64_t referenceSamples = 0;
  double budget = 120.0;
  int frames = 16;
};

/// What the measurements of all techniques share.
struct FrameBench {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  const Camera& camera;
  const measure::Reference& reference;
  Image seen;  ///< visible emission and background alone
  fs::path folder;  ///< of the pictures
  int frames;  ///< timed

  double errorOf(const Image& picture) const {
    return measure::lessNoise(measure::errorsOf(picture, reference.mean),
                              measure::noiseOf(reference.mean, reference.standardError, reference.meanError))
        .l2;
  }
  std::string keep(const std::string& name, const Bitmap& bitmap) const {
    std::string file = name + ".png";
    std::ranges::replace(file, ' ', '-');
    writePng(folder / file, bitmap);
    return file;
  }
};

Image combined(const Image& a, const Image& b, const std::function<glm::vec3(std::size_t)>& pixel) {
  Image result(a.width, a.height);
  CHECK(a.pixels.size() == b.pixels.size(), "pictures of {} and {} pixels", a.pixels.size(), b.pixels.size());
  for (std::size_t i = 0; i < result.pixels.size(); ++i) result.pixels[i] = pixel(i);
  return result;
}

RenderSettings settingsOf(const SweepPoint& asked, glm::ivec2 size) {
  RenderSettings settings = asked.picture.parse();
  settings.size = size;
  settings.pixelSamples = 1;
  settings.fullFloatTarget = true;
  settings.textures.anisotropy = 1.0f;  // differs between drivers
  settings.reuse = false;
  return settings;
}

Image finishedPicture(const FrameBench& bench, const RenderSettings& settings) {
  Renderer renderer(bench.context, bench.programs, bench.scene, settings);
  renderer.renderToTheEnd(bench.camera);
  return renderer.readRadiance();
}

/// Direct light of sun and lamps, emission and environment; the same with a sun's shadow map in which nothing is.
struct DirectLight {
  Image picture;
  std::optional<Image> unshadowed;
};

DirectLight directLight(const FrameBench& bench, RenderSettings settings) {
  settings.technique = "direct";
  settings.reuse = true;  // the shadow map is drawn once
  Renderer renderer(bench.context, bench.programs, bench.scene, settings);
  renderer.render(bench.camera);
  DirectLight result{renderer.readRadiance(), {}};
  for (const StagePicture& stage : renderer.stagePictures()) {
    if (stage.name != "shadow map") continue;  // cascades are drawn in every frame
    {
      const gl::Framebuffer target("empty shadow map", {}, stage.texture);
      gl::RasterState state;
      state.depth = gl::Depth::lessWrite;
      const gl::RasterPass pass("empty shadow map", target, state);
      pass.clearDepth();
    }
    renderer.render(bench.camera);
    result.unshadowed = renderer.readRadiance();
  }
  return result;
}

/// Left of the middle without the curve.
Bitmap toneMappedHalf(const Image& radiance, float exposure) {
  Bitmap bitmap = toneMapped(radiance, exposure);
  for (int y = 0; y < radiance.height; ++y)
    for (int x = 0; x < radiance.width / 2; ++x)
      for (int c = 0; c < 3; ++c)
        bitmap.rgba[static_cast<std::size_t>(4 * (y * radiance.width + x) + c)] = static_cast<std::uint8_t>(
            std::lround(255.0f * srgbFromLinear(std::clamp(exposure * radiance.at(x, y)[c], 0.0f, 1.0f))));
  return bitmap;
}

/// Times of the first frames of a view, in which every pass runs.
std::vector<MeasuredPass> timedPasses(Renderer& renderer, const FrameBench& bench) {
  renderer.render(bench.camera);  // the warm-up, whose times the timer drops
  renderer.forget();
  for (int frame = 0; frame < bench.frames && !interrupted(); ++frame) {
    renderer.render(bench.camera);
    gl::finish();
  }
  renderer.drain();
  const bool software = bench.context.capabilities().softwareRenderer;
  std::vector<MeasuredPass> passes;
  for (const gl::StageStatistics& stage : renderer.timer().statistics()) {
    const auto& samples =
        software ? renderer.timer().wallSamples(stage.name) : renderer.timer().querySamples(stage.name);
    passes.push_back(
        {&passNamed(stage.name), median(samples), percentile(samples, 0.05), percentile(samples, 0.95), false, {}});
  }
  return passes;
}

void findReused(Renderer& renderer, const FrameBench& bench, std::vector<MeasuredPass>& passes) {
  constexpr int kStillFrames = 4;
  RenderSettings settings = renderer.settings();
  settings.reuse = true;
  renderer.apply(settings);
  for (int i = 0; i < kStillFrames; ++i) renderer.render(bench.camera);
  renderer.timer().reset();
  for (int i = 0; i < kStillFrames; ++i) renderer.render(bench.camera);
  renderer.drain();
  for (const gl::StageStatistics& stage : renderer.timer().statistics())
    for (MeasuredPass& p : passes)
      if (p.pass->name == stage.name) p.runsStill = stage.ran > 0;
}

std::optional<MeasuredFrame> measureFrame(const FrameBench& bench, const SweepPoint& asked, glm::ivec2 size) {
  const RenderSettings settings = settingsOf(asked, size);
  MeasuredFrame frame{asked.label(), asked.picture.technique, {}, {}, "", {}};

  // Times, then the finished picture and the results of its passes.
  Renderer renderer(bench.context, bench.programs, bench.scene, settings);
  frame.passes = timedPasses(renderer, bench);
  if (interrupted()) return std::nullopt;
  renderer.renderToTheEnd(bench.camera);
  renderer.drain();
  const Image finished = renderer.readRadiance(), black(size.x, size.y);
  StageView stages(bench.programs);
  for (MeasuredPass& p : frame.passes) {
    const std::string name = fmt::format("{} {}", frame.technique, p.pass->name);
    if (const Bitmap sheet = stageSheet(*p.pass, renderer, stages, bench.scene); sheet.width > 0)
      p.pictures.push_back(bench.keep(name, sheet));
    if (p.pass->glyphs != Glyphs::none)
      p.pictures.push_back(bench.keep(
          name + " in the scene", glyphPicture(p.pass->glyphs, renderer, bench.programs, bench.scene, bench.camera)));
    if (p.pass->gives == Pass::Gives::display)
      p.pictures.push_back(bench.keep(name, toneMappedHalf(finished, bench.scene.exposure)));
  }
  const std::vector<float> depth = renderer.depth()->readDepth();
  findReused(renderer, bench, frame.passes);

  // The same pictures with less light.
  const auto has = [&](std::string_view name) {
    return std::ranges::any_of(frame.passes, [&](const MeasuredPass& p) { return p.pass->name == name; });
  };
  const auto lacking = [&](std::string_view setting) {
    SweepPoint less = asked;
    less.picture.settings.emplace_back(setting);
    return finishedPicture(bench, settingsOf(less, size));
  };
  const DirectLight direct = directLight(bench, settings);
  const Image clear = has("light shafts") ? lacking("lpv.shafts=off") : finished;
  const auto isSurface = [&](std::size_t i) {  // depth begins with the bottom row
    const std::size_t width = static_cast<std::size_t>(size.x);
    return depth[depth.size() - width * (i / width + 1) + i % width] < 1.0f;
  };
  const auto surfaces = [&](const Image& picture) {
    return has("environment")
               ? combined(picture, black,
                          [&](std::size_t i) { return isSurface(i) ? picture.pixels[i] : glm::vec3(0.0f); })
               : picture;
  };

  // Add light in the order of the frame.
  const auto add = [&](const char* name, std::string_view pass, const Image& picture) {
    frame.steps.push_back(
        {name, pass, bench.errorOf(picture),
         bench.keep(fmt::format("{} with {}", frame.technique, name), toneMapped(picture, bench.scene.exposure))});
  };
  const Image emission = surfaces(bench.seen);
  if (std::ranges::any_of(emission.pixels, [](const glm::vec3& p) { return p != glm::vec3(0.0f); }))
    add("emission", "shading", emission);
  if (bench.scene.sun || has("spot shadows") || has("point shadows"))
    add("direct light", "shading", surfaces(direct.picture));
  if (frame.technique != "direct") add("indirect light", "shading", surfaces(clear));
  if (has("environment")) add("environment", "environment", clear);
  if (has("light shafts")) add("light shafts", "light shafts", finished);
  frame.rest = bench.keep(frame.technique + " rest",
                          measure::heatMap(finished, bench.reference.mean, measure::HeatMap::signedLuminance,
                                           measure::heatMapScale(black, bench.reference.mean) * 0.2));

  if (!bench.scene.textures.empty()) frame.unfiltered = bench.errorOf(lacking("texture.mipmaps=off"));

  // Leave each pass out of the finished picture.
  for (MeasuredPass& p : frame.passes) {
    using Gives = Pass::Gives;
    const Gives gives = p.pass->gives;
    if (gives == Gives::sunShadows && direct.unshadowed)
      p.without = bench.errorOf(combined(finished, *direct.unshadowed, [&](std::size_t i) {
        return finished.pixels[i] + direct.unshadowed->pixels[i] - direct.picture.pixels[i];
      }));
    if (gives == Gives::surfaces)
      p.without = bench.errorOf(combined(
          finished, black, [&](std::size_t i) { return isSurface(i) ? glm::vec3(0.0f) : finished.pixels[i]; }));
    if (gives == Gives::indirect)
      p.without = bench.errorOf(p.pass->without.empty() ? direct.picture : lacking(p.pass->without));
    if (gives == Gives::environment) p.without = bench.errorOf(surfaces(finished));
    if (gives == Gives::shafts) p.without = bench.errorOf(clear);
    if (gives == Gives::display) p.without = frame.steps.back().error;
  }
  return frame;
}

std::string commandOf(const FrameOptions& options) {
  std::vector<std::string> words{"lucerna", "bench", "frame", options.scene, "--size", options.size};
  if (!options.camera.empty()) words.insert(words.end(), {"--camera", options.camera});
  for (const std::string& technique : options.techniques) words.insert(words.end(), {"--technique", technique});
  words.insert(words.end(), {"--frames", std::to_string(options.frames)});
  if (options.referenceSamples > 0)
    words.insert(words.end(), {"--reference-spp", std::to_string(options.referenceSamples)});
  else words.insert(words.end(), {"--budget", fmt::format("{:g}", options.budget)});
  words.insert(words.end(), {"-o", options.output});
  return shellCommand(words);
}

int runFrame(FrameOptions options) {
  // Check the request before any work.
  options.common.apply();
  checkWritable(options.output);
  options.scene = sceneOrAtrium(options.scene);
  if (options.techniques.empty()) options.techniques = {std::string(kDefaultTechnique)};
  std::vector<SweepPoint> asked;
  for (const std::string& text : options.techniques) {
    asked.push_back(parseSweepPoint(text, "--technique"));
    if (asked.back().picture.technique == "radiosity")
      throwBadInput(
          "--technique {}: its light is found before the first frame, in no pass; expected one of direct, "
          "rsm, lpv, irradiance-cache",
          text);
  }
  const glm::ivec2 size = parseSize(options.size);
  Scene scene = withoutHighlights(loadScene(options.scene));
  const Camera camera = chooseCamera(scene, options.camera);
  setDefaultExposure(scene, camera);
  const fs::path output = options.output, folder = output.parent_path() / output.stem();
  if (output.extension() != ".md") throwBadInput("-o {}: the extension must be md", options.output);

  // The reference of all light, shared with bench error.
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  watchForInterrupt();
  PathSampler sampler(context, programs, scene, camera, size, PixelFilter::centre, Transport::all);
  measure::SamplingGoal goal;
  goal.seconds = options.budget;
  goal.samples = options.referenceSamples;
  const auto reference = measure::obtainReference(
      measure::ReferenceCache(options.references.empty() ? measure::ReferenceCache::defaultFolder()
                                                         : fs::path(options.references)),
      measure::keyOf(scene, camera, size, Transport::all, sampler.version()), sampler.asSampler(), Transport::all, goal,
      context.capabilities().renderer, interrupted);
  if (!reference || interrupted()) return exitCode();

  // Measure each technique.
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throwBadInput("-o {}: cannot create folder {} ({})", options.output, folder.string(), error.message());
  const FrameBench bench{context,    programs,
                         scene,      camera,
                         *reference, seenLights(context, programs, scene, camera, size, PixelFilter::centre),
                         folder,     options.frames};
  FramePage page{scene.name,
                 fmt::format("camera {}, {}x{}", camera.name.empty() ? "default" : camera.name, size.x, size.y),
                 commandOf(options),
                 context.capabilities().renderer,
                 cpuName(),
                 programVersion(),
                 options.frames,
                 reference->samples,
                 measure::lessNoise(measure::errorsOf(Image(size.x, size.y), reference->mean),
                                    measure::noiseOf(reference->mean, reference->standardError, reference->meanError))
                     .noiseL2,
                 measure::heatMapScale(Image(size.x, size.y), reference->mean) * 0.2,
                 {}};
  for (const SweepPoint& point : asked) {
    auto frame = measureFrame(bench, point, size);
    if (!frame) return exitCode();
    page.frames.push_back(std::move(*frame));
  }
  writeFileAtomically(output, frameMarkdown(page, output.stem().string()));
  if (!options.common.quiet) fmt::print("{}\n", options.output);
  options.common.writeJson(frameJson(page));
  return 0;
}

}  // namespace

}  // namespace bench

Work addBenchFrame(Command app) {
  auto options = std::make_shared<bench::FrameOptions>();
  app.addOption("SCENE", options->scene, "a scene file (default: the atrium)").scene();
  app.addOption("-o,--output", options->output, "PAGE.md; its pictures go into a folder PAGE beside it").required();
  app.addOption("--technique", options->techniques,
                "\"TECHNIQUE [SETTING=VALUE]...\" of direct, rsm, lpv, irradiance-cache (default); several follow each "
                "other on the page");
  app.addOption("--camera", options->camera, "a camera's name, or px,py,pz,tx,ty,tz,fov (position, target, degrees)");
  app.addOption("--size", options->size, "WIDTHxHEIGHT of the pictures").showDefault();
  app.addOption("--frames", options->frames, "number of timed frames").showDefault().range(1, 10000);
  app.addOption("--references", options->references,
                "folder of cached references (default: LUCERNA_REFERENCES, or lucerna in the user's cache)");
  app.addOption("--budget", options->budget, "seconds for the reference; a known one is reused")
      .showDefault()
      .range(0.01, 1e6);
  app.addOption("--reference-spp", options->referenceSamples, "paths per pixel of the reference, instead of by time")
      .range(2, 1 << 30);
  options->common.declare(app);
  return [options] { return bench::runFrame(*options); };
}

}  // namespace lucerna::demo
