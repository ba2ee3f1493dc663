// One rung of a ladder measured: a picture, its time, its errors; kept in the folder of the bench, so that an
// interrupted one goes on.
#pragma once

#include "bench/ladder.hpp"
#include "bench/references.hpp"

#include <filesystem>
#include <optional>

namespace lucerna::demo::bench {

/// A finished measurement as it is written to JSON. NaN becomes null.
using ErrorRow = nlohmann::ordered_json;

struct ErrorBench {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  const Camera& camera;
  glm::ivec2 size;
  const References& references;
  std::filesystem::path folder;  ///< of pictures and rows
  double pathSeconds;  ///< a rung of the path tracer's ladder may take that long
  int frames;  ///< a rung at least
  std::string command = {};  ///< that measures this; its --techniques is left for the row
  std::string pictureCommand =
      {};  ///< `lucerna render` of the same scene, view and size; technique and settings are left for the row
};

/// What a row says of where it comes from: command, date (UTC), program and commit. Its technique's --techniques is
/// added.
void addProvenance(const ErrorBench& bench, ErrorRow& row);
/// The median of a few values has this standard error: of three, 0.67 of their standard deviation (order statistics of
/// normal ones); of more, sqrt(pi / 2 / n). NaN of one.
double medianError(const std::vector<double>& values);

/// Makes the folder and tries to write into it. Throws Error(badInput) where that cannot be.
void makeFolder(const std::filesystem::path& folder);
/// Says whose bench the folder holds: what an earlier one of the same identity finished is kept. Throws Error(badInput)
/// where it holds another.
void claimFolder(const std::filesystem::path& folder, const std::string& identity);
/// The rung's row from the folder, if it was finished.
std::optional<ErrorRow> finishedRow(const std::filesystem::path& folder, const Rung& rung);
/// Renders, judges, writes picture and row. `more`: settings that the rung's name does not tell.
ErrorRow measureRung(const ErrorBench& bench, const Rung& rung, const std::vector<std::string>& more = {});
/// A rung by glReadPixels: the published program solves the scene, its solution is shown and judged. "setup_ms" has the
/// solving in it, "published" what was solved. Empty, and nothing kept, where it was interrupted.
ErrorRow measurePublished(const ErrorBench& bench, const Rung& rung);
/// Writes the row into the folder.
void keepRow(const ErrorBench& bench, const Rung& rung, const ErrorRow& row);
/// The path tracer's ladders, corrected and as published: one picture observed at 1, 2, 4, ... samples, a row each.
/// `deviations`: each alone too, a row each. Empty where it was interrupted; series that were finished are kept.
std::vector<ErrorRow> measurePath(const ErrorBench& bench, bool deviations);

/// Tone mapped, and both heat maps against `truth`, as PNGs; returns their common path below the folder, without
/// ".png". `ownError`: the picture's own standard error where it is sampled, else null. Beside the PNGs lie the linear
/// picture
/// (.pfm), the map of FLIP (.flip.png, grey 0..255 for 0..1) and that standard error (.error.pfm).
std::string writePictures(const ErrorBench& bench, const std::string& name, const Image& picture,
                          const measure::Reference& truth, const std::vector<float>& flip, const Image* ownError);
/// Where the row of that name is kept.
std::filesystem::path rowFile(const std::filesystem::path& folder, const std::string& name);

/// The fields of a row, or of its "inside_model".
nlohmann::ordered_json errorsJson(const JudgedPicture& judged);
/// Rows "black" and "constant", against all light: pictures that cost nothing, without time.
std::vector<ErrorRow> yardsticks(const References& references);
/// The same inside each model that a technique is judged by.
struct InsideModel {
  std::string name;
  ErrorRow black, constant;
};
std::vector<InsideModel> insideModels(const References& references);
/// What the rung's technique promises, of the lights that the scene has.
TechniqueModel modelOf(const Rung& rung, measure::LightKinds scene);

/// Fills "inside_front": on the front of its technique and model by `ms` and the l2 inside the model (true without a
/// model); then "pareto" by `ms` and `l2` among those, and "front", 1 for the fastest of it, 0 off it.
void markFront(std::vector<ErrorRow>& rows);
/// What the row is ranked by: its l2 or nrmse, or the least that the reference can tell.
double rankedError(const ErrorRow& row, const char* measure);
/// A number of a row, NaN where it is null or missing.
double number(const ErrorRow& row, const char* key);

}  // namespace lucerna::demo::bench
