// lucerna-labs: only the command `lab`, without museum and mystery, which render. It needs a fraction of the build.
#include "labs/command.hpp"
#include "run_commands.hpp"

#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"Lucerna's teaching labs.\nStart with: lucerna-labs lab list", "lucerna-labs"};
  app.set_version_flag("--version", LUCERNA_VERSION);
  lucerna::demo::Subcommands commands{lucerna::demo::Command(app)};
  commands.add("lab", "Teaching labs that check and grade themselves", [](lucerna::demo::Command lab) {
    lucerna::demo::Subcommands labs(lab);
    lucerna::demo::addLabs(labs);
    return labs.work();
  });
  return lucerna::demo::runCommands(lucerna::demo::Command(app), commands.work(), argc, argv);
}
