#include "radiosity/original/rad_models.hpp"

#include "base/error.hpp"

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

using glm::dvec3;

constexpr dvec3 kPlaster{0.86, 0.84, 0.80}, kFloor{0.55, 0.42, 0.30}, kStone{0.70, 0.70, 0.74}, kWood{0.45, 0.28, 0.15},
    kLamp{1.0, 0.97, 0.90};

constexpr double kMostTriangles = 59e6;  // 4 GiB of 72 bytes

class Builder {
 public:
  Builder(const RadModelSettings& settings, double scale) : settings_(settings), scale_(scale) {}

  /// The rectangle corner + s u + t v, s and t from 0 to 1, facing u x v. emission: of the lamps.
  void rectangle(const dvec3& corner, const dvec3& u, const dvec3& v, const dvec3& color, bool lamp = false) {
    const double shorter = std::min(glm::length(u), glm::length(v));
    const int across = std::max(1, static_cast<int>(std::lround(glm::length(u) / shorter)));
    const int along = std::max(1, static_cast<int>(std::lround(glm::length(v) / shorter)));
    RadTriangle pattern;
    pattern.n = toFloats(glm::normalize(glm::cross(u, v)));
    pattern.c = toFloats(lamp ? kLamp : color);
    pattern.ro = static_cast<float>(settings_.reflectance);
    pattern.e = lamp ? settings_.lightPower : 0;
    for (int j = 0; j < along; ++j)
      for (int i = 0; i < across; ++i) {
        const auto at = [&](int x, int y) {
          return (corner + u * (static_cast<double>(x) / across) + v * (static_cast<double>(y) / along)) * scale_;
        };
        triangle(pattern, at(i, j), at(i + 1, j), at(i, j + 1));
        triangle(pattern, at(i + 1, j + 1), at(i, j + 1), at(i + 1, j));
      }
  }

  /// A rectangle with a rectangular hole from (s0, t0) to (s1, t1), in fractions of u and v; the hole is a lamp or
  /// open.
  void pierced(const dvec3& corner, const dvec3& u, const dvec3& v, double s0, double t0, double s1, double t1,
               const dvec3& color, bool lamp) {
    const std::array<double, 4> s{0.0, s0, s1, 1.0}, t{0.0, t0, t1, 1.0};
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t i = 0; i < 3; ++i) {
        const bool hole = i == 1 && j == 1;
        if ((hole && !lamp) || s[i + 1] <= s[i] || t[j + 1] <= t[j]) continue;
        rectangle(corner + u * s[i] + v * t[j], u * (s[i + 1] - s[i]), v * (t[j + 1] - t[j]), color, hole);
      }
  }

  /// A box from `low` to `high` turned about the vertical through its middle, without the faces named in `touching`,
  /// which touch something else.
  enum Face : unsigned { none = 0, bottom = 1, top = 2, back = 4, front = 8 };
  void box(const dvec3& low, const dvec3& high, double degrees, const dvec3& color, unsigned touching) {
    const dvec3 middle = 0.5 * (low + high), half = 0.5 * (high - low);
    const double a = glm::radians(degrees);
    const dvec3 x{std::cos(a) * half.x, 0.0, -std::sin(a) * half.x}, y{0.0, half.y, 0.0},
        z{std::sin(a) * half.z, 0.0, std::cos(a) * half.z};
    const auto face = [&](const dvec3& outward, const dvec3& u, const dvec3& v) {  // u x v along outward
      rectangle(middle + outward - u - v, 2.0 * u, 2.0 * v, color);
    };
    face(x, y, z), face(-x, z, y);
    if (!(touching & front)) face(z, x, y);
    if (!(touching & back)) face(-z, y, x);
    if (!(touching & top)) face(y, z, x);
    if (!(touching & bottom)) face(-y, x, z);
  }

  /// An upright prism of `sides` faces, without ends.
  void column(const dvec3& foot, double radius, double height, int sides, const dvec3& color) {
    const auto corner = [&](int i) {
      const double a = 2.0 * glm::pi<double>() * (i + 0.5) / sides;
      return foot + dvec3(radius * std::cos(a), 0.0, radius * std::sin(a));
    };
    for (int i = 0; i < sides; ++i) rectangle(corner(i), dvec3(0.0, height, 0.0), corner(i + 1) - corner(i), color);
  }

  std::vector<RadTriangle> take() { return std::move(triangles_); }

 private:
  // Halving is exact, so a triangle gives 2^k parts; they are counted before they are made.
  void triangle(const RadTriangle& pattern, const dvec3& a, const dvec3& b, const dvec3& c) {
    const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
    total_ += std::exp2(std::max(0.0, std::floor(std::log2(area / settings_.areaThreshold)) + 1.0));
    if (!(total_ <= kMostTriangles))
      throwBadInput("AREA_THRESHOLD {}: gives more than {:.0f} triangles, 4 GiB; expected a greater area",
                    settings_.areaThreshold, kMostTriangles);
    halve(pattern, a, b, c, area);
  }

  void halve(const RadTriangle& pattern, const dvec3& a, const dvec3& b, const dvec3& c, double area) {
    if (area < settings_.areaThreshold) {
      triangles_.push_back(pattern);
      triangles_.back().p1 = toFloats(a), triangles_.back().p2 = toFloats(b), triangles_.back().p3 = toFloats(c);
      return;
    }
    const double ab = glm::dot(b - a, b - a), bc = glm::dot(c - b, c - b), ca = glm::dot(a - c, a - c);
    if (ab >= bc && ab >= ca) {
      const dvec3 m = 0.5 * (a + b);
      halve(pattern, a, m, c, 0.5 * area), halve(pattern, m, b, c, 0.5 * area);
    } else if (bc >= ca) {
      const dvec3 m = 0.5 * (b + c);
      halve(pattern, a, b, m, 0.5 * area), halve(pattern, a, m, c, 0.5 * area);
    } else {
      const dvec3 m = 0.5 * (c + a);
      halve(pattern, a, b, m, 0.5 * area), halve(pattern, m, b, c, 0.5 * area);
    }
  }

  RadModelSettings settings_;
  double scale_;
  double total_ = 0.0;
  std::vector<RadTriangle> triangles_;
};

