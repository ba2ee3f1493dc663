#include "scene/curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace lucerna {

namespace {

using Numbers = std::span<const double>;

/// Slope at a key of a monotone cubic, from the two slopes beside it and the lengths of their intervals: a weighted
/// harmonic mean, 0 at an extremum [FritschButland1984].
double monotoneSlope(double before, double after, double lengthBefore, double lengthAfter) {
  if (!(before * after > 0.0)) return 0.0;
  const double a = 2.0 * lengthAfter + lengthBefore, b = lengthAfter + 2.0 * lengthBefore;
  return (a + b) / (a / before + b / after);
}

double hermite(double u, double length, double p0, double m0, double p1, double m1) {
  const double u2 = u * u, u3 = u2 * u;
  return (2.0 * u3 - 3.0 * u2 + 1.0) * p0 + (u3 - 2.0 * u2 + u) * length * m0 + (3.0 * u2 - 2.0 * u3) * p1 +
         (u3 - u2) * length * m1;
}

void normalise(std::span<double> q) {
  double length2 = 0.0;
  for (const double v : q) length2 += v * v;
  if (length2 > 0.0)
    for (double& v : q) v /= std::sqrt(length2);
}

void slerp(Numbers a, Numbers b, double u, std::span<double> out) {
  double cosine = 0.0;
  for (std::size_t k = 0; k < 4; ++k) cosine += a[k] * b[k];
  const double sign = cosine < 0.0 ? -1.0 : 1.0, angle = std::acos(std::min(std::abs(cosine), 1.0));
  const bool isNear = angle < 1e-6;
  const double wa = isNear ? 1.0 - u : std::sin((1.0 - u) * angle) / std::sin(angle),
               wb = sign * (isNear ? u : std::sin(u * angle) / std::sin(angle));
  for (std::size_t k = 0; k < 4; ++k) out[k] = wa * a[k] + wb * b[k];
  normalise(out);
}

void addTimes(const Json& json, std::vector<double>& times) {
  if (json.is_object() && json.contains("times") && json.at("times").is_array())
    for (const Json& time : json.at("times"))
      if (time.is_number()) times.push_back(time.get<double>());
  if (json.is_structured())
    for (const Json& member : json) addTimes(member, times);
}

}  // namespace

void Curve::at(double seconds, std::span<double> out) const {
  const std::size_t count = times.size(), perKey = interpolation == Interpolation::tangents ? 3 * width : width,
                    offset = interpolation == Interpolation::tangents ? width : 0;
  const auto key = [&](std::size_t i) { return Numbers(values).subspan(i * perKey + offset, width); };
  double t = seconds;
  if (const double length = times.back() - times.front(); loops && length > 0.0) {
    t = std::fmod(t - times.front(), length);
    t = times.front() + (t < 0.0 ? t + length : t);
  }
  const auto next =
      static_cast<std::size_t>(std::ranges::upper_bound(times, t) - times.begin());  // the first key after t
  if (next == 0 || next == count || interpolation == Interpolation::step) {
    std::ranges::copy(key(next == 0 ? 0 : next - 1), out.begin());
    return;
  }
  const std::size_t i = next - 1;
  const double length = times[next] - times[i], u = (t - times[i]) / length;
  const Numbers a = key(i), b = key(next);
  if (interpolation == Interpolation::linear) {
    if (isRotation) return slerp(a, b, u, out);
    for (std::size_t k = 0; k < width; ++k) out[k] = (1.0 - u) * a[k] + u * b[k];
    return;
  }
  for (std::size_t k = 0; k < width; ++k) {
    double before, after;  // slopes at the two keys
    if (interpolation == Interpolation::tangents) {
      before = values[i * perKey + 2 * width + k];
      after = values[next * perKey + k];
    } else {
      const auto secant = [&](std::size_t s) { return (key(s + 1)[k] - key(s)[k]) / (times[s + 1] - times[s]); };
      const auto slope = [&](std::size_t s) {
        if (count == 2) return secant(0);
        if (s > 0 && s + 1 < count)
          return monotoneSlope(secant(s - 1), secant(s), times[s] - times[s - 1], times[s + 1] - times[s]);
        if (loops && key(0)[k] == key(count - 1)[k])
          return monotoneSlope(secant(count - 2), secant(0), times[count - 1] - times[count - 2], times[1] - times[0]);
        return 0.0;  // starts and ends at rest
      };
      before = slope(i);
      after = slope(next);
    }
    out[k] = hermite(u, length, a[k], before, b[k], after);
  }
  if (isRotation) normalise(out);
}

Curve readCurve(const Value& value) {
  Curve curve;
  bool hasValues = false;
  readObject(value, {{"times",
                      [&](const Value& v) {
                        if (!v.json.is_array() || v.json.empty()) v.fail("an array of times in seconds");
                        for (std::size_t i = 0; i < v.json.size(); ++i) {
                          curve.times.push_back(v.at(i).number("a time in seconds"));
                          if (i > 0 && !(curve.times[i] > curve.times[i - 1])) v.at(i).fail("a later time than before");
                        }
                      }},
                     {"values",
                      [&](const Value& v) {
                        if (!v.json.is_array() || v.json.empty()) v.fail("an array of values, one a time");
                        hasValues = true;
                        curve.width = v.json[0].is_array() ? v.json[0].size() : 1;
                        for (std::size_t i = 0; i < v.json.size(); ++i) {
                          const Value entry = v.at(i);
                          if (v.json[0].is_array() != entry.json.is_array() ||
                              (entry.json.is_array() && entry.json.size() != curve.width))
                            entry.fail("a value like the first");
                          if (!entry.json.is_array()) curve.values.push_back(entry.number());
                          else
                            for (std::size_t k = 0; k < curve.width; ++k) curve.values.push_back(entry.at(k).number());
                        }
                      }},
                     {"interpolation",
                      [&](const Value& v) {
                        const std::string name = v.text();
                        if (name == "step") curve.interpolation = Curve::Interpolation::step;
                        else if (name == "cubic") curve.interpolation = Curve::Interpolation::cubic;
                        else if (name != "linear") v.fail("step, linear or cubic");
                      }},
                     {"loop", [&](const Value& v) {
                        if (!v.json.is_boolean()) v.fail("true or false");
                        curve.loops = v.json.get<bool>();
                      }}});
  if (!hasValues || curve.width == 0 || curve.values.size() != curve.times.size() * curve.width)
    value.fail("a curve with as many \"values\" as \"times\"");
  return curve;
}

Json valueAt(const Value& value) {
  const Curve curve = readCurve(value);
  std::vector<double> now(curve.width);
  curve.at(value.time, now);
  const bool isArray = value.json.at("values").at(0).is_array();
  return isArray ? Json(now) : Json(now[0]);
}

std::vector<double> keyTimesIn(const Json& json) {
  std::vector<double> times;
  addTimes(json, times);
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

}  // namespace lucerna
