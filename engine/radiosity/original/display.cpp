#include "radiosity/original/display.hpp"

#include "base/error.hpp"
#include "forward/texture_wraps.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"
#include "radiosity/patches.hpp"
#include "shared/bindings.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <iterator>
#include <map>
#include <numeric>

namespace lucerna {

namespace {

glm::vec3 grey(double value) { return glm::vec3(static_cast<float>(std::clamp(value, 0.0, 1.0))); }

double encodedFilmic(double x) { return static_cast<double>(srgbFromLinear(static_cast<float>(filmic(x)))); }

/// Black, blue, cyan, green, yellow, red, white at equal steps: ordered by lightness at both ends, distinct by hue in
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

namespace {

/// The value below which this share of the triangles' area lies; 0 without triangles.
template <class Value>
double percentileByArea(std::span<const RadTriangle> triangles, double share, Value value) {
  std::vector<std::pair<double, double>> values;  // with areas
  double area = 0.0;
  for (const RadTriangle& t : triangles) {
    values.emplace_back(value(t), areaOf(t));
    area += areaOf(t);
  }
  std::sort(values.begin(), values.end());
  double sum = 0.0;
  for (const auto& [v, own] : values)
    if ((sum += own) >= share * area) return v;
  return 0.0;
}

}  // namespace

double exposureOf(std::span<const RadTriangle> triangles) {
  const double most = percentileByArea(triangles, 0.99, [](const RadTriangle& t) { return static_cast<double>(t.b); });
  return most > 0.0 ? 1.0 / most : 1.0;
}

bool isUnsolved(std::span<const RadTriangle> triangles) {
  return std::ranges::all_of(triangles, [](const RadTriangle& t) { return t.b == 0; });
}

double blackOf(std::span<const RadTriangle> triangles) {
  std::vector<RadTriangle> lit;
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(lit),
               [](const RadTriangle& t) { return shownRadiosity(t) > 0.0 && areaOf(t) > 0.0; });
  return lit.empty() ? 1.0 : 0.5 * percentileByArea(lit, 0.01, shownRadiosity);
}

namespace {

/// Maps a value of e + b to its displayed colour.
class Mapping {
 public:
  Mapping(std::span<const RadTriangle> triangles, const RadDisplay& display)
      : mapping_(display.mapping), constant_(display.constant > 0.0 ? display.constant : exposureOf(triangles)) {
    double greatest = 0.0;
    for (const RadTriangle& t : triangles) greatest = std::max(greatest, shownRadiosity(t));
    black_ = blackOf(triangles);
    scale_ = greatest > black_ ? 1.0 / std::log(greatest / black_) : 0.0;
  }

  glm::vec3 operator()(double value) const {
    switch (mapping_) {
      case RadMapping::logarithmic: return grey(logarithm(value));
      case RadMapping::linear: return grey(value * constant_);
      case RadMapping::filmic: return grey(encodedFilmic(value * constant_));
      case RadMapping::falseColours: return falseColour(logarithm(value));
      case RadMapping::bits24: break;  // depends on the triangle, not on a value: bytesOf
    }
    return {};
  }

 private:
  double logarithm(double value) const { return value > black_ ? std::log(value / black_) * scale_ : 0.0; }

  RadMapping mapping_;
  double constant_, black_ = 1.0, scale_ = 0.0;
};

using Corner = std::array<float, 3>;

std::array<Corner, 3> cornersOf(const RadTriangle& t) { return {t.p1, t.p2, t.p3}; }

/// Triangles that share a corner's position: the list of vertices in the text [RAD2008 chapter 4].
std::map<Corner, std::vector<std::size_t>> meetingAt(std::span<const RadTriangle> triangles) {
  std::map<Corner, std::vector<std::size_t>> meeting;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const Corner& corner : cornersOf(triangles[i])) meeting[corner].push_back(i);
  return meeting;
}

/// Whether light is interpolated between two triangles: within 20 degrees, as for patches (PatchSettings::crease). A
/// source is separate from surfaces that it lights.
bool areOneFace(const RadTriangle& a, const RadTriangle& b) {
  const double cosine = glm::dot(glm::dvec3(a.n[0], a.n[1], a.n[2]), glm::dvec3(b.n[0], b.n[1], b.n[2]));
  return cosine >= PatchSettings{}.crease && (a.e > 0) == (b.e > 0);
}

}  // namespace

