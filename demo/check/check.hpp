// lucerna check: how this machine's driver and GPU do. Every unit of work runs in a child process of its own under a
// time limit, so that a hang, a crash or a reset is a row of the report and not its end.
//
// check.cpp    the command: plan, limits, state, verdicts
// child.hpp    a child process under a limit
// report.hpp   rows as JSON and as a page of text
// Parts, each a list of units: context, programs, pictures, probes, stages, rays, error, sharing.
#pragma once

#include "shared/commands.hpp"
#include "gl/build_watch.hpp"

#include <functional>
#include <string>
#include <vector>

namespace lucerna::demo::check {

/// What a unit found. `text`: one line for the report.
struct Finding {
  bool right = true;  ///< false: results are wrong
  std::string text;
  nlohmann::ordered_json figures = nlohmann::ordered_json::object();
};

/// Options of a child.
struct UnitInput {
  CommonOptions common;
  double seconds = 60.0;  ///< measurements end by themselves after this time
  std::string out;  ///< the report's folder
  std::string reference;  ///< file of the stored values
};

struct Unit {
  std::string part, name;
  double seconds;  ///< limit
  std::function<Finding(const UnitInput&)> run;
  std::string after = {};  ///< key of a unit: if it did not end, this one is not run. All need the context
  bool isLarge = false;  ///< a software renderer may need minutes for one pass of it: no sign of a hang there

  std::string key() const { return part + "/" + name; }
};

/// Says on standard error what begins now. The parent names it if nothing follows.
void at(const std::string& what);

/// Host, context and programs of a child; programs are named as they are built.
struct Session {
  explicit Session(const UnitInput& input);
  std::unique_ptr<Host> host;
  gl::Context context;
  gl::ProgramLibrary programs;
  gl::BuildWatch watch{[](const std::string& name) { at("compiling " + name + ", or after it"); }};

 private:
  static std::unique_ptr<Host> makeHost(const UnitInput& input);
};

/// A picture of the parts programs, pictures and stages.
struct Requested {
  std::string name, scene;  ///< scene: below assets/
  std::string technique;
  std::vector<std::string> settings;

  bool isPath() const { return technique == "path"; }
  /// Full float targets, and shadows by pixel, as `lucerna render` has them.
  RenderSettings parse(glm::ivec2 size, const std::vector<std::string>& more = {}) const;
};
const std::vector<Requested>& requestedPictures();

std::vector<Unit> contextUnits();
std::vector<Unit> programUnits();
std::vector<Unit> pictureUnits();
std::vector<Unit> probeUnits();
std::vector<Unit> stageUnits();
std::vector<Unit> rayUnits();
std::vector<Unit> errorUnits();
std::vector<Unit> sharingUnits();

/// Renders all pictures of the part and writes the values that they are compared with.
void writeReference(const CommonOptions& common, const std::string& file);

}  // namespace lucerna::demo::check
