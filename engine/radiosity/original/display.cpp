#include "radiosity/original/display.hpp"

#include "base/error.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace lucerna {

namespace {

glm::vec3 grey(double value) { return glm::vec3(static_cast<float>(std::clamp(value, 0.0, 1.0))); }

double encodedFilmic(double x) { return static_cast<double>(srgbFromLinear(static_cast<float>(filmic(x)))); }

/// Black, blue, cyan, green, yellow, red, white at equal steps: ordered by lightness at its ends, told apart in
/// between.
glm::vec3 falseColour(double value) {
  constexpr std::array<std::array<float, 3>, 7> stops{{{0, 0, 0},
                                                       {0.10f, 0.15f, 0.65f},
                                                       {0.05f, 0.60f, 0.75f},
                                                       {0.20f, 0.70f, 0.25f},
                                                       {0.95f, 0.85f, 0.15f},
                                                       {0.85f, 0.20f, 0.10f},
                                                       {1, 1, 1}}};
  const double at = std::clamp(value, 0.0, 1.0) * (stops.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const auto part = static_cast<float>(at - static_cast<double>(low));
  const auto& a = stops[low];
  const auto& b = stops[low + 1];
  return {a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2])};
}

glm::vec3 bytesOf(const RadTriangle& t) {
  const std::uint32_t number =
      static_cast<std::uint32_t>(static_cast<float>(t.e) + static_cast<float>(t.b) * t.ro) & kRadMost;
  return glm::vec3(static_cast<float>(number >> 16), static_cast<float>(number >> 8 & 255u),
                   static_cast<float>(number & 255u)) /
         255.0f;
}

}  // namespace

double exposureOf(std::span<const RadTriangle> triangles) {
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return triangles[a].b < triangles[b].b; });
  std::vector<double> areas(triangles.size());
  std::transform(triangles.begin(), triangles.end(), areas.begin(), areaOf);
  const double most = 0.99 * std::accumulate(areas.begin(), areas.end(), 0.0);
  double sum = 0.0;
  for (std::size_t i : order) {
    sum += areas[i];
    if (sum >= most) return triangles[i].b > 0 ? 1.0 / triangles[i].b : 1.0;
  }
  return 1.0;
}

std::vector<glm::vec3> displayColours(std::span<const RadTriangle> triangles, const RadDisplay& display) {
  const double constant = display.constant > 0.0 ? display.constant : exposureOf(triangles);
  double greatest = 0.0;
  for (const RadTriangle& t : triangles) greatest = std::max(greatest, shownRadiosity(t));
  const double scale = greatest > 0.0 ? 1.0 / std::log1p(greatest) : 0.0;
  std::vector<glm::vec3> colours;
  colours.reserve(triangles.size());
  for (const RadTriangle& t : triangles) {
    const double value = shownRadiosity(t);
    switch (display.mapping) {
      case RadMapping::logarithmic: colours.push_back(grey(std::log1p(value) * scale)); break;
      case RadMapping::linear: colours.push_back(grey(value * constant)); break;
      case RadMapping::filmic: colours.push_back(grey(encodedFilmic(value * constant))); break;
      case RadMapping::falseColours: colours.push_back(falseColour(std::log1p(value) * scale)); break;
      case RadMapping::bits24: colours.push_back(bytesOf(t)); break;
    }
  }
  return colours;
}

namespace {

std::pair<glm::dvec3, glm::dvec3> boundsOf(std::span<const RadTriangle> triangles) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const RadTriangle& t : triangles)
    for (const auto* p : {&t.p1, &t.p2, &t.p3}) {
      const glm::dvec3 corner((*p)[0], (*p)[1], (*p)[2]);
      low = glm::min(low, corner), high = glm::max(high, corner);
    }
  return {low, high};
}

}  // namespace

double diagonalOf(std::span<const RadTriangle> triangles) {
  const auto [low, high] = boundsOf(triangles);
  return glm::length(high - low);
}

Camera overviewOf(std::span<const RadTriangle> triangles) {
  const auto [low, high] = boundsOf(triangles);
  Camera camera;
  camera.verticalFov = glm::radians(40.0);
  camera.direction = -glm::normalize(glm::dvec3(-0.45, 0.75, 0.9));
  camera.up = {0.0, 1.0, 0.0};
  const glm::dvec3 middle = 0.5 * (low + high), right = glm::normalize(glm::cross(camera.direction, camera.up)),
                   up = glm::cross(right, camera.direction);
  // As near as leaves every corner of the bounds 4 % inside a picture of 4 by 3.
  const double tall = 0.92 * std::tan(0.5 * camera.verticalFov), wide = tall * 4.0 / 3.0;
  double distance = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p =
        glm::dvec3(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z) - middle;
    const double across = std::max(std::abs(glm::dot(p, right)) / wide, std::abs(glm::dot(p, up)) / tall);
    distance = std::max(distance, across - glm::dot(p, camera.direction));
  }
  camera.position = middle - distance * camera.direction;
  return camera;
}

