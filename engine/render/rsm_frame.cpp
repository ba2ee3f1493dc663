#include "render/rsm_frame.hpp"

#include "shared/bindings.h"

#include <cmath>

namespace lucerna {

RsmFrame::RsmFrame(const FrameParts& parts, const gl::Texture& depth)
    : parts_(parts),
      maps_(parts, {true, true}, false),
      visible_(parts.programs, parts.drawn, depth),
      gather_(parts.programs, parts.features, parts.settings.gather, visible_, parts.settings.unmeasuredIterations) {}

void RsmFrame::resize(const gl::Texture& depth) {
  visible_.resize(depth);
  gather_.resize();
}

RsmGather::Inputs RsmFrame::inputsOf(gl::TimeQuery& timer, const FrameView& view) {
  RsmGather::Inputs inputs{{},
                           glm::mat4(glm::inverse(view.clip)),
                           static_cast<float>(2.0 * std::tan(0.5 * view.camera.verticalFov) / visible_.size().y)};
  auto spot = parts_.spots.begin(), point = parts_.points.begin();
  for (const ReflectiveShadowMap::Outputs& map : maps_.record(timer)) {
    using Light = ReflectiveShadowMap::Light;
    inputs.maps.push_back({map, map.light == Light::spot ? &*spot++ : map.light == Light::point ? &*point++ : nullptr});
  }
  return inputs;
}

void RsmFrame::record(gl::TimeQuery& timer, const FrameView& view) {
  const RsmGather::Inputs inputs = inputsOf(timer, view);
  {
    const gl::TimeQuery::Scope stage(timer, "geometry");
    visible_.record(parts_.drawn, view.drawn());
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
}

void RsmFrame::bindForShading() const { gather_.irradiance().bind(UNIT_GATHERED); }

}  // namespace lucerna
