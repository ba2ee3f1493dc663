// lucerna-originals: the published tables and pictures, and the museum of their deviations.
#include "originals/originals.hpp"
#include "shared/programs.hpp"

int main(int argc, char** argv) {
  using namespace lucerna::demo;
  return runProgram({"lucerna", LUCERNA_VERSION, "Lucerna's originals."}, argc, argv,
                    [](Command program, Subcommands& commands) {
                      commands.add("bench", descriptionOf("bench"), [](Command bench) {
                        Subcommands originals(bench);
                        addOriginals(originals);
                        return originals.work();
                      });
                      commands.add("lab", descriptionOf("lab"), [](Command lab) {
                        Subcommands museum(lab);
                        addMuseum(museum);
                        return museum.work();
                      });
                      addTree(commands, program);
                    });
}
