#include "render/ask.hpp"

#include "base/angles.hpp"
#include "gl/pass.hpp"
#include "render/renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lucerna {

namespace {

glm::dvec3 texelAt(const gl::Texture& texture, glm::ivec2 fromBelow) {
  const gl::Texture one("asked pixel", texture.format(), glm::ivec2(1));
  gl::copyTexels(texture, fromBelow, one, {0, 0}, {1, 1});
  return glm::dvec3(glm::vec3(one.readRgba().front()));
}

std::string nameOfTriangle(const Scene& scene, std::uint32_t triangle) {
  for (const Mesh& mesh : scene.meshes)
    if (3 * triangle >= mesh.firstIndex && 3 * triangle < mesh.firstIndex + mesh.indexCount)
      return fmt::format("triangle {} ({})", triangle, scene.materials[static_cast<std::size_t>(mesh.material)].name);
  return fmt::format("triangle {}", triangle);
}

/// Names of the lamps in the table that light samples are drawn from: the order of rays/light_table.cpp, without dark
/// lamps.
std::vector<std::string> namesOfLamps(const Scene& scene) {
  std::vector<std::string> names;
  const auto shines = [](const glm::vec3& c) { return c.x > 0.0f || c.y > 0.0f || c.z > 0.0f; };
  if (scene.sun && shines(scene.sun->irradiance)) names.emplace_back("sun");
  for (std::size_t i = 0; i < scene.spots.size(); ++i)
    if (shines(scene.spots[i].intensity)) names.push_back(fmt::format("spot {}", i + 1));
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    if (shines(scene.points[i].intensity)) names.push_back(fmt::format("point {}", i + 1));
  return names;
}

PixelShare shareOf(const Scene& scene, const std::vector<std::string>& lamps, const PathTracer::AskedLight& light) {
  PixelShare share;
  switch (light.kind) {
    case PATH_LIGHT_TRIANGLE: share.name = nameOfTriangle(scene, light.number); break;
    case PATH_LIGHT_ENVIRONMENT: share.name = "sky"; break;
    case PATH_ASKED_MEDIUM: share.name = "a medium that shines"; break;
    case PATH_ASKED_BACKGROUND: share.name = "background"; break;
    default: share.name = light.number < lamps.size() ? lamps[light.number] : "a lamp";
  }
  constexpr std::uint32_t kMostApart = 8;  // light in media is scattered hundreds of times
  share.group = light.scatterings == 0            ? "seen directly"
                : light.scatterings == 1          ? "direct"
                : light.scatterings <= kMostApart ? fmt::format("scattered {} times", light.scatterings)
                                                  : fmt::format("scattered over {} times", kMostApart);
  share.places = light.places;
  const double reach = glm::length(scene.bounds.extent());
  share.places.push_back(light.infinite ? light.places.back() + reach * light.end : light.end);
  return share;
}

}  // namespace

PixelAnswer askPaths(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene, const Camera& camera,
                     PathTracer::Settings settings, std::uint32_t samples, glm::ivec2 pixel) {
  settings.askedPixel = glm::ivec2(pixel.x, settings.size.y - 1 - pixel.y);
  PathTracer tracer(context, programs, scene, settings);
  tracer.setCamera(camera);
  PixelAnswer answer;
  answer.pixel = pixel;
  answer.technique = "path";
  answer.samples = samples;
  const std::vector<std::string> lamps = namesOfLamps(scene);
  const double each = 1.0 / samples;
  std::map<std::uint32_t, glm::dvec3> ofSample;
  // Beyond this number the faintest are only counted: a pixel has thousands of paths.
  constexpr std::size_t kMost = 4096;
  constexpr std::uint32_t kStep = 1024;
  for (std::uint32_t done = 0; done < samples; done = tracer.samples()) {
    tracer.record(std::min(samples, done + kStep));
    for (const PathTracer::AskedLight& light : tracer.takeAsked()) {
      ofSample.try_emplace(light.sample, 0.0).first->second += glm::dvec3(light.radiance);
      answer.shares.push_back(shareOf(scene, lamps, light));
      answer.shares.back().radiance = each * glm::dvec3(light.radiance);
    }
    if (answer.shares.size() > kMost) answer.condense(64);
  }
  glm::dvec3 squares(0.0);
  for (const auto& [sample, radiance] : ofSample) answer.radiance += each * radiance;
  for (const auto& [sample, radiance] : ofSample)
    squares += (radiance - answer.radiance) * (radiance - answer.radiance);
  squares += static_cast<double>(samples - ofSample.size()) * answer.radiance * answer.radiance;  // without light
  if (samples > 1) answer.standardError = glm::sqrt(squares / (static_cast<double>(samples) * (samples - 1.0)));
  return answer;
}

// ---------------------------------------------------------------------------------------------------- other techniques

