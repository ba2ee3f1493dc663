// Key frames of the camera and the natural cubic spline through them; key frames of what is carried.
//
// Spline: on segment i, with u = t - i in [0,1], the cubic Hermite polynomial of the values P_i, P_(i+1) and the
// tangents D_i, D_(i+1). The tangents make the second derivative continuous at inner keys and 0 at both ends, which
// gives a tridiagonal system (R. Bartels, J. Beatty, B. Barsky, "An Introduction to Splines for Use in Computer
// Graphics and Geometric Modeling", 1987, chapter 3):
//   2 D_0 + D_1                     = 3 (P_1 - P_0)
//   D_(i-1) + 4 D_i + D_(i+1)       = 3 (P_(i+1) - P_(i-1))
//   D_(n-1) + 2 D_n                 = 3 (P_n - P_(n-1))
#include "scene/key_frames.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"
#include "base/files.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

namespace lucerna {

namespace {

/// Below this length an interpolated direction (from unit vectors at the keys) counts as lost.
constexpr double kLost = 1e-6;

constexpr std::string_view kMoveKey = "move NAME  t SECONDS  p X Y Z";

// --------------------------------------------------------------------------------------------------------------
// reading

class LineReader {
 public:
  LineReader(std::string_view line, const std::filesystem::path& file, int number)
      : rest_(line), file_(file), number_(number) {}

  /// The next word, empty at the end of the line.
  std::string_view word() {
    constexpr std::string_view kBlanks = " \t\r";
    const std::size_t begin = std::min(rest_.find_first_not_of(kBlanks), rest_.size());
    const std::size_t end = std::min(rest_.find_first_of(kBlanks, begin), rest_.size());
    const std::string_view result = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return result;
  }

  /// A word, or in double quotes several.
  std::string name(std::string_view after) {
    std::string_view text = word();
    if (text.starts_with('"')) {
      const char* begin = text.data() + 1;
      const std::string_view whole(begin, static_cast<std::size_t>(rest_.data() + rest_.size() - begin));
      const std::size_t end = whole.find('"');
      if (end == std::string_view::npos) fail("a name without its closing quote");
      text = whole.substr(0, end);
      rest_ = whole.substr(end + 1);
    }
    if (text.empty()) fail(fmt::format("no name after '{}'", after));
    return std::string(text);
  }

  double number(std::string_view after) {
    const std::string_view text = word();
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      fail(fmt::format("'{}' after '{}', expected a finite number",
                       text.empty() ? std::string_view("end of line") : text, after));
    return value;
  }

  glm::dvec3 vector(std::string_view after) {
    glm::dvec3 v;
    for (int c = 0; c < 3; ++c) v[c] = number(after);
    return v;
  }

  [[noreturn]] void fail(const std::string& what) const { throwBadInput("{}:{}: {}", file_.string(), number_, what); }

 private:
  std::string_view rest_;
  const std::filesystem::path& file_;
  int number_;
};

/// One key from a line that holds at least one word.
KeyFrame readKey(LineReader line) {
  std::optional<glm::dvec3> position, direction, up;
  KeyFrame key;
  for (std::string_view word = line.word(); !word.empty(); word = line.word()) {
    if (word == "p") {
      position = line.vector(word);
    } else if (word == "d") {
      direction = line.vector(word);
    } else if (word == "u") {
      up = line.vector(word);
    } else if (word == "r") {
      line.vector(word);  // implied by d and u
    } else if (word == "a") {
      line.number(word);  // implied by the picture's size
    } else if (word == "f") {
      const double degrees = line.number(word);
      if (!(degrees > 0.0 && degrees < 180.0))
        line.fail(fmt::format("field of view {}, expected degrees between 0 and 180", degrees));
      key.verticalFov = degrees * kDegree;
    } else {
      line.fail(fmt::format(
          "unknown word '{}'; a key is: p X Y Z  d X Y Z  u X Y Z  [r X Y Z]  [f DEGREES]  [a ASPECT], or: {}", word,
          kMoveKey));
    }
  }
  if (!position) line.fail("no position: expected p X Y Z");
  if (!direction) line.fail("no viewing direction: expected d X Y Z");
  if (!up) line.fail("no up vector: expected u X Y Z");
  if (!(glm::length(*direction) > 0.0)) line.fail("the viewing direction d is zero");
  if (!(glm::length(*up) > 0.0)) line.fail("the up vector u is zero");
  key.position = *position;
  key.direction = glm::normalize(*direction);
  const glm::dvec3 unitUp = glm::normalize(*up);
  if (glm::length(glm::cross(unitUp, key.direction)) < kLost)
    line.fail("the up vector u is parallel to the viewing direction d");
  key.up = glm::normalize(unitUp - glm::dot(unitUp, key.direction) * key.direction);
  return key;
}

/// One key after the word `move`, added to those of its name.
void readMove(LineReader line, int number, std::vector<KeyFrameMove>& moves) {
  const std::string name = line.name("move");
  std::optional<double> time;
  std::optional<glm::dvec3> place;
  for (std::string_view word = line.word(); !word.empty(); word = line.word()) {
    if (word == "t") time = line.number(word);
    else if (word == "p") place = line.vector(word);
    else line.fail(fmt::format("unknown word '{}'; a key is: {}", word, kMoveKey));
  }
  if (!time) line.fail("no time: expected t SECONDS");
  if (!place) line.fail("no position: expected p X Y Z");
  auto move = std::find_if(moves.begin(), moves.end(), [&](const KeyFrameMove& m) { return m.name == name; });
  if (move == moves.end()) move = moves.insert(moves.end(), {name, number, {}, {}});
  if (!move->times.empty() && !(*time > move->times.back()))
    line.fail(fmt::format("time {:g} of '{}', expected one after {:g}", *time, name, move->times.back()));
  move->times.push_back(*time);
  move->offsets.push_back(*place);
}

// ---------------------------------------------------------------------------------------------------------------
// spline

/// The tangents D of the head comment; Gauss elimination of the tridiagonal matrix, which is diagonally dominant.
/// Value is double or dvec3.
template <class Value>
std::vector<Value> naturalTangents(const std::vector<Value>& points) {
  const std::size_t last = points.size() - 1;
  std::vector<Value> tangents(points.size(), Value(0.0));
  std::vector<double> above(points.size(),
                            0.0);  // the matrix's upper diagonal after elimination, its main diagonal being 1
  for (std::size_t i = 0; i <= last; ++i) {
    const double below = i > 0 ? 1.0 : 0.0;
    const double main = i > 0 && i < last ? 4.0 : 2.0;
    const Value right = 3.0 * (points[std::min(i + 1, last)] - points[i > 0 ? i - 1 : 0]);
    const double pivot = 1.0 / (main - below * (i > 0 ? above[i - 1] : 0.0));
    above[i] = i < last ? pivot : 0.0;
    tangents[i] = i > 0 ? pivot * (right - tangents[i - 1]) : pivot * right;
  }
  for (std::size_t i = last; i-- > 0;) tangents[i] -= above[i] * tangents[i + 1];
  return tangents;
}

template <class Value>
Value hermite(const Value& p0, const Value& p1, const Value& d0, const Value& d1, double u) {
  const double v = 1.0 - u;
  return (1.0 + 2.0 * u) * v * v * p0 + u * u * (3.0 - 2.0 * u) * p1 + u * v * v * d0 - u * u * v * d1;
}

/// Any unit vector perpendicular to the unit vector n.
glm::dvec3 perpendicularTo(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
  return glm::normalize(glm::cross(n, axis));
}

}  // namespace

KeyFrames readKeyFrames(const std::filesystem::path& file) {
  const std::string text = readFileText(file);
  KeyFrames keys;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++number;
    line = line.substr(0, line.find('#'));
    const LineReader reader(line, file, number);
    LineReader rest = reader;
    const std::string_view first = rest.word();
    if (first == "move") readMove(rest, number, keys.moves);
    else if (!first.empty()) keys.camera.push_back(readKey(reader));
  }
  if (keys.camera.size() == 1 || (keys.camera.empty() && keys.moves.empty()))
    throwBadInput("{}: {} key frames of the camera, expected at least 2", file.string(), keys.camera.size());
  return keys;
}