std::vector<glm::vec3> displayColours(std::span<const RadTriangle> triangles, const RadDisplay& display) {
  const Mapping mapped(triangles, display);
  std::vector<glm::vec3> colours;
  colours.reserve(triangles.size());
  for (const RadTriangle& t : triangles)
    colours.push_back(display.mapping == RadMapping::bits24 ? bytesOf(t) : mapped(shownRadiosity(t)));
  return colours;
}

std::vector<std::array<glm::vec3, 3>> cornerColours(std::span<const RadTriangle> triangles, const RadDisplay& display) {
  const std::vector<glm::vec3> flat = displayColours(triangles, display);
  std::vector<std::array<glm::vec3, 3>> colours;
  colours.reserve(triangles.size());
  if (display.shading == RadShading::flat) {
    for (const glm::vec3& colour : flat) colours.push_back({colour, colour, colour});
    return colours;
  }
  CHECK(display.mapping != RadMapping::bits24, "packed numbers have no mean");
  const Mapping mapped(triangles, display);
  const auto meeting = meetingAt(triangles);
  const auto colourAt = [&](std::size_t i, const Corner& corner) {
    const std::vector<std::size_t>& around = meeting.at(corner);
    if (display.shading == RadShading::acrossEdges) {
      glm::vec3 sum(0.0f);
      for (const std::size_t other : around) sum += flat[other];
      return sum / static_cast<float>(around.size());
    }
    double value = 0.0, area = 0.0;
    for (const std::size_t other : around) {
      if (!areOneFace(triangles[i], triangles[other])) continue;
      value += areaOf(triangles[other]) * shownRadiosity(triangles[other]);
      area += areaOf(triangles[other]);
    }
    return area > 0.0 ? mapped(value / area) : flat[i];
  };
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto corners = cornersOf(triangles[i]);
    colours.push_back({colourAt(i, corners[0]), colourAt(i, corners[1]), colourAt(i, corners[2])});
  }
  return colours;
}

RadTextures texturesOf(const Scene& scene, double longestEdge, std::span<const RadTriangle> triangles,
                       const std::string& file) {
  PatchSettings patches;
  const glm::dvec3 extent = scene.bounds.extent();
  patches.longestEdge = longestEdge > 0.0 ? longestEdge : std::max({extent.x, extent.y, extent.z}) / 12.0;
  const RadiosityMesh mesh = makePatches(scene, patches);
  const auto isSame = [&](const Patch& patch, const RadTriangle& triangle) {
    const auto corners = mesh.corners(patch);
    return std::array{toFloats(corners[0]), toFloats(corners[1]), toFloats(corners[2])} ==
           std::array{triangle.p1, triangle.p2, triangle.p3};
  };
  if (mesh.patches.size() != triangles.size() ||
      !std::equal(mesh.patches.begin(), mesh.patches.end(), triangles.begin(), isSame))
    throwBadInput(
        "{}: {} triangles, which are not the {} that lucerna radiosity generate makes of {} with edges of at most "
        "{:.6g} units (--edge, --triangles)",
        file, triangles.size(), mesh.patches.size(), scene.file.string(), patches.longestEdge);
  RadTextures textures;
  for (const Texture& texture : scene.textures) textures.pictures.push_back(&texture);
  for (const Patch& patch : mesh.patches) {
    textures.ofTriangle.push_back(scene.materials[static_cast<std::size_t>(patch.material)].diffuseTexture);
    textures.texCoords.push_back(patch.texCoord);
  }
  return textures;
}

