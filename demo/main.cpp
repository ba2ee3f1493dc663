// lucerna: one executable, one subcommand per file.
#include "check/command.hpp"
#include "cluster.hpp"
#include "command_tree.hpp"
#include "commands.hpp"
#include "labs/command.hpp"
#include "merge.hpp"
#include "run_commands.hpp"

#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"Lucerna: real-time global illumination, measured.\nStart with: lucerna walk", "lucerna"};
  app.set_version_flag("--version", LUCERNA_VERSION);
  lucerna::demo::Subcommands commands{lucerna::demo::Command(app)};
  commands.add("walk", "Walk through a scene along its camera path; without a window, write pictures and stage times",
               lucerna::demo::addWalk);
  commands.add("render", "Render one picture of a scene", lucerna::demo::addRender);
  commands.add("merge", "Merge parts made by --part (samples, frames, batches, rows)", lucerna::demo::addMerge);
  commands.add("cluster", "Divide a command's work into tasks, for Slurm or for processes of this machine",
               lucerna::demo::addCluster);
  commands.add("radiosity", "Radiosity by hemicubes: generate a model, solve it, show it", lucerna::demo::addRadiosity);
  commands.add("info", "Host, driver, limits, extensions; a scene's counts and needs", lucerna::demo::addInfo);
  commands.add("check", "How this machine's GPU and driver do: right pictures, hangs, times; a page for a bug report",
               lucerna::demo::addCheck);
  commands.add("media", "Participating media: the catalogue; a scene JSON drafted from an MTL",
               lucerna::demo::addMedia);
  commands.add("bench",
               "Measure: error over time, stability, unneeded features; reproduce published tables and pictures",
               lucerna::demo::addBench);
  commands.add("compare", "Errors between two HDR pictures, with heat maps", lucerna::demo::addCompare);
  commands.add("tune", "Measure a scene, and choose the technique and settings that meet a frame time or an error",
               lucerna::demo::addTune);
  commands.add("lab", "Teaching labs that check and grade themselves", lucerna::demo::addLab);
  commands.add("completion", "Print a completion script for a shell", lucerna::demo::addCompletion);
  commands.add("manual", "Print the manual page, in roff", lucerna::demo::addManual);
  return lucerna::demo::runCommands(lucerna::demo::Command(app), commands.work(), argc, argv);
}
