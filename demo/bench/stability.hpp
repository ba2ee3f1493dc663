// `lucerna bench stability`: stiff and extreme cases of every technique, each with an exact answer or a bound.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <string>
#include <vector>

namespace lucerna::demo {
struct PartOptions;
}

namespace lucerna::demo::bench {

/// How `measured` is compared with `expected`. Values that are not finite fail every rule.
enum class Rule {
  equals,  ///< |measured - expected| <= tolerance
  atMost,  ///< measured <= expected
  atLeast,  ///< measured >= expected
};

struct Measurement {
  double expected = 0.0, measured = 0.0, tolerance = 0.0;
  Rule rule = Rule::equals;
  bool passes() const;
};

struct StabilityContext {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
};

/// A row of the table. `run` may throw: that counts as a failure, with the message as its note.
struct StabilityCase {
  std::string technique;  ///< as named by Renderer; motion: long runs of all of them
  std::string name, parameter;
  std::function<Measurement(const StabilityContext&)> run;
  bool isLong = false;  ///< takes minutes: left out unless its technique is asked for
};

void addLpvCases(std::vector<StabilityCase>& cases);
/// Cases of the irradiance cache.
void addCacheCases(std::vector<StabilityCase>& cases);
/// Cases of the techniques that Renderer draws: units, scale, position, size, nothing to light.
void addPictureCases(std::vector<StabilityCase>& cases);
/// Cases of all techniques and lights: far from the origin, large faces.
void addPlaceCases(std::vector<StabilityCase>& cases);
/// Cases of scenes that move, of all techniques; technique "motion" has 10,000 frames of each.
void addMotionCases(std::vector<StabilityCase>& cases);
void addPathCases(std::vector<StabilityCase>& cases);
/// Cases of light at its limits, of several techniques.
void addLimitCases(std::vector<StabilityCase>& cases);
void addLeakCases(std::vector<StabilityCase>& cases);
void addMediaCases(std::vector<StabilityCase>& cases);
void addRadiosityCases(std::vector<StabilityCase>& cases);

struct StabilityRow {
  std::string technique, name, parameter, note;
  Measurement measurement;
  double seconds = 0.0;
  bool passed = false;
};
/// Runs the rows of `technique`, or all that are not long, that belong to the part; stored ones are read from its
/// folder. Stops when interrupted.
std::vector<StabilityRow> runStability(const StabilityContext& context, const std::string& technique, bool quiet,
                                       const PartOptions& part);
nlohmann::ordered_json stabilityJson(const std::vector<StabilityRow>& rows);
std::string expectedText(const Measurement& m);
/// The rows of a table stored by `--json`. Throws Error(badInput).
nlohmann::ordered_json readKept(const std::string& file);
/// What is worse in `now` than in `kept`, both in the form of stabilityJson(), one line each: rows that are missing,
/// that passed and now fail, that expect something else or allow more. New rows are fine. `technique`, unless empty:
/// only its rows. Throws Error(badInput) if `kept` is not such a table; `file` is for the message.
std::vector<std::string> worseRows(const nlohmann::ordered_json& now, const nlohmann::ordered_json& kept,
                                   const std::string& technique, const std::string& file);

}  // namespace lucerna::demo::bench
