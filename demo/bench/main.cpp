// lucerna-bench: the commands that measure.
#include "bench/bench.hpp"
#include "bench/diff.hpp"
#include "shared/programs.hpp"

namespace {

lucerna::demo::Work addBench(lucerna::demo::Command app) {
  using namespace lucerna::demo;
  Subcommands commands(app);
  addOriginals(commands);
  commands.add("rays", "Rays per second of the compute-shader hierarchy, compared with Embree on the same rays",
               addBenchRays);
  commands.add("error", "Error against run time: every technique over a sweep of settings", addBenchError);
  commands.add("references", "Only the references of bench error, optionally in parts", addBenchReferences);
  commands.add("frame", "A frame pass by pass: a page with each pass's picture, time and the error that it removes",
               addBenchFrame);
  commands.add("diff",
               "Two reports of bench error row by row: better, worse or undecided, by a test that uses both spreads",
               addBenchDiff);
  commands.add("stability", "Stiff and extreme cases: expected, measured, verdict", addBenchStability);
  commands.add("dynamic", "A sequence of moments, each against its own reference: error, lag, ghosts, flicker, time",
               addBenchDynamic);
  commands.add("features", "The features that a scene does not need, and what leaving them out saves",
               addBenchFeatures);
  commands.add("all", "The whole report on one page: tables, error, stability, features, rays", addBenchAll);
  return commands.work();
}

}  // namespace

int main(int argc, char** argv) {
  using namespace lucerna::demo;
  return runProgram({"lucerna", LUCERNA_VERSION, "Lucerna's measurements."}, argc, argv,
                    [](Command program, Subcommands& commands) {
                      commands.add("bench", descriptionOf("bench"), addBench);
                      commands.add("check", descriptionOf("check"), addCheck);
                      commands.add("tune", descriptionOf("tune"), addTune);
                      addTree(commands, program);
                    });
}
