#include "radiosity/hemicube_methods.hpp"

#include "base/error.hpp"
#include "gl/draw.hpp"
#include "rays/ray_scene.hpp"

#include <algorithm>
#include <array>

namespace lucerna {

namespace {

constexpr GLuint kItemsUnit = 56, kList = 7;
constexpr gl::Barrier kStorage = gl::Barrier::storage, kWithCounts = kStorage | gl::Barrier::command;
constexpr int kGroup = HemicubeBatch::kGroup;

}  // namespace

// ---------------------------------------------------------------------------------------------------- raster

RasterMethod::RasterMethod(gl::ProgramLibrary& programs, HemicubeBatch& batch)
    : HemicubeMethod(batch),
      points_(programs.loadCompute("hemicube points", "radiosity/hemicube_points.comp",
                                   {{"SUM", 0}, {"ITEMS", 0}, {"DRAWN", 0}})),
      depth_(programs.loadCompute("hemicube depth", "radiosity/hemicube_depth.comp", {{"LARGE", 0}})),
      depthLarge_(programs.loadCompute("hemicube depth large", "radiosity/hemicube_depth.comp", {{"LARGE", 1}})),
      pointFactors_(programs.loadCompute("hemicube point factors", "radiosity/hemicube_points.comp",
                                         {{"SUM", 1}, {"ITEMS", 0}, {"DRAWN", 0}})) {}

void RasterMethod::findVisible(const HemicubeRange& range) {
  batch_.pixels().clear();
  batch_.factors().clear();
  const glm::ivec3 lists = batch_.groupsOfLists(range);
  {
    const gl::ComputePass pass(points_.name(), kStorage);
    batch_.use(points_, range);
    pass.dispatch(batch_.groupsOfBlocks(), glm::ivec3(1));
  }
  {
    const gl::ComputePass pass(depth_.name(), kWithCounts);
    batch_.use(depth_, range);
    pass.dispatch(lists, glm::ivec3(1));
  }
  {
    const gl::ComputePass pass(depthLarge_.name(), kStorage | gl::Barrier::textureFetch);
    batch_.use(depthLarge_, range);
    pass.dispatchIndirect(batch_.largeList());
  }
  const gl::ComputePass pass(pointFactors_.name(), kStorage);
  batch_.use(pointFactors_, range);
  pass.dispatch(lists, glm::ivec3(1));
}

void RasterMethod::dispatchOverPatches(const gl::ComputePass& pass, const HemicubeRange& range) const {
  pass.dispatch(batch_.groupsOfLists(range), glm::ivec3(1));
}

void RasterMethod::readFactors(gl::Staging& staging, DrawnHemicubes& drawn) const {
  drawn.factors = staging.read<float>(
      batch_.factors(), static_cast<std::size_t>(drawn.count) * static_cast<std::size_t>(drawn.patchCount));
}

// ---------------------------------------------------------------------------------------------------- lists

ListingMethod::ListingMethod(HemicubeBatch& batch)
    : HemicubeMethod(batch),
      list_("kept patches", 16 + batch.mostListed() * sizeof(glm::uvec2), nullptr, gl::Usage::dynamicCopy) {}

void ListingMethod::startList(const HemicubeRange& range) {
  // The head of the list is an indirect dispatch with a lane per entry, and the number of entries.
  const auto sources = static_cast<GLuint>(range.count * batch_.smallSourceCount());
  const GLuint head[4] = {(sources + kGroup - 1) / kGroup, 1, 1, sources};
  list_.upload(0, sizeof head, head);
  list_.bindStorage(kList);
}

void ListingMethod::dispatchOverPixels(const gl::ComputePass& pass, const HemicubeRange& range) const {
  // In rows along z, since an axis has 65,535 groups.
  constexpr int kRow = 1024 * kGroup;
  const int pixels = 3 * batch_.resolution() * batch_.resolution();
  pass.dispatch(glm::ivec3(std::min(pixels, kRow), range.count, (pixels + kRow - 1) / kRow), glm::ivec3(kGroup, 1, 1));
}

void ListingMethod::dispatchOverPatches(const gl::ComputePass& pass, const HemicubeRange&) const {
  pass.dispatchIndirect(list_);
}

void ListingMethod::readFactors(gl::Staging& staging, DrawnHemicubes& drawn) const {
  constexpr std::size_t kHead = 2;  // in entries
  const std::size_t count = staging.readFirst<std::array<GLuint, 4>>(list_)[3];
  drawn.kept = staging.read<glm::uvec2>(list_, kHead + count);
  drawn.kept.erase(drawn.kept.begin(), drawn.kept.begin() + kHead);
}

// ---------------------------------------------------------------------------------------------------- rays

RayMethod::RayMethod(gl::ProgramLibrary& programs, HemicubeBatch& batch, const RayScene& rays)
    : ListingMethod(batch),
      rays_(rays),
      trace_(programs.loadCompute("hemicube rays", "radiosity/hemicube_rays.comp",
                                  {{"ALPHA_MASKS", 0}, {"SHARED_STACK", rays.sharedStack()}})) {}

void RayMethod::findVisible(const HemicubeRange& range) {
  startList(range);
  const gl::ComputePass pass(trace_.name(), kWithCounts);
  batch_.use(trace_, range);
  rays_.bind();
  trace_.set("raysOrigin", glm::vec3(rays_.origin()));
  dispatchOverPixels(pass, range);
}

// ---------------------------------------------------------------------------------------------------- item buffer

ItemBufferMethod::ItemBufferMethod(gl::ProgramLibrary& programs, HemicubeBatch& batch)
    : ListingMethod(batch),
      noAttributes_("hemicube items"),
      draw_(programs.loadRaster("hemicube items", "radiosity/hemicube_item.vert", "radiosity/hemicube_item.frag", {},
                                "radiosity/hemicube_item.geom")),
      listItems_(programs.loadCompute("hemicube items sum", "radiosity/hemicube_items.comp")) {
  const glm::ivec3 layers(batch.resolution(), batch.resolution(), 5 * batch.capacity());
  items_ = gl::Texture("hemicube items", gl::Format::r32ui, layers, {}, 1, gl::TextureKind::array);
  depth_ = gl::Texture("hemicube depth", gl::Format::depth32f, layers, {}, 1, gl::TextureKind::array);
  const std::array<const gl::Texture*, 1> colors{&items_};
  target_ = gl::Framebuffer("hemicube items", colors, &depth_);
}

void ItemBufferMethod::drawItems(const HemicubeRange& range) const {
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  const gl::RasterPass pass("hemicube items", target_, state);
  gl::clearWords(0, glm::uvec4(0u));
  pass.clearDepth();
  batch_.use(draw_, range);
  draw_.set("inverseFar", static_cast<float>(0.5 / batch_.extent()));
  noAttributes_.bind();
  gl::drawTriangles(3 * batch_.patchCount(), range.count);
}

void ItemBufferMethod::findVisible(const HemicubeRange& range) {
  startList(range);
  drawItems(range);
  const gl::ComputePass pass(listItems_.name(), kWithCounts);
  batch_.use(listItems_, range);
  items_.bind(kItemsUnit);
  dispatchOverPixels(pass, range);
}

std::unique_ptr<HemicubeMethod> makeHemicubeMethod(HemicubeVisibility visibility, gl::ProgramLibrary& programs,
                                                   HemicubeBatch& batch, const RayScene* rays) {
  switch (visibility) {
    case HemicubeVisibility::raster: return std::make_unique<RasterMethod>(programs, batch);
    case HemicubeVisibility::itemBuffer: return std::make_unique<ItemBufferMethod>(programs, batch);
    default: CHECK(visibility == HemicubeVisibility::rays && rays, "no method or no rays");
  }
  return std::make_unique<RayMethod>(programs, batch, *rays);
}

}  // namespace lucerna
