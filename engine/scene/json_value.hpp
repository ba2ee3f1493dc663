// A value of a scene JSON with its file and key, for error messages (no GL; private to engine/scene).
#pragma once

#include "base/error.hpp"
#include "base/nearest_words.hpp"

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

using Json = nlohmann::json;

/// Of radiance, irradiance and intensity. With more, sums of light would leave the range of floats.
constexpr double kMostLight = 1e30;

struct Value;
std::vector<double> keyTimesIn(const Json& json);  // scene/curve.hpp
/// What a curve (scene/curve.hpp) is at the time of its Value. Throws Error(badInput) if it is none.
Json valueAt(const Value& value);

/// A value and its path, such as "cameras[1].fov", for messages. Numbers and arrays of numbers may be curves: then they
/// are what the curve is at `time`.
struct Value {
  const Json& json;
  const std::filesystem::path& file;
  std::string key;
  double time = 0.0;  ///< seconds

  bool isCurve() const { return json.is_object() && json.contains("times"); }

  /// Reads the value of a curve at the time.
  template <class Read>
  auto now(const Read& read) const {
    const Json value = valueAt(*this);
    return read(Value{value, file, fmt::format("{} at {:g} s", key, time), time});
  }

  [[noreturn]] void fail(std::string_view expected) const {
    std::string found = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (found.size() > 60) found = found.substr(0, 57) + "...";
    throwBadInput("{}: key \"{}\"{}: found {}, expected {}", file.string(), key,
                  keyTimesIn(json).empty() ? "" : fmt::format(" at {:g} s", time), found, expected);
  }

  Value at(std::string_view name) const {
    return {json.at(std::string(name)), file, key.empty() ? std::string(name) : fmt::format("{}.{}", key, name), time};
  }
  Value at(std::size_t index) const { return {json.at(index), file, fmt::format("{}[{}]", key, index), time}; }
  bool has(std::string_view name) const { return json.contains(std::string(name)); }

  std::string text() const {
    if (!json.is_string()) fail("text");
    return json.get<std::string>();
  }

  double number(std::string_view expected = "a number") const {
    if (isCurve()) return now([&](const Value& v) { return v.number(expected); });
    if (!json.is_number() || !std::isfinite(json.get<double>())) fail(expected);
    return json.get<double>();
  }

  double positiveNumber() const {
    const double value = number("a number above 0");
    if (!(value > 0.0)) fail("a number above 0");
    return value;
  }

  glm::dvec3 vector(std::string_view expected = "an array of 3 numbers") const {
    if (isCurve()) return now([&](const Value& v) { return v.vector(expected); });
    if (!json.is_array() || json.size() != 3) fail(expected);
    glm::dvec3 v;
    for (std::size_t i = 0; i < 3; ++i) v[static_cast<int>(i)] = at(i).number();
    return v;
  }

  glm::dvec3 unitVector() const {
    const glm::dvec3 v = vector("a direction: an array of 3 numbers");
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0.0)) fail("a direction other than zero");
    return glm::normalize(v / largest);  // whose squares neither overflow nor vanish
  }

  /// Radiance, irradiance or intensity, at most kMostLight.
  glm::vec3 light() const {
    const std::string expected = fmt::format("an array of 3 numbers from 0 to {:g}", kMostLight);
    const glm::dvec3 v = vector(expected);
    for (int c = 0; c < 3; ++c)
      if (!(v[c] >= 0.0 && v[c] <= kMostLight)) fail(expected);
    return glm::vec3(v);
  }

  double numberBetween(double lowest, double highest, std::string_view expected) const {
    const double value = number(expected);
    if (!(value >= lowest && value <= highest)) fail(expected);
    return value;
  }

  /// Three numbers within bounds.
  glm::dvec3 vectorBetween(double lowest, double highest, std::string_view expected) const {
    const glm::dvec3 v = vector(expected);
    for (int c = 0; c < 3; ++c)
      if (!(v[c] >= lowest && v[c] <= highest)) fail(expected);
    return v;
  }

  /// A path relative to the file that names it.
  std::filesystem::path path() const {
    const std::string name = text();
    if (name.empty()) fail("a path");
    return file.parent_path() / name;
  }
};

struct Key {
  const char* name;
  std::function<void(const Value&)> read;
};

/// Passes each member of an object to the entry of its name; an unknown member is an error.
inline void readObject(const Value& object, const std::vector<Key>& keys) {
  if (!object.json.is_object()) object.fail("an object {...}");
  for (const auto& member : object.json.items()) {
    const std::string& name = member.key();
    const auto key = std::find_if(keys.begin(), keys.end(), [&](const Key& k) { return k.name == name; });
    if (key == keys.end()) {
      std::vector<std::string_view> known;
      for (const Key& k : keys) known.push_back(k.name);
      throwBadInput("{}: unknown key \"{}\"; nearest: {} (docs/commands.md)", object.file.string(),
                    object.key.empty() ? name : fmt::format("{}.{}", object.key, name), nearestList(name, known));
    }
    key->read(object.at(name));
  }
}

/// The whole file. Throws Error(badInput) if it is missing or not JSON.
Json readJson(const std::filesystem::path& file);

}  // namespace lucerna
