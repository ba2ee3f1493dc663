// Output from the rows of `lucerna bench error`: terminal table, CSV, plots, HTML.
#pragma once

#include "base/provenance.hpp"
#include "bench/error_rows.hpp"
#include "shared/html.hpp"

namespace lucerna::demo::bench {

struct ErrorReport {
  std::string title;  ///< scene, camera, size
  std::string renderer, driver, host, cpu;
  std::string command;  ///< repeats the measurement, without --out
  float exposure = 1.0f;  ///< of the pictures as first displayed
  std::vector<ErrorRow> rows;
  std::vector<ErrorRow> baselines;  ///< "black" and "constant", against all light
  std::vector<ModelError> model;
  std::vector<InsideModel> inside;  ///< models of the rows' techniques
  const References* references = nullptr;
  bool isDeviationStudy = false;
  std::vector<std::string> leftOut;  ///< what was not measured, or only of a coarser scene, with reasons
  nlohmann::ordered_json before;  ///< the report of an earlier program, drawn beside this one; null: none
};

/// The JSON of a report, or of the folder that holds it. Throws Error(badInput) if it is none.
nlohmann::ordered_json readErrorReport(const std::string& path);
std::string terminalTable(const ErrorReport& report);
/// A sentence: which technique to use for which time of a picture, from the front. Empty without rows.
std::string choiceText(const std::vector<ErrorRow>& rows);
nlohmann::ordered_json choiceJson(const std::vector<ErrorRow>& rows);
/// Baselines and rows.
std::string csvOf(const ErrorReport& report);
/// Exponents of the error of the path tracer's corrected sweep; null with fewer than three rows above the reference's
/// noise.
nlohmann::ordered_json pathSlopeJson(const std::vector<ErrorRow>& rows);
nlohmann::ordered_json sweepsJson(const std::vector<ErrorRow>& rows);
nlohmann::ordered_json modelJson(const std::vector<ModelError>& model);
nlohmann::ordered_json insideModelsJson(const std::vector<InsideModel>& inside);
nlohmann::ordered_json referencesJson(const References& references);
/// error: all light; error_inside: indirect light inside each model. Writes SVG and PNG. Warns once and returns false
/// if gnuplot is missing.
bool plotRows(const std::filesystem::path& folder, const ErrorReport& report);
/// Adds its sections to `page`; pictures and plot are read from the folder. `bytes`: limit for the figure's linear
/// pictures in the page.
void addToPage(HtmlPage& page, const std::filesystem::path& folder, const ErrorReport& report, std::size_t bytes);

}  // namespace lucerna::demo::bench
