#include "radiosity/original/solver.hpp"

#include "base/error.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

/// PCG-RXS-M-XS, 32 bits [ONeill2014]: a different angle for every triangle.
double rollOf(std::uint32_t triangle, std::uint32_t seed) {
  const std::uint32_t state = (triangle + 0x9e3779b9u * seed) * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return 2.0 * glm::pi<double>() * static_cast<double>((word >> 22u) ^ word) / 4294967296.0;
}

}  // namespace

OriginalRadiosity::OriginalRadiosity(gl::ProgramLibrary& programs, std::span<const RadTriangle> triangles,
                                     const Settings& settings)
    : settings_(settings),
      triangles_(triangles),
      map_(makeMultiplierMap(settings.view, settings.deviations.publishedMap)) {
  CHECK(settings.view >= 2 && settings.view <= 4096, "view {}", settings.view);
  CHECK(!triangles.empty(), "{} triangles", triangles.size());
  const bool bits24 = settings.deviations.values24Bit;
  program_ = &programs.loadRaster(bits24 ? "hemicube view, 24 bits" : "hemicube view, floats",
                                  "radiosity/original.vert", "radiosity/original.frag", {{"BITS_24", bits24 ? 1 : 0}});
  const glm::ivec2 size(settings.view);
  color_ = gl::Texture("hemicube view", bits24 ? gl::Format::rgba8 : gl::Format::r32f, size);
  depth_ = gl::Texture("hemicube view depth", gl::Format::depth24, size);
  const std::array<const gl::Texture*, 1> colors{&color_};
  framebuffer_ = gl::Framebuffer("hemicube view", colors, &depth_);
  const auto pixels = static_cast<std::size_t>(settings.view) * static_cast<std::size_t>(settings.view);
  if (bits24) bytes_.resize(4 * pixels);
  else floats_.resize(pixels);

  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  corners_.reserve(3 * triangles.size());
  for (const RadTriangle& t : triangles)
    for (const auto* corner : {&t.p1, &t.p2, &t.p3}) {
      const glm::dvec3 p = vec(*corner);
      low = glm::min(low, p), high = glm::max(high, p);
      corners_.emplace_back((*corner)[0], (*corner)[1], (*corner)[2], 0.0f);
    }
  const double diagonal = glm::length(high - low);
  near_ = settings.nearPlane > 0.0 ? settings.nearPlane : 1e-4 * diagonal;
  far_ = std::max(2.0 * diagonal, 2.0 * near_);
  vertices_ = gl::Buffer("radiosity triangles", corners_.size() * sizeof(glm::vec4), nullptr, gl::Usage::dynamicDraw);
  const std::array<gl::VertexArray::Attribute, 1> attributes{{{0, 4, 0}}};
  vertexArray_ = gl::VertexArray("radiosity triangles", vertices_, sizeof(glm::vec4), attributes, nullptr);
  setReceived(start().received);
}

OriginalProgress OriginalRadiosity::start() const {
  OriginalProgress progress;
  for (const RadTriangle& t : triangles_) progress.received.push_back(static_cast<float>(t.b));
  progress.next = progress.received;
  return progress;
}

float OriginalRadiosity::sentBy(std::size_t triangle, float received) const {
  const RadTriangle& t = triangles_[triangle];
  const float sent = static_cast<float>(t.e) + received * t.ro;
  if (!settings_.deviations.values24Bit) return sent;
  // Only three bytes of the number are sent: higher bits are lost, as in the original.
  const auto number = static_cast<std::uint32_t>(sent);
  if (number > kRadMost) ++overflows_;
  return static_cast<float>(number & kRadMost);
}

void OriginalRadiosity::writeVertices(std::size_t triangle, float sent) {
  for (std::size_t corner = 0; corner < 3; ++corner) corners_[3 * triangle + corner].w = sent;
}

void OriginalRadiosity::setReceived(std::span<const float> received) {
  CHECK(received.size() == triangles_.size(), "{} values for {} triangles", received.size(), triangles_.size());
  for (std::size_t i = 0; i < received.size(); ++i) writeVertices(i, sentBy(i, received[i]));
  vertices_.upload(0, vertices_.bytes(), corners_.data());
}

double OriginalRadiosity::readAndSum(const std::vector<float>& map, int firstRow, int rows) {
  const auto count = static_cast<std::size_t>(settings_.view) * static_cast<std::size_t>(rows);
  CHECK(count == map.size(), "{} pixels, {} weights", count, map.size());
  double sum = 0.0;
  if (settings_.deviations.values24Bit) {
    gl::readBytes(framebuffer_, {0, firstRow}, {settings_.view, rows}, bytes_.data());
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t number = static_cast<std::uint32_t>(bytes_[4 * i]) << 16 |
                                   static_cast<std::uint32_t>(bytes_[4 * i + 1]) << 8 | bytes_[4 * i + 2];
      sum += static_cast<double>(number) * static_cast<double>(map[i]);
    }
  } else {
    gl::readFloats(framebuffer_, {0, firstRow}, {settings_.view, rows}, floats_.data());
    for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(floats_[i]) * static_cast<double>(map[i]);
  }
  return sum;
}

