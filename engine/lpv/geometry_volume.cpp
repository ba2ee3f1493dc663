#include "lpv/geometry_volume.hpp"

#include "base/error.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"

#include <algorithm>

namespace lucerna {

namespace {

constexpr double kSmallestCosine = 0.05;  // bound of a texel's area in the reflective shadow map
constexpr GLuint kFacesBuffer = 3;  // storage block of lpv/geometry_faces.comp

}  // namespace

LpvGeometryVolume::LpvGeometryVolume(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities,
                                     const LpvSettings& settings)
    : settings_(settings), haveClearTexture_(capabilities.clearTexture), noAttributes_("lpv surfels") {
  const LpvGrid grid(settings);
  const LpvSettings::Deviations& deviations = settings.deviations;
  const bool reflects = settings.reflects();
  fill_ = &programs.loadRaster("lpv geometry volume", "lpv/inject.vert", "lpv/geometry_volume.frag",
                               {{"GRID_FULL_FLOAT", settings.storage == LpvSettings::Storage::full},
                                {"TRUNCATE", deviations.truncate},
                                {"SURFEL_AREA", deviations.surfelArea},
                                {"LOWEST_CELL", deviations.firstCell ? 1 : 0},
                                {"REFLECTS", reflects}},
                               "lpv/geometry_volume.geom");
  // Views are merged in place, in 32-bit images.
  potential_.emplace("lpv geometry volume", settings.mergeViews ? gl::Format::rgba32f : grid.summed, grid.corners,
                     kLpvSampling);
  const auto allocate = [&](const std::string& name, gl::Texture& reflectance, const gl::Texture& potential,
                            gl::Framebuffer& target) {
    std::vector<const gl::Texture*> targets{&potential};
    if (reflects) {
      reflectance = gl::Texture(name + " reflectance", gl::Format::rgba32f, grid.corners);
      targets.push_back(&reflectance);
    }
    target = gl::Framebuffer(name, targets);
  };
  allocate("lpv geometry volume", reflectance_, *potential_, target_);
  if (settings.mergeViews) {
    mergeViews_ = &programs.loadCompute("lpv merge views", "lpv/merge_views.comp",
                                        gl::with(grid.flags, {{"REFLECTS", reflects}}));
    viewPotential_ = gl::Texture("lpv view", gl::Format::rgba32f, grid.corners);
    allocate("lpv view", viewReflectance_, viewPotential_, viewTarget_);
  }
  // Merging several views, and the albedo for reflection, need blending, and glossy reflection the texture, whatever
  // the fill.
  if (settings.fill != LpvFill::layered && !countsHalfFloats(settings, capabilities) && !settings.mergeViews &&
      !reflects && !deviations.surfelArea && !settings.glossy) {
    const bool fixed = settings.fill == LpvFill::fixed;
    const gl::ShaderFlags fill{{"FILL_FIXED", fixed}, {"FILL_FLOAT", !fixed}, {"TRUNCATE", deviations.truncate}};
    count_ =
        &programs.loadCompute("lpv count surfels", "lpv/count_surfels.comp",
                              gl::with(gl::with(gl::with(grid.flags, fill), grid.lights), {{"TILE", settings.tile}}));
    if (fixed)
      resolve_ = &programs.loadCompute("lpv resolve", "lpv/resolve.comp",
                                       gl::with(gl::with(grid.flags, countFlags(settings, capabilities)), grid.lights));
    counts_ = lpvBuffer(capabilities, "lpv geometry volume's counts", gl::Format::rgba32f,
                        texelCount(grid.corners) * kLpvCellBytes);
  }
  if (settings.propagate != LpvPropagate::compute) return;
  const auto average = [&](bool fromBuffer) {
    return &programs.loadCompute("lpv geometry faces", "lpv/geometry_faces.comp",
                                 gl::with(gl::with(grid.flags, {{"FROM_BUFFER", fromBuffer}}), grid.kernel));
  };
  averageFaces_ = average(false);
  if (count_) averageCountedFaces_ = average(true);
  faces_ =
      lpvBuffer(capabilities, "lpv geometry faces", gl::Format::rgba32f, 3 * texelCount(grid.corners) * kLpvCellBytes);
}

void LpvGeometryVolume::fill(const LpvInputs& inputs) {
  Maps maps;
  if (settings_.surfels != LpvSurfels::camera)
    for (const ReflectiveShadowMap::Outputs& map : inputs.rsms) maps.push_back(&map);
  if (settings_.surfels != LpvSurfels::rsm)
    for (const ReflectiveShadowMap::Outputs& map : inputs.views) maps.push_back(&map);
  const bool counted = canCount(maps);
  if (counted) count(maps, inputs);
  else draw(maps, inputs);
  if (!averageFaces_) return;
  const gl::ComputePass pass("lpv geometry faces");
  if (counted) {
    averageCountedFaces_->use();
    counts_.bind(0);
  } else {
    averageFaces_->use();
    potential_->bind(0);
  }
  faces_.buffer().bindStorage(kFacesBuffer);
  pass.dispatch(potential_->size(), kLpvGroup);
}

// The unit of the integer counts is derived from the total area of all texels, known only for the sun's map.
bool LpvGeometryVolume::canCount(const Maps& maps) const {
  if (!count_) return false;
  return settings_.fill != LpvFill::fixed || std::ranges::all_of(maps, [](const ReflectiveShadowMap::Outputs* map) {
           return map->light == ReflectiveShadowMap::Light::sun;
         });
}

void LpvGeometryVolume::count(const Maps& maps, const LpvInputs& inputs) {
  // Upper bound of a coefficient: all texels of all maps in one cell of the finest cascade, at the steepest counted
  // angle.
  const double finest = inputs.cascades.front().cellSize;
  double area = 0.0;
  for (const ReflectiveShadowMap::Outputs* map : maps)
    area += map->texelCount() * static_cast<double>(map->texelArea) / kSmallestCosine;
  const float scale = fixedScale(settings_, 1.0233267079464885 * area / (finest * finest));
  counts_.clear();
  {
    const gl::ComputePass pass("lpv count surfels", gl::Barrier::textureFetch | gl::Barrier::storage);
    count_->use();
    count_->set("fixedScale", scale);
    counts_.buffer().bindStorage(kLpvWavefrontBuffer);
    for (const ReflectiveShadowMap::Outputs* map : maps) {
      map->bind();
      pass.dispatch(map->position.size(), kLpvGroup * glm::ivec3(settings_.tile, settings_.tile, 1));
    }
  }
  if (resolve_) resolveCounts(*resolve_, counts_, potential_->size(), 1, scale);
  potential_->copyFrom(counts_.buffer(), 0);
}

void LpvGeometryVolume::draw(const Maps& maps, const LpvInputs& inputs) {
  std::vector<const gl::Texture*> targets{&*potential_};
  if (settings_.reflects()) targets.push_back(&reflectance_);
  gl::clearToZero(targets, haveClearTexture_);
  bool merges = false;  // the first map needs no merging
  for (const ReflectiveShadowMap::Outputs* map : maps) {
    CHECK(!settings_.reflects() || map->albedo, "a map without albedo for {} bounces", settings_.bounces);
    if (merges) {
      std::vector<const gl::Texture*> view{&viewPotential_};
      if (settings_.reflects()) view.push_back(&viewReflectance_);
      gl::clearToZero(view, haveClearTexture_);
    }
    draw(*map, inputs, merges ? viewTarget_ : target_);
    if (merges) mergeView();
    merges = settings_.mergeViews;
  }
}

void LpvGeometryVolume::draw(const ReflectiveShadowMap::Outputs& map, const LpvInputs& inputs,
                             const gl::Framebuffer& target) {
  gl::RasterState state;
  state.blend = gl::Blend::add;
  const gl::RasterPass pass("lpv geometry volume", target, state);
  fill_->use();
  noAttributes_.bind();
  if (settings_.deviations.surfelArea) {
    const bool isSun = map.light == ReflectiveShadowMap::Light::sun;
    fill_->set("lightPosition", inputs.lightPosition);
    fill_->set("texelCount", isSun ? static_cast<float>(map.texelCount()) : 0.0f);
  }
  map.bind();
  gl::drawPoints(map.texelCount());
}

void LpvGeometryVolume::mergeView() {
  const gl::ComputePass pass(
      "lpv merge views", gl::Barrier::textureFetch | gl::Barrier::image | gl::Barrier::framebuffer, gl::Barrier::image);
  mergeViews_->use();
  viewPotential_.bind(0);
  potential_->bindImage(0, gl::Access::readWrite);
  if (settings_.reflects()) {
    viewReflectance_.bind(1);
    reflectance_.bindImage(1, gl::Access::write);
  }
  pass.dispatch(viewPotential_.size(), kLpvGroup);
}

std::size_t LpvGeometryVolume::gpuBytes() const {
  std::size_t bytes = counts_.bytes() + faces_.bytes();
  for (const gl::Texture* texture : {&*potential_, &reflectance_, &viewPotential_, &viewReflectance_})
    if (texture->id()) bytes += texture->bytes();
  return bytes;
}

}  // namespace lucerna
