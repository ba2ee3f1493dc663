#include "forward/environment_view.hpp"

#include "gl/pass.hpp"

#include <cmath>
#include <vector>

namespace lucerna {

namespace {
constexpr GLuint kPictureUnit = 0;
}

EnvironmentView::EnvironmentView(gl::ProgramLibrary& programs, const Scene& scene, const glm::vec3& factor)
    : radiance_(factor * scene.environment->radiance),
      turn_(std::cos(scene.environment->rotation), std::sin(scene.environment->rotation)) {
  if (scene.environment->picture) {
    const Image& picture = *scene.environment->picture;
    std::vector<glm::vec4> texels;
    texels.reserve(picture.pixels.size());
    for (const glm::vec3& p : picture.pixels) texels.emplace_back(p, 0.0f);
    picture_.emplace("environment behind surfaces", gl::Format::rgba32f, glm::ivec2(picture.width, picture.height));
    picture_->upload(gl::Texels::rgbaFloat, texels.data());
  }
  program_ = &programs.loadRaster("environment", "forward/environment.vert", "forward/environment.frag",
                                  {{"ENVIRONMENT_PICTURE", picture_.has_value()}});
}

void EnvironmentView::record(const gl::Framebuffer& target, const gl::VertexArray& noAttributes, const Camera& camera,
                             glm::ivec2 size, const glm::dvec2& offset) const {
  gl::RasterState state;
  state.depth = gl::Depth::equalReadOnly;
  const gl::RasterPass pass("environment", target, state);
  program_->use();
  program_->set("environmentRadiance", radiance_);
  if (picture_) {
    // All rays of an orthographic view see one point of the environment.
    const double high = camera.isOrthographic() ? 0.0 : camera.halfHeight(), wide = high * size.x / size.y;
    const glm::dvec3 right = wide * glm::normalize(glm::cross(camera.direction, camera.up)),
                     up = high * glm::cross(glm::normalize(glm::cross(camera.direction, camera.up)), camera.direction);
    const glm::dvec2 moved = 2.0 * offset / glm::dvec2(size);
    program_->set("viewForward", glm::vec3(camera.direction + moved.x * right + moved.y * up));
    program_->set("viewRight", glm::vec3(right));
    program_->set("viewUp", glm::vec3(up));
    program_->set("environmentTurn", turn_);
    picture_->bind(kPictureUnit);
  }
  gl::drawFullScreen(noAttributes);
}

}  // namespace lucerna