namespace {

void add(PixelAnswer& answer, const std::string& group, const std::string& name, const glm::dvec3& radiance,
         std::vector<glm::dvec3> places = {}) {
  if (radiance == glm::dvec3(0.0)) return;
  PixelShare share;
  share.group = group;
  share.name = name;
  share.radiance = radiance;
  share.places = std::move(places);
  answer.shares.push_back(std::move(share));
}

}  // namespace

AskedTerms Renderer::drawAsked(gl::ProgramLibrary& programs, const FrameView& view, glm::ivec2 fromBelow) {
  AskedTerms terms;
  const SurfacePrograms asked = surfacePrograms(programs, true);
  bindFrameConstants(view);
  bindForShading();
  terms.bind();
  using Sides = RadiosityFrame::Sides;
  const Sides both;
  for (const Sides& sides : radiosity_ ? RadiosityFrame::sides() : std::span<const Sides>(&both, 1)) {
    gl::RasterState state;
    state.depth = gl::Depth::equalReadOnly;
    state.cull = sides.cull;
    state.polygonOffset = sides.polygonOffset;
    const gl::RasterPass pass("asked pixel", radianceTarget_, state);
    pass.restrictTo(fromBelow, {1, 1});
    for (const gl::Program* program : {asked.opaque, asked.masked})
      if (program) program->set("askedPixel", fromBelow);
    gpuScene_->draw(asked, view.drawn());
    gl::memoryBarrier(gl::Barrier::storage);  // both sides write the terms
  }
  terms.read();
  return terms;
}

PixelAnswer Renderer::ask(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                          const Camera& camera, glm::ivec2 pixel) {
  const glm::ivec2 fromBelow(pixel.x, settings_.size.y - 1 - pixel.y);
  if (path_) {
    constexpr std::uint32_t kMostSamples = 4096;
    const std::uint32_t samples = path_->tracer().samples() > 0 ? path_->tracer().samples() : settings_.path.samples;
    return askPaths(context, programs, scene, camera, path_->tracer().settings(), std::min(samples, kMostSamples),
                    pixel);
  }
  PixelAnswer answer;
  answer.pixel = pixel;
  answer.technique = nameOf(settings_.technique);
  answer.radiance = texelAt(radiance_, fromBelow);
  const FrameView view = viewOf(camera, camera);
  const AskedTerms terms = drawAsked(programs, view, fromBelow);
  if (terms.fourth(ASKED_POSITION) != 1.0f) {  // no surface, or a patch's back
    add(answer, "seen directly", "what lies behind the scene", answer.radiance);
    return answer;
  }
  const glm::dvec3 position = glm::dvec3(terms[ASKED_POSITION]) + origin_;
  answer.surface = PixelAnswer::Surface{position, glm::dvec3(terms[ASKED_NORMAL]), glm::dvec3(terms[ASKED_ALBEDO])};
  add(answer, "emission", "the surface itself", glm::dvec3(terms[ASKED_EMISSION]), {position});
  const glm::dvec3 ofSurface(terms[ASKED_RADIANCE]);
  if (radiosity_) answerOfPatches(context, programs, scene, terms, answer);
  else answerOfForward(programs, view, terms, fromBelow, answer);
  if (shafts_) add(answer, "medium", "light shafts, less what the medium takes", answer.radiance - ofSurface);
  if (rsm_ && rsm_->showsRefused()) answer.radiance = ofSurface;  // the picture may be painted red here
  return answer;
}

