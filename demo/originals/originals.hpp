// The published tables and pictures: `lucerna bench tables` and `pictures`; the museum of deviations.
#pragma once

#include "lpv/settings.hpp"
#include "render/deviations.hpp"
#include "shared/commands.hpp"
#include "shared/parts.hpp"

#include <string>
#include <vector>

namespace lucerna::demo {

Work addBenchTables(Command app);
Work addBenchPictures(Command app);
/// `bench tables` and `bench pictures`.
void addOriginals(Subcommands& commands);
/// `lab mystery` and `lab museum`.
void addMuseum(Subcommands& commands);

namespace bench {

/// Checks --original, which names the original. Throws Error(badInput) listing the valid names.
void checkOriginal(const std::string& name);
/// A file of the assets folder.
std::string asset(const std::string& file);
/// SCENE, or the atrium if none is given.
std::string sceneOrAtrium(const std::string& scene);

/// A number from a published table, and ours.
struct Row {
  struct Published {
    std::string gpu;
    double ms;
  };
  std::string table, setting, stage;
  int grids = 0;  ///< 0: any
  std::vector<Published> published;  ///< one per GPU
  std::string fill, propagate;  ///< how ours was computed; empty if it does not matter
  std::vector<double> samples;  ///< ours, ms; empty: not measured
  bool isMean = false;  ///< otherwise the median
  std::string missing;  ///< an extension that this driver lacks; empty: none

  std::string name() const;
  double measured() const;  ///< NaN without samples
};

struct TablesInput {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  double scale;  ///< 0..1
  bool quiet;
  PartOptions part = {};  ///< of the rows
  std::optional<LpvFill> fill = {};  ///< measured next to the published one; none: the fastest here, found by trial
};

struct Tables {
  std::vector<std::string> notes;  ///< how it was measured, and how that differs from the publication
  std::vector<Row> rows;
  std::string summary;  ///< printed after the tables
  nlohmann::ordered_json json;  ///< the same with the settings; for a part only the number of rows it made
};

struct VptTablesInput {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  double scale;  ///< 0..1
  bool quiet;
  Fidelity fidelity = Fidelity::corrected;
  PartOptions part = {};  ///< of the rows
};

/// The times given for the pictures of the VPT original, on our scenes; with the published estimator also those of the
/// corrected one.
Tables measureVptTables(const VptTablesInput& input);

/// Those pictures on one sheet.
struct VptSheet {
  Bitmap sheet;
  nlohmann::ordered_json json;
  std::size_t tiles = 0;
};
VptSheet drawVptPictures(const VptTablesInput& input, glm::ivec2 size, std::optional<double> exposure);

/// Tables 7.2 to 7.8 of the LPV original, and its comparison of methods to clear textures.
Tables measureLpvTables(const TablesInput& input);

}  // namespace bench
}  // namespace lucerna::demo
