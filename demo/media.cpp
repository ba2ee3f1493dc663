// lucerna media list|draft: the catalogue of participating media, and a scene JSON of the VPT original drafted from an
// MTL.
#include "base/error.hpp"
#include "base/files.hpp"
#include "shared/commands.hpp"
#include "scene/media_catalogue.hpp"
#include "scene/original_scene_file.hpp"

#include <fmt/core.h>

#include <cmath>

namespace lucerna::demo {

namespace {

struct MediaOptions {
  CommonOptions common;
  std::string mtl, output;
};

std::string triple(const glm::dvec3& v) { return fmt::format("{:.5g} {:.5g} {:.5g}", v.x, v.y, v.z); }
nlohmann::ordered_json array(const glm::dvec3& v) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (int c = 0; c < 3; ++c) json.push_back(v[c]);
  return json;
}

int list(const MediaOptions& options) {
  options.common.apply();
  nlohmann::ordered_json json;
  json["unit"] = "1/mm";
  json["media"] = nlohmann::ordered_json::array();
  fmt::print("{:<35}{:<28}{:<30}{:<20}{:<6}{:<28}{:<28}{}\n", "medium", "sigma_s R G B, 1/mm", "sigma_a R G B, 1/mm",
             "g R G B", "ior", "albedo R G B", "mean free path, mm", "source");
  for (const CatalogueMedium& m : mediaCatalogue()) {
    fmt::print("{:<35}{:<28}{:<30}{:<20}{:<6g}{:<28}{:<28}{}\n", m.name, triple(m.scattering), triple(m.absorption),
               triple(m.anisotropy), m.ior, triple(m.albedo()), triple(m.meanFreePath()), m.source);
    json["media"].push_back({{"name", m.name},
                             {"sigma_s", array(m.scattering)},
                             {"sigma_a", array(m.absorption)},
                             {"g", array(m.anisotropy)},
                             {"ior", m.ior},
                             {"albedo", array(m.albedo())},
                             {"mean_free_path", array(m.meanFreePath())},
                             {"published", m.published},
                             {"source", m.source}});
  }
  options.common.writeJson(json);
  return 0;
}

int draft(const MediaOptions& options) {
  options.common.apply();
  const auto [text, report] = draftOriginalScene(options.mtl);
  if (options.output.empty()) fmt::print("{}", text);
  else writeFileAtomically(options.output, text);
  if (!options.common.quiet)
    for (const std::string& line : report) fmt::print(stderr, "{}\n", line);
  nlohmann::ordered_json json;
  json["mtl"] = options.mtl;
  json["report"] = report;
  json["scene"] = nlohmann::ordered_json::parse(text);
  options.common.writeJson(json);
  return 0;
}

}  // namespace

Work addMedia(Command app) {
  Subcommands commands(app);
  auto options = std::make_shared<MediaOptions>();
  Command listed = commands.add("list", "The catalogue: the original's twelve media and 27 measured liquids",
                                [options] { return list(*options); });
  options->common.declare(listed);
  Command drafted = commands.add("draft", "Draft the original's scene JSON from an MTL, to be edited",
                                 [options] { return draft(*options); });
  drafted.addOption("MTL", options->mtl, "the material library; an OBJ of the same stem gives camera and light")
      .required();
  drafted.addOption("-o,--output", options->output, "FILE.json (default: standard output)");
  options->common.declare(drafted);
  return commands.work();
}

}  // namespace lucerna::demo
