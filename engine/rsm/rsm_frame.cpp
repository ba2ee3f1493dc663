#include "rsm/rsm_frame.hpp"

#include "base/angles.hpp"
#include "shared/bindings.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

namespace lucerna {

RsmFrame::RsmFrame(const FrameParts& parts)
    : parts_(parts),
      maps_(parts, false),
      visible_(parts.programs, parts.drawn(), parts.depth),
      gather_(parts.programs, {parts.features.directionalLight, !parts.spots.empty(), !parts.points.empty()},
              parts.settings.of<RsmGather::Settings>(), visible_, parts.settings.unmeasuredIterations) {}

void RsmFrame::resize() {
  visible_.resize(parts_.depth);
  gather_.resize();
}

RsmGather::Inputs RsmFrame::inputsOf(gl::TimeQuery& timer, const FrameView& view) {
  RsmGather::Inputs inputs{
      {}, glm::mat4(glm::inverse(view.clip)), static_cast<float>(2.0 * view.camera.halfHeight() / visible_.size().y)};
  auto spot = parts_.spots.begin(), point = parts_.points.begin();
  for (const ReflectiveShadowMap::Outputs& map : maps_.record(timer)) {
    using Light = ReflectiveShadowMap::Light;
    inputs.maps.push_back({map, map.light == Light::spot ? &*spot++ : map.light == Light::point ? &*point++ : nullptr});
  }
  return inputs;
}

bool RsmFrame::record(gl::TimeQuery& timer, const FrameView& view, FrameEffort) {
  const RsmGather::Inputs inputs = inputsOf(timer, view);
  {
    const gl::TimeQuery::Scope stage(timer, "geometry");
    visible_.record(parts_.drawn(), view.drawn());
  }
  if (gather_.settings().interpolates()) {
    timer.begin("gather low");
    gather_.gatherLow(inputs);
    timer.end();
    const gl::TimeQuery::Scope stage(timer, "interpolation");
    gather_.interpolate(inputs);
  }
  const gl::TimeQuery::Scope stage(timer, "gather full");
  gather_.gatherFull(inputs);
  return true;
}

void RsmFrame::bindForShading() const { gather_.irradiance().bind(UNIT_GATHERED); }

void RsmFrame::addShares(const InspectedPixel& pixel, PixelInspection& answer) {
  const glm::dvec3 reflection = answer.surface->albedo / kPi;
  // Samples of one texel, from several gather points joined by interpolation, form one share.
  std::map<std::array<int, 4>, PixelShare> texels;
  for (const InspectedPart& part :
       gather_.inspect(parts_.programs, inputsOf(pixel.timer, pixel.view), pixel.fromBelow)) {
    PixelShare& share = texels[{part.number.x, part.number.y, part.number.z, part.number.w}];
    share.group = "rsm";
    share.name = fmt::format("texel {}, {} of map {}{}", part.number.x, part.number.y, part.number.w + 1,
                             part.number.z > 0 ? fmt::format(", face {}", part.number.z) : "");
    share.radiance += reflection * glm::dvec3(part.irradiance);
    share.places = {answer.surface->position, glm::dvec3(part.place) + parts_.origin};
  }
  for (auto& [texel, share] : texels) answer.shares.push_back(std::move(share));
  // The picture may be painted red here.
  if (gather_.settings().showRefused) answer.radiance = glm::dvec3(pixel.terms[INSPECTED_RADIANCE]);
}

void RsmFrame::addStagePictures(std::vector<StagePicture>& pictures) const {
  maps_.addStagePictures(pictures);
  pictures.push_back({StagePicture::Kind::normal, "normals", &visible_.normal()});
}

std::string RsmFrame::summary() const {
  const RsmGather::Counts& c = gather_.counts();
  if (c.frames == 0) return "";
  return fmt::format(
      "gathered {} of {} pixels per frame ({} refused by interpolation), {:.1f} % saved\n"
      "reflected light passes through walls\n",
      c.perFrame(c.gathered), c.perFrame(c.pixels), c.perFrame(c.refused), 100.0 * c.saving());
}

}  // namespace lucerna
