// lucerna bench tables|pictures|rays: reproduces published results of the originals.
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

Work addBench(Command app) {
  Subcommands commands(app);
  commands.add("tables", "Reproduce an original's published tables: published, measured, ratio", addBenchTables);
  commands.add("pictures", "Reproduce an original's published pictures on one labelled sheet", addBenchPictures);
  commands.add("rays", "Rays per second of the compute-shader hierarchy, compared with Embree on the same rays",
               addBenchRays);
  commands.add("error", "Error against run time: every technique over a ladder of settings", addBenchError);
  commands.add("references", "Only the references of bench error, optionally in parts", addBenchReferences);
  commands.add("diff",
               "Two reports of bench error row by row: better, worse or undecided, by a test that uses both spreads",
               addBenchDiff);
  commands.add("stability", "Stiff and extreme cases: expected, measured, verdict", addBenchStability);
  commands.add("needs", "The features that a scene does not need, and what leaving them out saves", addBenchNeeds);
  commands.add("all", "The whole report on one page: tables, error, stability, needs, rays", addBenchAll);
  return commands.work();
}

}  // namespace lucerna::demo
