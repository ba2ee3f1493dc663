// Measures one point of a sweep: a picture, its time, its errors. Results are stored in the bench's folder, so that an
// interrupted bench can continue.
#pragma once

#include "bench/sweep.hpp"
#include "bench/references.hpp"

#include <filesystem>
#include <optional>

namespace lucerna::demo::bench {

/// A finished measurement in the form written to JSON. NaN becomes null.
using ErrorRow = nlohmann::ordered_json;

struct ErrorBench {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  const Camera& camera;
  glm::ivec2 size;
  PixelFilter filter;
  int pixelSamples;  ///< of the techniques; path has its own
  const References& references;
  std::filesystem::path folder;  ///< for pictures and rows
  double pathSeconds;  ///< maximum time for a point of the path tracer's sweep
  int frames;  ///< minimum per point
  std::string command = {};  ///< repeats the measurement; its --techniques is filled in per row
  std::string pictureCommand =
      {};  ///< `lucerna render` of the same scene, view and size; technique and settings are filled in per row
  bool hasSweeps = true;  ///< false: only points that were asked for; the command has no --techniques
};

/// Adds a row's provenance: command, date (UTC), program and commit. The command gets the technique's --techniques.
void addProvenance(const ErrorBench& bench, ErrorRow& row);
/// Standard error of the median of a few values: for three, 0.67 of their standard deviation (order statistics of
/// normal values); for more, sqrt(pi / 2 / n). NaN for one.
double medianError(const std::vector<double>& values);

/// Creates the folder and tries to write into it. Throws Error(badInput) if that fails.
void makeFolder(const std::filesystem::path& folder);
/// Records the identity of the folder's bench: results of an earlier one of the same identity are kept. Throws
/// Error(badInput) if the folder holds another bench.
void claimFolder(const std::filesystem::path& folder, const std::string& identity);
/// The point's row from the folder, if it was finished.
std::optional<ErrorRow> finishedRow(const std::filesystem::path& folder, const SweepPoint& point);
/// Renders, judges, writes picture and row. `more`: settings that the point's name does not include.
ErrorRow measurePoint(const ErrorBench& bench, const SweepPoint& point, const std::vector<std::string>& more = {});
/// A lower bound: the indirect light is measured alone, and the technique's own direct light is added.
ErrorRow measureBound(const ErrorBench& bench, const SweepPoint& point);
/// A point by glReadPixels: the published program solves the scene, and its solution is displayed and judged.
/// "setup_ms" includes the solving, "published" describes the solution. Of a scene with too many triangles a coarser
/// model is solved and drawn (radiosity/original/coarse_scene.hpp). Empty, with nothing stored, if interrupted.
ErrorRow measurePublished(const ErrorBench& bench, const SweepPoint& point);
/// A line for the report if such a row is of a coarser model; otherwise empty.
std::string describePublished(const ErrorRow& row);
/// Writes the row into the folder.
void keepRow(const ErrorBench& bench, const SweepPoint& point, const ErrorRow& row);
/// The path tracer's sweeps, corrected and as published: one picture observed at 1, 2, 4, ... samples, one row each.
/// `deviations`: also each deviation alone, one row each. Empty if interrupted; finished series are kept.
std::vector<ErrorRow> measurePath(const ErrorBench& bench, bool deviations);

/// Writes the tone-mapped picture and both heat maps against `reference` as PNGs; returns their common path within the
/// folder, without ".png". `ownError`: the picture's own standard error if it is sampled, else null. Next to the PNGs
/// it writes the linear picture (.pfm), FLIP's map (.flip.png, grey 0..255 for 0..1) and that standard error
/// (.error.pfm).
std::string writePictures(const ErrorBench& bench, const std::string& name, const Image& picture,
                          const measure::Reference& reference, const std::vector<float>& flip, const Image* ownError);
/// The file that stores the row of that name.
std::filesystem::path rowFile(const std::filesystem::path& folder, const std::string& name);

/// The fields of a row, or of its "inside_model".
nlohmann::ordered_json errorsJson(const JudgedPicture& judged);
/// Rows "black" and "constant", against all light: pictures of no cost, without time.
std::vector<ErrorRow> baselines(const References& references);
/// The same inside each model by which a technique is judged.
struct InsideModel {
  std::string name;
  ErrorRow black, constant;
};
std::vector<InsideModel> insideModels(const References& references);
/// The light that the point's technique promises, restricted to lights in the scene.
TechniqueModel modelOf(const SweepPoint& point, measure::LightKinds scene);

/// Fills "inside_front": whether the row is on the front of its technique and model by `ms` and the l2 inside the model
/// (true without a model). Then "pareto" by `ms` and `l2` among those, and "front": 1 for the fastest on it, 0 off it.
void markFront(std::vector<ErrorRow>& rows);
/// After markFront: the front by `ms` and `l2` among "inside_front" rows that are not as published, by time. A
/// published row that beats them all does not empty it.
std::vector<const ErrorRow*> correctedFront(const std::vector<ErrorRow>& rows);
/// "More is better": for every series whose points are steps, its errors in order (inside the model where all points
/// have the same, else of all light; null at the reference's noise), and the steps after which the error is larger by
/// more than two standard errors, which the reference's noise gives.
struct Sweep {
  std::string series, model;  ///< model: empty for all light
  std::vector<std::string> labels;
  std::vector<double> errors;  ///< relative L2; NaN at the reference's noise
  struct Rise {
    std::size_t to = 0;  ///< index of the worse one, the other is before it
    double by = 0.0, error = 0.0;  ///< difference and its standard error
  };
  std::vector<Rise> rises;
};
std::vector<Sweep> sweepsOf(const std::vector<ErrorRow>& rows);
/// The value by which the row is ranked: its l2 or nrmse, or the smallest that the reference can resolve.
double rankedError(const ErrorRow& row, const char* measure);
/// A number of a row; NaN if it is null or missing.
double number(const ErrorRow& row, const char* key);

}  // namespace lucerna::demo::bench
