#include "walk/scene_views.hpp"

#include "gl/pass.hpp"
#include "scene/place.hpp"
#include "shared/bindings.h"
#include "shared/frame.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna::demo {

namespace {

/// As in shaders/walk/compose.frag.
glm::vec3 heat(float t) { return glm::clamp(glm::vec3(3.0f * t, 3.0f * t - 1.0f, 3.0f * t - 2.0f), 0.0f, 1.0f); }

}  // namespace

CountViews::CountViews(const gl::Context& context, gl::ProgramLibrary& programs, const Scene& scene,
                       const glm::dvec3& origin)
    : context_(context), programs_(programs), scene_(scene), origin_(origin) {}

std::vector<float> CountViews::surfaces(const glm::mat4& clipFromWorld, glm::ivec2 size) {
  if (!drawn_) {
    if (origin_ != glm::dvec3(0.0)) moved_ = movedTo(scene_, origin_);
    const Scene& scene = moved_ ? *moved_ : scene_;
    drawn_.emplace(scene, analyse(scene), context_.capabilities());
  }
  gl::Texture target("surfaces in a pixel", gl::Format::rgba32f, size);
  const std::array<const gl::Texture*, 1> colors{&target};
  const gl::Framebuffer framebuffer("surfaces in a pixel", colors);
  shared::FrameConstants constants{};
  constants.clipFromWorld = clipFromWorld;
  const gl::Buffer buffer("overdraw constants", sizeof constants, &constants, gl::Usage::staticDraw);
  buffer.bindUniform(BLOCK_FRAME);
  const gl::Program& program = programs_.loadRaster("overdraw", "forward/depth.vert", "walk/overdraw.frag",
                                                    {{"ALPHA_MASK", 0}, {"FROM_SUN", 0}, {"EMITTERS", 0}});
  {
    gl::RasterState state;
    state.blend = gl::Blend::add;
    const gl::RasterPass pass("overdraw", framebuffer, state);
    pass.clearColor(0, glm::vec4(0.0f));
    drawn_->draw({&program, &program}, {&clipFromWorld, nullptr});
  }
  std::vector<float> counts;
  for (const glm::vec4& texel : target.readRgba()) counts.push_back(texel.x);
  return counts;
}

std::vector<float> CountViews::visits(const Camera& camera, glm::ivec2 size) {
  struct Ray {  // as in shaders/rays/bvh.glsl
    glm::vec3 origin;
    float tMin;
    glm::vec3 direction;
    float tMax;
  };
  if (!rays_) rays_.emplace(scene_, context_.capabilities());
  const glm::dvec3 right = glm::normalize(glm::cross(camera.direction, camera.up)),
                   up = glm::cross(right, camera.direction);
  const double pixel = 2.0 * camera.halfHeight() / size.y;
  std::vector<Ray> rays;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec3 across = pixel * ((x + 0.5 - 0.5 * size.x) * right) + pixel * ((y + 0.5 - 0.5 * size.y) * up);
      const bool parallel = camera.isOrthographic();
      const glm::dvec3 origin = camera.position + (parallel ? across : glm::dvec3(0.0));
      const glm::dvec3 direction = camera.direction + (parallel ? glm::dvec3(0.0) : across);
      rays.push_back({glm::vec3(origin - rays_->origin()), 0.0f, glm::vec3(glm::normalize(direction)), 3e38f});
    }
  const gl::Program& program = programs_.loadCompute("ray visits", "rays/trace_rays.comp",
                                                     {{"ALPHA_MASKS", 0},
                                                      {"ANY_HIT", 0},
                                                      {"COUNT_WORK", 1},
                                                      {"OFFSET_ORIGINS", 0},
                                                      {"SHARED_STACK", rays_->sharedStack()}});
  const std::vector<std::uint32_t> skip(rays.size(), 0xffffffffu);
  const gl::Buffer rayBuffer("rays", rays.size() * sizeof(Ray), rays.data(), gl::Usage::staticDraw);
  const gl::Buffer hits("hits", rays.size() * sizeof(glm::vec4), nullptr, gl::Usage::streamRead);
  const gl::Buffer skipped("skipped", skip.size() * sizeof skip[0], skip.data(), gl::Usage::staticDraw);
  program.use();
  rays_->bind();
  rayBuffer.bindStorage(2);
  hits.bindStorage(3);
  skipped.bindStorage(4);
  const int count = static_cast<int>(rays.size());
  program.set("rayCount", count);
  constexpr int kBatch = 1 << 16;
  for (int first = 0; first < count; first += kBatch) {
    const gl::ComputePass pass("ray visits");
    program.set("firstRay", first);
    pass.dispatch(glm::ivec3(std::min(kBatch, count - first), 1, 1), glm::ivec3(64, 1, 1));
  }
  std::vector<float> counts;
  for (const glm::vec4& hit : hits.read<glm::vec4>()) counts.push_back(hit.x);
  return counts;
}

const gl::Texture& CountViews::record(CountView view, const Camera& camera, const glm::mat4& clipFromWorld,
                                      glm::ivec2 size, float white) {
  const bool isNew = view != view_ || clipFromWorld != clip_ || !result_.id() || result_.size2d() != size;
  if (isNew) {
    counts_ = view == CountView::overdraw ? surfaces(clipFromWorld, size) : visits(camera, size);
    view_ = view;
    clip_ = clipFromWorld;
    result_ = gl::Texture("counts", gl::Format::rgba32f, size);
    most_ = *std::ranges::max_element(counts_);
    double sum = 0.0;
    for (const float count : counts_) sum += static_cast<double>(count);
    mean_ = static_cast<float>(sum / static_cast<double>(counts_.size()));
  }
  std::vector<glm::vec4> texels;
  for (const float count : counts_) texels.emplace_back(heat(count / white), 1.0f);
  result_.upload(gl::Texels::rgbaFloat, texels.data());
  return result_;
}

}  // namespace lucerna::demo
