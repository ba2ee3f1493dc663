// lucerna-labs: the command `lab` by itself, without museum and mystery, which render. It needs a fraction of the
// build.
#include "labs/command.hpp"
#include "run_commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Lucerna's teaching labs.\nStart with: lucerna-labs lab list", "lucerna-labs"};
  app.set_version_flag("--version", LUCERNA_VERSION);
  app.require_subcommand(1);
  CLI::App* lab = app.add_subcommand("lab", "Teaching labs that check and grade themselves");
  return lucerna::demo::runCommands(app, {{lab, lucerna::demo::addLabs(*lab)}}, argc, argv);
}
