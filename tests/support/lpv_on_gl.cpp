#include "support/lpv_on_gl.hpp"

#include "base/error.hpp"
#include "gl/pass.hpp"
#include "support/temp_folder.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <utility>

namespace lucerna::test {

namespace {

constexpr int kWidth = 64;  // of the hand-made maps

reference::Sh shOf(const glm::vec4& c, double scale) { return {scale * c.x, scale * glm::dvec3(c.y, c.z, c.w)}; }

}  // namespace

RsmTextures::RsmTextures(std::span<const RsmTexel> texels, double texelArea, gl::Format normalFormat)
    : texelArea_(static_cast<float>(texelArea)) {
  const int height = std::max(1, (static_cast<int>(texels.size()) + kWidth - 1) / kWidth);
  const glm::ivec3 size(kWidth, height, 1);
  const std::size_t count = static_cast<std::size_t>(kWidth) * static_cast<std::size_t>(height);
  std::vector<glm::vec4> positions(count), normals(count), fluxes(count), albedos(count);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const glm::vec3& f = texels[i].flux;
    if (std::isfinite(f.x + f.y + f.z)) largestFlux_ += static_cast<double>(std::max({f.x, f.y, f.z, 0.0f}));
    positions[i] = texels[i].position;
    normals[i] = texels[i].normal;
    albedos[i] = glm::vec4(texels[i].albedo, 1.0f);
    fluxes[i] = glm::vec4(texels[i].flux,
                          static_cast<float>(texelArea / std::max(static_cast<double>(texels[i].normal.w), 0.05)));
  }
  position_ = gl::Texture("test rsm position", gl::Format::rgba32f, size, {}, 1, gl::TextureKind::array);
  normal_ = gl::Texture("test rsm normal", normalFormat, size, {}, 1, gl::TextureKind::array);
  flux_ = gl::Texture("test rsm flux", gl::Format::rgba32f, size, {}, 1, gl::TextureKind::array);
  albedo_ = gl::Texture("test rsm albedo", gl::Format::rgba32f, size, {}, 1, gl::TextureKind::array);
  albedo_.upload(gl::Texels::rgbaFloat, albedos.data());
  position_.upload(gl::Texels::rgbaFloat, positions.data());
  normal_.upload(gl::Texels::rgbaFloat, normals.data());
  flux_.upload(gl::Texels::rgbaFloat, fluxes.data());
}

std::vector<reference::Vpl> vplsOf(std::span<const RsmTexel> texels, double texelArea) {
  std::vector<reference::Vpl> vpls;
  for (const RsmTexel& texel : texels) {
    if (!(texel.position.w > 0.5f)) continue;
    const double area = texelArea / std::max(static_cast<double>(texel.normal.w), 0.05);
    vpls.push_back(
        {glm::dvec3(texel.position), glm::dvec3(texel.normal), glm::dvec3(texel.flux), area, glm::dvec3(texel.albedo)});
  }
  return vpls;
}

reference::GridSpec gridOf(const Cascade& cascade, int cells) {
  return {glm::ivec3(cells), cascade.minimum(), cascade.cellSize};
}

LightPropagationVolume runVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                 const LpvSettings& settings, const LpvInputs& inputs, bool join) {
  LightPropagationVolume lpv(programs, capabilities, settings);
  lpv.place(inputs);
  lpv.inject(inputs);
  lpv.fillGeometryVolume(inputs);
  lpv.propagate();
  if (join) lpv.join();
  return lpv;
}

std::vector<reference::VolumeRgb> readVolume(const LpvVolume& volume, const LpvInputs& inputs) {
  const int cells = volume[0].size().x;
  CHECK(volume[0].size() == glm::ivec3(cells, cells, cells * static_cast<int>(inputs.cascades.size())), "{} cells",
        cells);
  std::vector<reference::VolumeRgb> result;
  for (const Cascade& cascade : inputs.cascades) result.push_back(reference::makeVolumeRgb(gridOf(cascade, cells)));
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const std::vector<glm::vec4> texels = volume[channel].readRgba();
    auto texel = texels.begin();
    for (reference::VolumeRgb& cascade : result) {
      const double s = cascade[channel].grid.cellSize;
      for (reference::Sh& cell : cascade[channel].cells)
        cell = shOf(*texel++, static_cast<double>(inputs.referenceIrradiance) * s * s);
    }
  }
  return result;
}

std::vector<reference::Volume> readGeometryVolume(const LightPropagationVolume& lpv, const LpvInputs& inputs) {
  const std::vector<glm::vec4> texels = lpv.geometryVolume()->readRgba();
  std::vector<reference::Volume> result;
  auto texel = texels.begin();
  for (const Cascade& cascade : inputs.cascades) {
    reference::Volume& volume =
        result.emplace_back(reference::geometryGrid(gridOf(cascade, lpv.settings().cascades.cells)));
    for (reference::Sh& cell : volume.cells) cell = shOf(*texel++, 1.0);
  }
  return result;
}