RadView::RadView(gl::ProgramLibrary& programs, glm::ivec2 size)
    : program_(&programs.loadRaster("radiosity show", "radiosity/show.vert", "radiosity/show.frag")) {
  color_ = gl::Texture("radiosity show", gl::Format::rgba8, size);
  depth_ = gl::Texture("radiosity show depth", gl::Format::depth32f, size);
  const std::array<const gl::Texture*, 1> colors{&color_};
  framebuffer_ = gl::Framebuffer("radiosity show", colors, &depth_);
}

void RadView::show(std::span<const RadTriangle> triangles, const RadDisplay& display) {
  display_ = display;
  const std::vector<glm::vec3> colours = displayColours(triangles, display);
  std::vector<glm::vec3> vertices;
  vertices.reserve(6 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const auto* p : {&triangles[i].p1, &triangles[i].p2, &triangles[i].p3}) {
      vertices.emplace_back((*p)[0], (*p)[1], (*p)[2]);
      vertices.push_back(colours[i]);
    }
  extent_ = diagonalOf(triangles);
  count_ = static_cast<GLsizei>(3 * triangles.size());
  vertices_ = gl::Buffer("radiosity show", vertices.size() * sizeof(glm::vec3), vertices.data(), gl::Usage::staticDraw);
  const std::array<gl::VertexArray::Attribute, 2> attributes{{{0, 3, 0}, {1, 3, sizeof(glm::vec3)}}};
  vertexArray_ = gl::VertexArray("radiosity show", vertices_, 2 * sizeof(glm::vec3), attributes, nullptr);
}

void RadView::record(const Camera& camera) const {
  CHECK(count_ > 0, "{} corners", count_);
  const glm::dvec2 size(framebuffer_.size());
  const glm::dmat4 clipFromView = glm::perspective(camera.verticalFov, size.x / size.y, 1e-3 * extent_, 10.0 * extent_);
  const glm::mat4 clipFromWorld(clipFromView *
                                glm::lookAt(camera.position, camera.position + camera.direction, camera.up));
  const auto draw = [&](const glm::vec4& edge) {
    program_->use();
    program_->set("clipFromWorld", clipFromWorld);
    program_->set("edge", edge);
    vertexArray_.bind();
    gl::drawTriangles(count_);
  };
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  state.cull = gl::Cull::back;
  if (display_.mesh) state.polygonOffset = {1.0f, 1.0f};
  {
    const gl::RasterPass pass("radiosity faces", framebuffer_, state);
    pass.clearColor(0, glm::vec4(0.10f, 0.10f, 0.11f, 1.0f));
    pass.clearDepth();
    draw(glm::vec4(0.0f));
  }
  if (display_.mesh) {
    state.polygonOffset = {};
    const gl::RasterPass pass("radiosity mesh", framebuffer_, state);
    const gl::PolygonMode edges(gl::PolygonMode::Parts::edges);
    draw({0.25f, 0.55f, 0.95f, 0.45f});
  }
  if (display_.backCorners) {
    state.polygonOffset = {};
    state.cull = gl::Cull::front;
    const gl::RasterPass pass("radiosity back corners", framebuffer_, state);
    const gl::PolygonMode corners(gl::PolygonMode::Parts::corners);
    draw(glm::vec4(0.0f));
  }
}

Bitmap RadView::read() const {
  const glm::ivec2 size = framebuffer_.size();
  Bitmap bitmap;
  bitmap.width = size.x, bitmap.height = size.y;
  std::vector<std::uint8_t> bottomUp(4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
  gl::readBytes(framebuffer_, {0, 0}, size, bottomUp.data());
  const std::size_t row = 4 * static_cast<std::size_t>(size.x);
  for (std::size_t y = static_cast<std::size_t>(size.y); y-- > 0;)
    bitmap.rgba.insert(bitmap.rgba.end(), bottomUp.begin() + static_cast<std::ptrdiff_t>(y * row),
                       bottomUp.begin() + static_cast<std::ptrdiff_t>((y + 1) * row));
  return bitmap;
}

}  // namespace lucerna
