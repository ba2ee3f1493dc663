// lucerna: one subcommand per file; those of other programs (shared/programs.hpp) are started beside it.
#include "cluster.hpp"
#include "merge.hpp"
#include "shared/commands.hpp"
#include "shared/programs.hpp"

int main(int argc, char** argv) {
  using namespace lucerna::demo;
  if (const int code = startOther(argc, argv)) return code;
  constexpr const char* kDescription =
      "Lucerna: real-time global illumination, measured.\nStart with: lucerna walk; "
      "lucerna help COMMAND describes a command";
  return runProgram({"lucerna", LUCERNA_VERSION, kDescription}, argc, argv, [](Command, Subcommands& commands) {
    commands.add("walk", "Walk through a scene along its camera path; without a window, write pictures and stage times",
                 addWalk);
    commands.add("render", "Render one picture of a scene", addRender);
    commands.add("merge", "Merge parts made by --part (samples, frames, batches, rows)", addMerge);
    commands.add("cluster", "Distribute work over many machines: by a shared folder, by Slurm, or on this machine only",
                 addCluster);
    commands.add("radiosity", "Radiosity by hemicubes: generate a model, solve it, show it", addRadiosity);
    commands.add("info", "Host, driver, limits, extensions; a scene's counts and features", addInfo);
    addOther(commands, "check");
    commands.add("media", "Participating media: the catalogue; a scene JSON drafted from an MTL", addMedia);
    addOther(commands, "bench");
    commands.add("compare", "Errors between two HDR pictures, with heat maps", addCompare);
    addOther(commands, "tune");
    addOther(commands, "lab");
    commands.add("completion", "Print a completion script for a shell", addCompletion);
    commands.add("manual", "Print the manual page, in roff", addManual);
  });
}