void litCube(Builder& b) {
  const double side = 21.0;
  const dvec3 x{side, 0, 0}, y{0, side, 0}, z{0, 0, side};
  b.rectangle({0, 0, 0}, z, x, kFloor);
  b.pierced(y, x, z, 3.0 / 7.0, 3.0 / 7.0, 4.0 / 7.0, 4.0 / 7.0, kPlaster, true);
  b.rectangle({0, 0, 0}, x, y, kPlaster);
  b.rectangle(z, y, x, kPlaster);
  b.rectangle({0, 0, 0}, y, z, kPlaster);
  b.rectangle(x, z, y, kPlaster);
}

void hall(Builder& b) {
  const double w = 145, h = 42, d = 104;  // x, y, z
  const dvec3 x{w, 0, 0}, y{0, h, 0}, z{0, 0, d};
  b.rectangle({0, 0, 0}, z, x, kFloor);
  b.pierced(y, x, z, 0.36, 0.42, 0.44, 0.53, kPlaster, true);  // the lamp over the columns
  b.rectangle({0, 0, 0}, x, y, kPlaster);
  b.rectangle(z, y, x, kPlaster);
  b.rectangle({0, 0, 0}, y, z, kPlaster);
  b.pierced(x, z, y, 0.40, 0.55, 0.52, 0.80, kPlaster, true);  // a small window in the far wall
  for (double cx : {32.0, 60.0, 88.0})
    for (double cz : {25.0, 79.0}) b.column({cx, 0.0, cz}, 4.0, h, 10, kStone);
  // A wall across, with an opening from floor up; it ends below the ceiling, so that light passes over it.
  b.box({112.0, 0.0, 0.0}, {115.0, 28.0, 38.0}, 0.0, kPlaster, Builder::bottom | Builder::back);
  b.box({112.0, 0.0, 58.0}, {115.0, 28.0, d}, 0.0, kPlaster, Builder::bottom | Builder::front);
  // A table, a rotated box, a low block, and a panel hung under the lamp.
  b.box({48.0, 9.0, 46.0}, {72.0, 10.5, 62.0}, 0.0, kWood, Builder::none);
  for (double lx : {49.0, 69.0})
    for (double lz : {47.0, 59.0})
      b.box({lx, 0.0, lz}, {lx + 2.0, 9.0, lz + 2.0}, 0.0, kWood, Builder::bottom | Builder::top);
  b.box({14.0, 0.0, 48.0}, {28.0, 14.0, 62.0}, 30.0, kStone, Builder::bottom);
  b.box({92.0, 0.0, 46.0}, {102.0, 6.0, 66.0}, -15.0, kStone, Builder::bottom);
  b.box({78.0, 24.0, 44.0}, {90.0, 25.0, 68.0}, 0.0, kWood, Builder::none);
}