Spline::Spline(std::vector<KeyFrame> keys, int viewsPerSegment)
    : keys_(std::move(keys)), viewsPerSegment_(viewsPerSegment) {
  CHECK(keys_.size() >= 2, "{} keys", keys_.size());
  CHECK(viewsPerSegment_ >= 1, "{} views per segment", viewsPerSegment_);
  std::vector<glm::dvec3> positions, directions, ups;
  std::vector<double> fovs;
  for (KeyFrame& key : keys_) {
    key.direction = glm::normalize(key.direction);
    key.up = glm::normalize(key.up - glm::dot(key.up, key.direction) * key.direction);
    if (!key.verticalFov) key.verticalFov = Camera{}.verticalFov;
    positions.push_back(key.position);
    directions.push_back(key.direction);
    ups.push_back(key.up);
    fovs.push_back(*key.verticalFov);
  }
  positions = naturalTangents(positions);
  directions = naturalTangents(directions);
  ups = naturalTangents(ups);
  fovs = naturalTangents(fovs);
  for (std::size_t i = 0; i < keys_.size(); ++i) tangents_.push_back({positions[i], directions[i], ups[i], fovs[i]});
}

Camera Spline::at(double t) const {
  const double clamped = std::clamp(t, 0.0, static_cast<double>(segmentCount()));
  const auto segment = std::min(static_cast<std::size_t>(clamped), keys_.size() - 2);
  const double u = clamped - static_cast<double>(segment);
  const KeyFrame &k0 = keys_[segment], &k1 = keys_[segment + 1];
  const KeyFrame &d0 = tangents_[segment], &d1 = tangents_[segment + 1];
  const KeyFrame& nearest = u < 0.5 ? k0 : k1;

  Camera camera;
  camera.position = hermite(k0.position, k1.position, d0.position, d1.position, u);
  // Between opposite directions the spline may pass through zero, and up may become parallel to the direction: then use
  // the nearest key's.
  const glm::dvec3 direction = hermite(k0.direction, k1.direction, d0.direction, d1.direction, u);
  camera.direction = glm::length(direction) > kLost ? glm::normalize(direction) : nearest.direction;
  const auto acrossDirection = [&](const glm::dvec3& up) {
    return up - glm::dot(up, camera.direction) * camera.direction;
  };
  glm::dvec3 up = acrossDirection(hermite(k0.up, k1.up, d0.up, d1.up, u));
  if (glm::length(up) < kLost) up = acrossDirection(nearest.up);
  camera.up = glm::length(up) < kLost ? perpendicularTo(camera.direction) : glm::normalize(up);
  // A spline overshoots; a field of view must not leave (0, 180) degrees.
  camera.verticalFov = std::clamp(hermite(*k0.verticalFov, *k1.verticalFov, *d0.verticalFov, *d1.verticalFov, u),
                                  0.1 * kDegree, 179.0 * kDegree);
  return camera;
}

std::optional<int> SplinePlayback::viewAt(double seconds) const {
  // The small amount keeps i * secondsPerView from being rounded down to view i - 1.
  const double view = std::floor(std::max(seconds, 0.0) / secondsPerView_ + 1e-9);
  if (!(view < static_cast<double>(viewCount_))) return std::nullopt;
  return static_cast<int>(view);
}

}  // namespace lucerna