std::vector<glm::vec3> probeIrradiance(gl::ProgramLibrary& programs, const LightPropagationVolume& lpv,
                                       std::span<const Probe> probes) {
  std::vector<glm::vec4> packed;
  for (const Probe& probe : probes) {
    packed.emplace_back(probe.position, 0.0f);
    packed.emplace_back(probe.normal, 0.0f);
  }
  const gl::Buffer in("probes", packed.size() * sizeof(glm::vec4), packed.data(), gl::Usage::staticDraw);
  const gl::Buffer out("irradiances", probes.size() * sizeof(glm::vec4), nullptr, gl::Usage::streamRead);
  {
    const gl::ComputePass pass("probe");
    programs.loadCompute("lpv probe", "lpv/probe.comp", LightPropagationVolume::lookupFlags(lpv.settings())).use();
    lpv.bindForLookup();
    in.bindStorage(0);
    out.bindStorage(1);
    pass.dispatch(glm::ivec3(static_cast<int>(probes.size()), 1, 1), glm::ivec3(64, 1, 1));
  }
  std::vector<glm::vec3> result;
  for (const glm::vec4& value : out.read<glm::vec4>()) result.emplace_back(value);
  return result;
}

double relativeError(const reference::Volume& expected, const reference::Volume& actual) {
  double scale = 0.0, difference = 0.0;
  for (std::size_t i = 0; i < expected.cells.size(); ++i) {
    const reference::Sh apart = expected.cells[i] - actual.cells[i];
    for (const auto& [reference, error] :
         {std::pair{expected.cells[i].c0, apart.c0}, std::pair{expected.cells[i].c1.x, apart.c1.x},
          std::pair{expected.cells[i].c1.y, apart.c1.y}, std::pair{expected.cells[i].c1.z, apart.c1.z}}) {
      if (!std::isfinite(error)) return std::numeric_limits<double>::infinity();
      scale = std::max(scale, std::abs(reference));
      difference = std::max(difference, std::abs(error));
    }
  }
  return difference == 0.0 ? 0.0 : difference / scale;
}

double relativeError(const reference::VolumeRgb& expected, const reference::VolumeRgb& actual) {
  double error = 0.0;
  for (std::size_t channel = 0; channel < 3; ++channel)
    error = std::max(error, relativeError(expected[channel], actual[channel]));
  return error;
}

double filterStep() {
  static const double step = [] {
    const TempFolder folder;
    folder.write("filter.comp",
                 "layout(local_size_x = 64) in;\nlayout(binding = 0) uniform sampler2D ramp;\n"
                 "layout(std430, binding = 0) writeonly buffer Read { float read[]; };\n"
                 "void main() {\n  float x = (float(gl_GlobalInvocationID.x) + 0.5) / 4096.0;\n"
                 "  read[gl_GlobalInvocationID.x] = textureLod(ramp, vec2(0.25 + 0.5 * x, 0.5), 0.0).x;\n}\n");
    gl::ProgramLibrary programs(folder.path());
    gl::Texture ramp("ramp", gl::Format::r32f, glm::ivec2(2, 1),
                     {.minFilter = gl::Filter::linear, .magFilter = gl::Filter::linear});
    constexpr float kRamp[2] = {0.0f, 1.0f};
    ramp.upload(gl::Texels::redFloat, kRamp);
    const gl::Buffer read("read", 4096 * sizeof(float), nullptr, gl::Usage::dynamicRead);
    {
      const gl::ComputePass pass("filter");
      programs.loadCompute("filter", "filter.comp").use();
      ramp.bind(0);
      read.bindStorage(0);
      pass.dispatch(glm::ivec3(4096, 1, 1), glm::ivec3(64, 1, 1));
    }
    double most = 0.0, i = 0.5;
    for (const float weight : read.read<float>())
      most = std::max(most, std::abs(static_cast<double>(weight) - i++ / 4096.0));
    return most < 1e-5 ? 0.0 : most;
  }();
  return step;
}

double offByFilters(const glm::dvec3& p, std::span<const double> cellSizes,
                    const std::function<double(const glm::dvec3&)>& lookup) {
  if (filterStep() == 0.0) return 0.0;
  const double here = lookup(p);
  double off = 0.0;
  for (const double size : cellSizes)
    for (int axis = 0; axis < 3; ++axis) {
      double most = 0.0;
      for (const double way : {-filterStep(), filterStep()}) {
        glm::dvec3 moved = p;
        moved[axis] += way * size;
        most = std::max(most, std::abs(lookup(moved) - here));
      }
      off += most;
    }
  return off;
}

std::vector<Cascade> unitCascade(int cells, double cellSize) {
  Cascade cascade;
  cascade.cellSize = cellSize;
  cascade.centre = glm::dvec3(0.5 * cells * cellSize);
  return {cascade};
}

void report(const char* what, double value) { std::cout << "[ measured ] " << what << ": " << value << "\n"; }

}  // namespace lucerna::test
