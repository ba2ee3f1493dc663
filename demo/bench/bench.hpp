// `lucerna bench`: its sub-subcommands, one file each, and what they share.
#pragma once

#include "commands.hpp"
#include "parts.hpp"
#include "settings/deviations.hpp"

#include <string>
#include <vector>

namespace lucerna::demo {

Work addBenchTables(Command app);
Work addBenchPictures(Command app);
Work addBenchRays(Command app);
Work addBenchError(Command app);
Work addBenchReferences(Command app);
Work addBenchStability(Command app);
Work addBenchNeeds(Command app);
Work addBenchAll(Command app);

namespace bench {

/// --original: whose tables and pictures. Throws Error(badInput) listing those that there are.
void checkOriginal(const std::string& name);
/// A file of the assets folder.
std::string asset(const std::string& file);
/// SCENE, or the atrium where none is given.
std::string sceneOrAtrium(const std::string& scene);

/// A figure of a published table beside ours.
struct Row {
  struct Published {
    std::string gpu;
    double ms;
  };
  std::string table, setting, stage;
  int grids = 0;  ///< 0: does not matter
  std::vector<Published> published;  ///< one a GPU
  std::string fill, propagate;  ///< how ours was made; empty where it does not matter
  std::vector<double> samples;  ///< ours, ms; empty: not measured
  bool isMean = false;  ///< else the median
  std::string missing;  ///< an extension that this driver lacks; empty: none

  std::string name() const;
  double measured() const;  ///< NaN where there is no sample
};

struct TablesInput {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  double scale;  ///< 0..1
  bool quiet;
  PartOptions part = {};  ///< of the rows
  std::optional<LpvFill> fill = {};  ///< measured beside the published one; none: the fastest here, tried first
};

struct Tables {
  std::vector<std::string> notes;  ///< how it was measured, and how that differs from what was published
  std::vector<Row> rows;
  std::string summary;  ///< printed after the tables
  nlohmann::ordered_json json;  ///< the same, and the settings; of a part how many rows it made, and nothing else
};

struct VptTablesInput {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  double scale;  ///< 0..1
  bool quiet;
  Fidelity fidelity = Fidelity::corrected;
  PartOptions part = {};  ///< of the rows
};

/// The times under the pictures of the VPT original, on scenes of ours; with the published estimator also those of the
/// corrected one.
Tables measureVptTables(const VptTablesInput& input);

/// Those pictures on one sheet.
struct VptSheet {
  Bitmap sheet;
  nlohmann::ordered_json json;
  std::size_t tiles = 0;
};
VptSheet drawVptPictures(const VptTablesInput& input, glm::ivec2 size, std::optional<double> exposure);

/// Tables 7.2 to 7.8 of the LPV original, and its comparison of ways to clear.
Tables measureLpvTables(const TablesInput& input);

}  // namespace bench
}  // namespace lucerna::demo
