// lucerna-labs: the command `lab`, without museum and mystery, which render. It needs a fraction of the build.
#include "labs/command.hpp"
#include "shared/programs.hpp"

int main(int argc, char** argv) {
  using namespace lucerna::demo;
  return runProgram({"lucerna-labs", LUCERNA_VERSION, "Lucerna's teaching labs.\nStart with: lucerna-labs lab list"},
                    argc, argv, [](Command program, Subcommands& commands) {
                      commands.add("lab", descriptionOf("lab"), [](Command lab) {
                        Subcommands labs(lab);
                        addLabs(labs);
                        return labs.work();
                      });
                      addTree(commands, program);
                    });
}