namespace {

/// Bottom row first, with mipmaps; texels are not decoded, since colours are multiplied as displayed.
gl::Texture uploaded(const Texture& picture) {
  const Bitmap& bitmap = picture.bitmap;
  const glm::ivec2 size(bitmap.width, bitmap.height);
  const gl::Sampling sampling = withWraps({gl::Filter::linearMipmaps, gl::Filter::linear}, picture.wraps);
  gl::Texture texture("radiosity picture", gl::Format::rgba8, size, sampling,
                      static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(size.x, size.y)))));
  const auto row = static_cast<std::ptrdiff_t>(4 * size.x);
  std::vector<std::uint8_t> bottomUp;
  bottomUp.reserve(bitmap.rgba.size());
  for (std::ptrdiff_t y = size.y; y-- > 0;)
    bottomUp.insert(bottomUp.end(), bitmap.rgba.begin() + y * row, bitmap.rgba.begin() + (y + 1) * row);
  texture.upload(gl::Texels::rgbaByte, bottomUp.data());
  texture.generateMipmaps();
  return texture;
}

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
  // The nearest position that keeps every corner of the bounds within a 4:3 picture, with a margin of 4 %.
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
    : programs_(programs),
      program_(
          &programs.loadRaster("radiosity show", "radiosity/show.vert", "radiosity/show.frag", {{"TEXTURED", 0}})) {
  color_ = gl::Texture("radiosity show", gl::Format::rgba8, size);
  depth_ = gl::Texture("radiosity show depth", gl::Format::depth32f, size);
  const std::array<const gl::Texture*, 1> colors{&color_};
  framebuffer_ = gl::Framebuffer("radiosity show", colors, &depth_);
}

void RadView::show(std::span<const RadTriangle> triangles, const RadDisplay& display, const RadTextures& textures) {
  struct Place {
    std::array<float, 3> position;
    glm::vec3 colour;
    glm::vec2 texCoord;
  };
  display_ = display;
  const auto colours = cornerColours(triangles, display);
  const bool hasPictures = !textures.ofTriangle.empty() && display.mapping != RadMapping::bits24;
  std::vector<Place> vertices;
  vertices.reserve(3 * triangles.size());
  std::map<int, std::vector<std::uint32_t>> ofPicture;  // indices by picture
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto corners = cornersOf(triangles[i]);
    std::vector<std::uint32_t>& indices = ofPicture[hasPictures ? textures.ofTriangle[i] : -1];
    for (std::size_t k = 0; k < 3; ++k) {
      indices.push_back(static_cast<std::uint32_t>(vertices.size()));
      vertices.push_back({corners[k], colours[i][k], hasPictures ? textures.texCoords[i][k] : glm::vec2(0.0f)});
    }
  }
  textures_.clear();
  parts_.clear();
  std::vector<std::uint32_t> indices;
  for (const auto& [picture, own] : ofPicture) {
    parts_.push_back({picture < 0 ? -1 : static_cast<int>(textures_.size()), static_cast<std::uint32_t>(indices.size()),
                      static_cast<std::uint32_t>(own.size())});
    if (picture >= 0) textures_.push_back(uploaded(*textures.pictures[static_cast<std::size_t>(picture)]));
    indices.insert(indices.end(), own.begin(), own.end());
  }
  if (!textures_.empty() && !textured_)
    textured_ = &programs_.loadRaster("radiosity show textured", "radiosity/show.vert", "radiosity/show.frag",
                                      {{"TEXTURED", 1}});
  extent_ = diagonalOf(triangles);
  vertices_ = gl::Buffer("radiosity show", vertices.size() * sizeof(Place), vertices.data(), gl::Usage::staticDraw);
  indices_ = gl::Buffer("radiosity show indices", indices.size() * sizeof(std::uint32_t), indices.data(),
                        gl::Usage::staticDraw);
  const std::array<gl::VertexArray::Attribute, 3> attributes{
      {{0, 3, offsetof(Place, position)}, {1, 3, offsetof(Place, colour)}, {2, 2, offsetof(Place, texCoord)}}};
  vertexArray_ = gl::VertexArray("radiosity show", vertices_, sizeof(Place), attributes, &indices_);
}

void RadView::record(const Camera& camera) const {
  CHECK(!parts_.empty(), "{} parts", parts_.size());
  const glm::dvec2 size(framebuffer_.size());
  const glm::dmat4 clipFromView = glm::perspective(camera.verticalFov, size.x / size.y, 1e-3 * extent_, 10.0 * extent_);
  const glm::mat4 clipFromWorld(clipFromView *
                                glm::lookAt(camera.position, camera.position + camera.direction, camera.up));
  const auto draw = [&](const glm::vec4& edge) {
    vertexArray_.bind();
    for (const Part& part : parts_) {
      const gl::Program& program = part.texture < 0 ? *program_ : *textured_;
      program.use();
      program.set("clipFromWorld", clipFromWorld);
      program.set("edge", edge);
      if (part.texture >= 0) textures_[static_cast<std::size_t>(part.texture)].bind(UNIT_DIFFUSE);
      gl::drawIndexedTriangles(part.firstIndex, part.indexCount);
    }
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
