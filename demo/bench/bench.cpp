// lucerna bench tables|pictures|rays: published results of the originals, made again.
#include "bench/bench.hpp"

#include "base/data.hpp"
#include "base/error.hpp"
#include "bench/diff.hpp"

namespace lucerna::demo {

namespace bench {

void checkOriginal(const std::string& name) {
  if (name != "lpv" && name != "rad" && name != "vpt")
    throwBadInput("--original {}: unknown; expected one of lpv, rad, vpt", name);
}

std::string asset(const std::string& file) { return (dataFolder() / "assets" / file).string(); }

std::string sceneOrAtrium(const std::string& scene) { return scene.empty() ? asset("atrium/atrium.json") : scene; }

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
  add("rays", "Rays per second of the compute-shader hierarchy, beside Embree on the same rays", addBenchRays);
  add("error", "Error against run time: every technique over a ladder of settings", addBenchError);
  add("references", "The references of bench error alone, in parts where they are to be", addBenchReferences);
  add("diff", "Two reports of bench error row by row: better, worse or undecided, by a test that knows both spreads",
      addBenchDiff);
  add("stability", "Stiff and extreme cases: expected, measured, verdict", addBenchStability);
  add("needs", "What a scene leaves out, and what that saves", addBenchNeeds);
  add("all", "The whole report on one page: tables, error, stability, needs, rays", addBenchAll);
  return [commands] {
    for (const auto& [command, work] : *commands)
      if (command->parsed()) return work();
    return 0;
  };
}

}  // namespace lucerna::demo
