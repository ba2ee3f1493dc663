// `lucerna bench error` as a function, for those that build on it: tune, bench all.
#pragma once

#include "bench/error_report.hpp"
#include "parts.hpp"

namespace lucerna::demo::bench {

struct ErrorBenchOptions {
  std::string scene, camera, size = "160x90", out, references;
  std::vector<std::string> techniques;  ///< empty: all
  double budget = 120.0;  ///< seconds for references and path tracing together
  std::uint64_t referenceSamples = 0;  ///< 0: by time
  int frames = 5;
  bool deviations = false, small = false, quiet = false;
  PartOptions part;  ///< of rows; the command's alone

  void declare(Command app);
  void declareView(Command app);  ///< of them what decides the references
};

struct ErrorBenchResult {
  ErrorReport report;
  References references;  ///< report.references points here once placed
  bool complete = false;  ///< false: interrupted; what was finished lies in the folder
  std::size_t partRows = 0;  ///< of a part: its rows, which lie in its folder; there is no report
};

/// What is measured, before anything is.
struct ErrorBenchPlan {
  Scene scene;  ///< without highlights
  Camera camera;
  glm::ivec2 size;
  std::vector<std::string> techniques, leftOut;
  std::vector<Rung> rungs;
  std::vector<TechniqueModel> models;
  std::string title;
  bool withPath = false;

  ErrorBenchPlan(const Scene& original, const ErrorBenchOptions& options);
  ReferenceRequest references(const gl::Context& context, gl::ProgramLibrary& programs,
                              const ErrorBenchOptions& options, const std::filesystem::path& own = {}) const;
};

/// Measures what the folder does not hold yet; writes rows, CSV, plots and page into it. Throws Error(badInput) for
/// options that cannot be.
std::unique_ptr<ErrorBenchResult> runErrorBench(const gl::Context& context, gl::ProgramLibrary& programs,
                                                const Scene& scene, const ErrorBenchOptions& options,
                                                const std::string& hostName);
/// The same for a command: loads the scene, makes the host, says so where it was interrupted and is then null.
std::unique_ptr<ErrorBenchResult> benchScene(const CommonOptions& common, ErrorBenchOptions& options);
nlohmann::ordered_json errorBenchJson(const ErrorBenchResult& result, const ErrorBenchOptions& options);

}  // namespace lucerna::demo::bench
