#include "originals/originals.hpp"

#include "base/data.hpp"
#include "base/error.hpp"

namespace lucerna::demo {

void addOriginals(Subcommands& commands) {
  commands.add("tables", "Reproduce an original's published tables: published, measured, ratio", addBenchTables);
  commands.add("pictures", "Reproduce an original's published pictures on one labelled sheet", addBenchPictures);
}

namespace bench {

void checkOriginal(const std::string& name) {
  if (name != "lpv" && name != "rad" && name != "vpt")
    throwBadInput("--original {}: unknown; expected one of lpv, rad, vpt", name);
}

std::string asset(const std::string& file) { return (dataFolder() / "assets" / file).string(); }

std::string sceneOrAtrium(const std::string& scene) { return scene.empty() ? asset("atrium/atrium.json") : scene; }

}  // namespace bench
}  // namespace lucerna::demo
