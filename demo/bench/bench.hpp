// `lucerna bench`: its subcommands, one file each.
#pragma once

#include "originals/originals.hpp"

namespace lucerna::demo {

Work addBenchRays(Command app);
Work addBenchError(Command app);
Work addBenchReferences(Command app);
Work addBenchFrame(Command app);
Work addBenchStability(Command app);
Work addBenchDynamic(Command app);
Work addBenchFeatures(Command app);
Work addBenchAll(Command app);
Work addCheck(Command app);
Work addTune(Command app);

}  // namespace lucerna::demo
