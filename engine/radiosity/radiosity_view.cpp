#include "radiosity/radiosity_view.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "gl/limits.hpp"
#include "radiosity/solution_watch.hpp"

#include <fmt/ranges.h>

#include <algorithm>

namespace lucerna {

namespace {

constexpr GLuint kLightBinding = 0, kFacesBinding = 2;  // 1: direct light

RadiositySolution solveOrLoad(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                              const RadiosityView::Settings& settings, const RadiositySolution* before) {
  gl::requireWithin(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, 2, "the view of a radiosity solution");
  const auto solve = [&](const std::filesystem::path& checkpoint) {
    RadiositySolutionSettings asked = settings.solution;
    const double seconds = SolutionWatch::secondsOfChunk(), usual = asked.hemicubes.secondsOfChunk;
    asked.hemicubes.unmeasuredIterations *= seconds / usual;
    asked.hemicubes.secondsOfChunk = seconds;
    return solveScene(context, programs, scene, asked, checkpoint, SolutionWatch::innermostOnStage(), before);
  };
  if (before) return solve({});
  if (!settings.file.empty() && std::filesystem::exists(settings.file)) {
    RadiositySolution solution = loadSolution(settings.file, scene);
    if (activeRadiosityDeviations(solution.deviations) != activeRadiosityDeviations(settings.solution.deviations))
      throwBadInput("{}: solved with other deviations ({}): name another file", settings.file.string(),
                    fmt::join(activeRadiosityDeviations(solution.deviations), ", "));
    checkSettings(settings.file, solution, settings.solution);
    return solution;
  }
  std::filesystem::path checkpoint = settings.file;
  if (!checkpoint.empty()) checkpoint += ".part";
  else checkpoint = SolutionWatch::checkpointOf(scene, settings.solution);
  RadiositySolution solution = solve(checkpoint);
  if (!settings.file.empty()) saveSolution(settings.file, scene, solution);
  SolutionWatch::solved(checkpoint);
  return solution;
}

}  // namespace

RadiosityView::RadiosityView(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                             const Settings& settings, const glm::dvec3& origin, const RadiositySolution* before)
    : settings_(settings),
      solution_(solveOrLoad(context, programs, scene, settings, before)),
      lit_(litScene(scene, solution_.mesh, origin)) {
  std::vector<glm::dvec3> patchLight = solution_.irradiance;
  for (std::size_t i = 0; i < patchLight.size(); ++i) {
    // Light with potentially sharp shadows is computed per pixel; the sky's light always comes from the patches.
    const glm::dvec3 lamps = solution_.direct[i] + solution_.fromEmitters[i], sky = solution_.fromSky[i];
    const bool byPixel = settings.direct == Direct::pixels;
    if (settings.light == Light::direct) patchLight[i] = byPixel ? sky : lamps + sky;
    else if (settings.light == Light::indirect) patchLight[i] -= lamps + sky;
    else if (byPixel) patchLight[i] -= lamps;
  }
  const std::vector<glm::vec3> atVertices = interpolatedToVertices(solution_, patchLight);
  std::vector<float> corners;
  corners.reserve(9 * patchLight.size());
  for (std::size_t i = 0; i < patchLight.size(); ++i)
    for (const std::uint32_t vertex : solution_.mesh.patches[i].light) {
      const glm::vec3 value = settings.flat ? glm::vec3(patchLight[i]) : atVertices[vertex];
      for (int c = 0; c < 3; ++c) corners.push_back(value[c]);
    }
  light_ = gl::Buffer("radiosity light", corners.size() * sizeof(float), corners.data(), gl::Usage::staticDraw);
  if (settings.direct != Direct::pixels) return;
  // A face's plane, and the largest coordinate of the triangle that contains it, which determines the rounding error of
  // ray hits.
  std::vector<float> faces;
  for (const Patch& patch : solution_.mesh.patches) {
    const glm::vec3 normal(patch.faceNormal);
    glm::dvec3 largest(0.0);
    for (std::size_t k = 0; k < 3; ++k)
      largest = glm::max(largest,
                         glm::abs(glm::dvec3(scene.vertices[scene.indices[3 * patch.triangle + k]].position) - origin));
    faces.insert(faces.end(),
                 {normal.x, normal.y, normal.z,
                  static_cast<float>(glm::dot(glm::dvec3(normal), solution_.mesh.corners(patch)[0] - origin)),
                  static_cast<float>(std::max({largest.x, largest.y, largest.z}))});
  }
  faces_ = gl::Buffer("radiosity faces", faces.size() * sizeof(float), faces.data(), gl::Usage::staticDraw);
}

SurfacePrograms RadiosityView::loadPrograms(gl::ProgramLibrary& programs, const GpuScene& gpuScene,
                                            bool inspected) const {
  const auto load = [&](const char* name, bool masked) {
    gl::ShaderFlags flags = gpuScene.materialFlags(masked);
    flags.insert(flags.end(), {{"EMISSION", gpuScene.features().emission && settings_.light != Light::indirect},
                               {"MESH", settings_.mesh},
                               {"DIRECT_RAYS", takesDirectRays()},
                               {"ALPHA_MASKS", 0},
                               {"SHARED_STACK", 0},
                               {"INSPECTED", inspected}});
    return &programs.loadRaster(name, "radiosity/view.vert", "radiosity/view.frag", flags);
  };
  SurfacePrograms result;
  result.opaque = load("radiosity opaque", false);
  if (gpuScene.features().alphaMasks) result.masked = load("radiosity masked", true);
  return result;
}

const gl::Program* RadiosityView::loadMapping(gl::ProgramLibrary& programs) const {
  if (settings_.mapping == Mapping::tone) return nullptr;
  const gl::Program& program = programs.loadRaster("radiosity display", "lib/fullscreen.vert", "radiosity/display.frag",
                                                   {{"MAPPING", static_cast<int>(settings_.mapping)}});
  program.use();
  program.set("decades", settings_.decades);
  return &program;
}

void RadiosityView::bind() const {
  light_.bindStorage(kLightBinding);
  if (faces_.bytes() > 0) faces_.bindStorage(kFacesBinding);
}

}  // namespace lucerna