void Renderer::answerOfForward(gl::ProgramLibrary& programs, const FrameView& view, const AskedTerms& terms,
                               glm::ivec2 fromBelow, PixelAnswer& answer) {
  const glm::dvec3 position = answer.surface->position;
  const Scene& scene = gpuScene_->scene();
  const double reach = glm::length(scene.bounds.extent());
  if (scene.sun)
    add(answer, "direct", "sun", glm::dvec3(terms[ASKED_SUN]), {position, position - reach * scene.sun->direction});
  const auto lamps = [&](const char* kind, const std::vector<LightViews>& lights, std::size_t first) {
    for (std::size_t i = 0; i < lights.size() && localLights_; ++i)
      add(answer, "direct", fmt::format("{} {}", kind, lights[i].index + 1), glm::dvec3(terms[first + i]),
          {position, lights[i].position + origin_});
  };
  lamps("spot", spots_, ASKED_SPOTS);
  lamps("point", points_, ASKED_POINTS);

  const glm::dvec3 reflection = answer.surface->albedo / kPi;
  const glm::vec3 place = terms[ASKED_POSITION];
  if (rsm_) {
    // Samples of one texel, from several gather points joined by interpolation, form one share.
    std::map<std::array<int, 4>, PixelShare> texels;
    for (const AskedPart& part : rsm_->ask(timer_, view, fromBelow)) {
      PixelShare& share = texels[{part.number.x, part.number.y, part.number.z, part.number.w}];
      share.group = "rsm";
      share.name = fmt::format("texel {}, {} of map {}{}", part.number.x, part.number.y, part.number.w + 1,
                               part.number.z > 0 ? fmt::format(", face {}", part.number.z) : "");
      share.radiance += reflection * glm::dvec3(part.irradiance);
      share.places = {position, glm::dvec3(part.place) + origin_};
    }
    for (auto& [texel, share] : texels) answer.shares.push_back(std::move(share));
    return;
  }
  if (!lpv_ && !cache_) return;
  const std::vector<AskedPart> parts = lpv_ ? lpv_->volume().ask(programs, place, terms[ASKED_NORMAL])
                                            : cache_->cache().ask(place, terms[ASKED_MESH_NORMAL]);
  std::map<int, glm::dvec3> ofCascade;
  for (const AskedPart& part : parts) {
    const glm::dvec3 irradiance(part.irradiance);
    ofCascade.try_emplace(part.number.w, 0.0).first->second += irradiance;
    const std::string where =
        fmt::format("{} {} {} of cascade {}", part.number.x, part.number.y, part.number.z, part.number.w + 1);
    add(answer, lpv_ ? "lpv" : "irradiance cache", (lpv_ ? "cell " : "record ") + where, reflection * irradiance,
        {position, glm::dvec3(part.place) + origin_});
    if (reflection * irradiance == glm::dvec3(0.0)) continue;  // nothing was added: no light, or a black surface
    answer.shares.back().weight = part.weight;
    if (lpv_) answer.shares.back().lobe = {part.red, part.green, part.blue};
  }
  glm::dvec3 cut(0.0);  // the lookup clamps each channel of a cascade at 0
  for (const auto& [cascade, sum] : ofCascade) cut += glm::max(sum, glm::dvec3(0.0)) - sum;
  if (lpv_) {
    add(answer, "lpv", "light below 0, cut off", reflection * cut, {position});
    add(answer, "lpv", "glossy reflection", glm::dvec3(terms[ASKED_GLOSSY]), {position});
  }
}

void Renderer::answerOfPatches(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                               const AskedTerms& terms, PixelAnswer& answer) {
  const RadiosityView& shown = radiosity_->view();
  const RadiositySolution& solution = shown.solution();
  const glm::dvec3 position = answer.surface->position, reflection = answer.surface->albedo / kPi;
  const auto patch = static_cast<std::uint32_t>(std::lround(terms.fourth(ASKED_CORNERS)));
  answer.surface->normal = solution.mesh.patches[patch].faceNormal;
  const bool byPixel = shown.takesDirectRays();
  if (byPixel) {
    const std::size_t emitters = DirectRays::emitterCount(scene);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < emitters; ++i) names.push_back(fmt::format("emissive triangle {}", i + 1));
    if (scene.sun) names.emplace_back("sun");
    for (std::size_t i = 0; i < scene.spots.size(); ++i) names.push_back(fmt::format("spot {}", i + 1));
    for (std::size_t i = 0; i < scene.points.size(); ++i) names.push_back(fmt::format("point {}", i + 1));
    glm::dvec3 rest =
        glm::dvec3(terms[ASKED_RADIANCE] - terms[ASKED_EMISSION]) - reflection * glm::dvec3(terms[ASKED_INDIRECT]);
    for (std::size_t i = 0; i < names.size() && ASKED_LIGHTS + i < AskedTerms::kCount; ++i) {
      add(answer, "direct", names[i], glm::dvec3(terms[ASKED_LIGHTS + i]));
      rest -= glm::dvec3(terms[ASKED_LIGHTS + i]);
    }
    if (ASKED_LIGHTS + names.size() > AskedTerms::kCount) add(answer, "direct", "more lamps", rest);
  }
  const RadiosityOrigins origins = originsOf(context, programs, scene, solution, settings_.radiosity.solution, patch,
                                             glm::dvec3(terms[ASKED_CORNERS]), settings_.radiosity.flat);
  const bool hasDirect = settings_.component != Component::indirect,
             hasIndirect = settings_.component != Component::direct;
  if (hasDirect && !byPixel)
    add(answer, "direct", "lamps, of the patches around", reflection * origins.lamps, {position});
  if (hasDirect) add(answer, "direct", "sky, of the patches around", reflection * origins.sky, {position});
  constexpr const char* kRepair = "repair of the form factors";
  if (hasDirect && !byPixel) add(answer, "direct", kRepair, reflection * origins.repairOfEmitted, {position});
  if (hasIndirect) add(answer, "patches", kRepair, reflection * origins.repairOfReflected, {position});
  for (const RadiosityOrigins::FromPatch& from : origins.patches) {
    const glm::dvec3 place = solution.mesh.patches[from.patch].centroid;
    if (hasDirect && !byPixel)
      add(answer, "direct", fmt::format("emissive patch {}", from.patch), reflection * from.emitted, {position, place});
    if (!hasIndirect) continue;
    add(answer, "patches", fmt::format("patch {}", from.patch), reflection * from.reflected, {position, place});
    if (from.reflected != glm::dvec3(0.0)) answer.shares.back().weight = from.factor;
  }
}

}  // namespace lucerna
