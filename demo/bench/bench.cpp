// lucerna bench tables|pictures: published results of the originals, made again.
#include "bench/bench.hpp"

#include "base/error.hpp"

#include <filesystem>

namespace lucerna::demo {

namespace bench {

void checkOriginal(const std::string& name) {
  if (name != "lpv" && name != "rad") throwBadInput("--original {}: unknown; there are lpv, rad", name);
}

std::string sceneOrAtrium(const std::string& scene) {
  return scene.empty() ? (std::filesystem::path(LUCERNA_SOURCE_DIR) / "assets/atrium/atrium.json").string() : scene;
}

}  // namespace bench

Work addBench(CLI::App& app) {
  app.require_subcommand(1);
  auto commands = std::make_shared<std::vector<std::pair<CLI::App*, Work>>>();
  const auto add = [&](const char* name, const char* description, Work (*declare)(CLI::App&)) {
    CLI::App* command = app.add_subcommand(name, description);
    commands->emplace_back(command, declare(*command));
  };
  add("tables", "Measure an original's published tables again: published, measured, ratio", addBenchTables);
  add("pictures", "Make an original's published pictures again, on one labelled sheet", addBenchPictures);
  return [commands] {
    for (const auto& [command, work] : *commands)
      if (command->parsed()) return work();
    return 0;
  };
}

}  // namespace lucerna::demo