double OriginalRadiosity::gatherAt(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& up) {
  const glm::dvec3 across = glm::cross(normal, up);
  const std::array<glm::dvec3, 5> towards{normal, up, -up, across, -across};
  const glm::dmat4 clipFromView = glm::perspective(glm::half_pi<double>(), 1.0, near_, far_);
  gl::RasterState state;
  state.depth = gl::Depth::lessWrite;
  state.depthClamp = !settings_.deviations.noNearField;
  const int view = settings_.view, half = view / 2;
  double sum = 0.0;
  for (std::size_t face = 0; face < towards.size(); ++face) {
    {
      const gl::RasterPass pass("hemicube view", framebuffer_, state);
      pass.clearColor(0, glm::vec4(0.0f));
      pass.clearDepth();
      program_->use();
      program_->set("clipFromWorld",
                    glm::mat4(clipFromView * glm::lookAt(point, point + towards[face], face == 0 ? up : normal)));
      vertexArray_.bind();
      gl::drawTriangles(static_cast<int>(corners_.size()));
    }
    sum += face == 0 ? readAndSum(map_.top, 0, view) : readAndSum(map_.side, view - half, half);
  }
  ++hemicubes_;
  drawnTriangles_ += towards.size() * triangles_.size();
  return sum;
}

float OriginalRadiosity::gather(std::size_t triangle) {
  const RadTriangle& t = triangles_[triangle];
  const std::array<glm::dvec3, 3> corners{vec(t.p1), vec(t.p2), vec(t.p3)};
  const glm::dvec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
  const glm::dvec3 normal = glm::normalize(vec(t.n));
  glm::dvec3 up = corners[0] - middle;  // the first corner is the top of the middle view [RAD2008 figure 3.15]
  up = glm::normalize(up - normal * glm::dot(up, normal));
  if (!settings_.deviations.fixedOrientation) {
    const double roll = rollOf(static_cast<std::uint32_t>(triangle), settings_.seed);
    up = std::cos(roll) * up + std::sin(roll) * glm::cross(normal, up);
  }
  double sum = 0.0;
  if (settings_.deviations.centroid) {
    sum = gatherAt(middle, normal, up);
  } else {
    for (const glm::dvec3& corner : corners) sum += gatherAt(corner, normal, up) / 3.0;
  }
  if (!settings_.deviations.values24Bit) return static_cast<float>(sum);
  return static_cast<float>(
      std::min(static_cast<std::uint32_t>(sum), kRadMost));  // the map's floats sum to 1 only within rounding
}

bool OriginalRadiosity::sweep(OriginalProgress& progress, const std::function<bool(const OriginalProgress&)>& goOn) {
  const std::size_t count = triangles_.size();
  CHECK(progress.received.size() == count && progress.next.size() == count && progress.done <= count,
        "{} of {} values, {} done", progress.received.size(), count, progress.done);
  setReceived(progress.received);
  if (progress.done == 0) progress.change = 0.0;
  while (progress.done < count) {
    const std::size_t i = progress.done;
    if (areaOf(triangles_[i]) > 0.0) {
      const float received = gather(i);
      progress.change += std::abs(static_cast<double>(received) - static_cast<double>(progress.received[i]));
      progress.next[i] = received;
      if (settings_.gaussSeidel) {
        progress.received[i] = received;
        writeVertices(i, sentBy(i, received));
        vertices_.upload(3 * i * sizeof(glm::vec4), 3 * sizeof(glm::vec4), &corners_[3 * i]);
      }
    } else {
      progress.next[i] = progress.received[i];
    }
    ++progress.done;
    if (progress.done < count && !goOn(progress)) return false;
  }
  progress.received = progress.next;
  progress.done = 0;
  ++progress.sweeps;
  return true;
}

std::vector<RadTriangle> OriginalRadiosity::withReceived(std::span<const float> received) const {
  CHECK(received.size() == triangles_.size(), "{} values for {} triangles", received.size(), triangles_.size());
  std::vector<RadTriangle> result(triangles_.begin(), triangles_.end());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i].b =
        static_cast<std::uint32_t>(std::clamp(static_cast<double>(received[i]), 0.0, static_cast<double>(kRadMost)));
  return result;
}

double OriginalRadiosity::energyBalance(std::span<const float> received) const {
  double emitted = 0.0, absorbed = 0.0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const double area = areaOf(triangles_[i]);
    emitted += area * triangles_[i].e;
    absorbed += area * (1.0 - static_cast<double>(triangles_[i].ro)) * static_cast<double>(received[i]);
  }
  return emitted > 0.0 ? absorbed / emitted - 1.0 : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace lucerna