void twoChambers(Builder& b) {
  const double w = 48, h = 16, d = 28;
  const dvec3 x{w, 0, 0}, y{0, h, 0}, z{0, 0, d};
  // The dividing wall, from floor to ceiling, joined to the back wall (z = 0), leaving a gap of 8 units before the
  // front wall. Surfaces it touches are cut along its edges: a triangle below it would be lit in one chamber and
  // visible in the other.
  const double x0 = 23, x1 = 25, end = 20;
  b.rectangle({0, 0, 0}, z, {x0, 0, 0}, kFloor);
  b.rectangle({x1, 0, 0}, z, {w - x1, 0, 0}, kFloor);
  b.rectangle({x0, 0, end}, {0, 0, d - end}, {x1 - x0, 0, 0}, kFloor);
  b.rectangle({0, h, 0}, {x0, 0, 0}, z, kPlaster);
  b.rectangle({x1, h, 0}, {w - x1, 0, 0}, z, kPlaster);
  b.rectangle({x0, h, end}, {x1 - x0, 0, 0}, {0, 0, d - end}, kPlaster);
  b.rectangle({0, 0, 0}, {x0, 0, 0}, y, kPlaster);
  b.rectangle({x1, 0, 0}, {w - x1, 0, 0}, y, kPlaster);
  b.rectangle(z, y, x, kPlaster);
  b.rectangle({0, 0, 0}, y, z, kPlaster);
  b.pierced(x, z, y, 0.35, 0.375, 0.50, 0.625, kPlaster, true);  // the lamp, in the right wall
  b.rectangle({x0, 0, 0}, {0, 0, end}, y, kStone);
  b.rectangle({x1, 0, 0}, y, {0, 0, end}, kStone);
  b.rectangle({x0, 0, end}, {x1 - x0, 0, 0}, y, kStone);
}

// With this scale model 2 has 25,932, 136,328 and 545,312 triangles at thresholds of 5, 1 and 0.25; published are
// 26,360, 136,512 and 546,048 [RAD2008 table 4.1].
constexpr double kHallScale = 1.15;

}  // namespace

std::vector<RadTriangle> makeRadModel(int model, const RadModelSettings& settings) {
  if (model < 1 || model > 3)
    throwBadInput("MODEL {}: unknown; expected 1 (lit cube), 2 (hall with columns) or 3 (light around an obstacle)",
                  model);
  if (!(settings.areaThreshold > 0.0 && std::isfinite(settings.areaThreshold)))
    throwBadInput("AREA_THRESHOLD {}: expected an area above 0", settings.areaThreshold);
  if (!(settings.reflectance >= 0.0 && settings.reflectance <= 1.0))
    throwBadInput("REFLECTANCE {}: expected 0 to 1", settings.reflectance);
  if (settings.lightPower > kRadMost)
    throwBadInput("LIGHT_POWER {}: expected 0 to {} (24 bits)", settings.lightPower, kRadMost);
  Builder builder(settings, model == 2 ? kHallScale : 1.0);
  if (model == 1) litCube(builder);
  if (model == 2) hall(builder);
  if (model == 3) twoChambers(builder);
  return builder.take();
}

}  // namespace lucerna
