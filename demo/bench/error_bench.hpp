// `lucerna bench error` as a function, for callers that build on it: tune, bench all.
#pragma once

#include "bench/error_report.hpp"
#include "shared/parts.hpp"

namespace lucerna::demo::bench {

/// The scene as references see it, Lambertian only: forward shading would add highlights that references lack (in the
/// atrium 1.3 % of direct light).
Scene withoutHighlights(Scene scene);

struct ErrorBenchOptions {
  std::string scene, camera, size = "160x90", out, references, before;
  std::vector<std::string> techniques;  ///< sweeps; empty: all, or none if there are points
  std::vector<std::string> points;  ///< pictures besides, as parseSweepPoint() takes them
  double time = 0.0;  ///< at which the scene is posed, seconds
  double budget = 120.0;  ///< seconds for references and path tracing together
  std::uint64_t referenceSamples = 0;  ///< 0: by time
  int frames = 5, pixelSamples = PictureOptions::kPixelSamples;
  std::string filter = "box";  ///< of references and pictures
  bool deviations = false, small = false, bounds = false, quiet = false;
  PartOptions part;  ///< of rows; only for the command itself

  void declare(Command app);
  void declareView(Command app);  ///< only the options that determine the references
};

struct ErrorBenchResult {
  ErrorReport report;
  References references;  ///< report.references points here once placed
  bool complete = false;  ///< false: interrupted; finished rows are in the folder
  std::size_t partRows = 0;  ///< for a part: its number of rows, stored in its folder; there is no report
};

/// The plan, made before anything is measured.
struct ErrorBenchPlan {
  Scene scene;  ///< without highlights
  Camera camera;
  glm::ivec2 size;
  PixelFilter filter;
  int pixelSamples;
  std::vector<std::string> techniques, leftOut;
  std::vector<SweepPoint> points;
  std::vector<TechniqueModel> models;
  std::string title;
  bool withPath = false;

  ErrorBenchPlan(const Scene& original, const ErrorBenchOptions& options);
  ReferenceRequest references(const gl::Context& context, gl::ProgramLibrary& programs,
                              const ErrorBenchOptions& options, const std::filesystem::path& own = {}) const;
};

/// Measures everything that the folder does not hold yet; writes rows, CSV, plots and page into it. Throws
/// Error(badInput) for invalid options.
std::unique_ptr<ErrorBenchResult> runErrorBench(const gl::Context& context, gl::ProgramLibrary& programs,
                                                const Scene& scene, const ErrorBenchOptions& options,
                                                const std::string& hostName);
/// The same for a command: loads the scene and creates the host. Reports an interruption, and then returns null.
std::unique_ptr<ErrorBenchResult> benchScene(const CommonOptions& common, ErrorBenchOptions& options);
nlohmann::ordered_json errorBenchJson(const ErrorBenchResult& result, const ErrorBenchOptions& options);

}  // namespace lucerna::demo::bench
