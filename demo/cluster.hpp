// lucerna cluster plan|run|status|join: a command's work as tasks for Slurm or for processes of this machine (no GL).
//
// Task K of N is the command with --part K/N. A job is a folder:
//   job.json       the command and the number of tasks; never changed
//   parts/K        task K's checkpoint (parts.hpp), which says when the task is done
//   parts/K.film   the same of a picture's samples; parts/K.json is written last and says that the task is done
//   logs/K.log     the messages of task K
//   lock           held by `cluster run` and its tasks
//   whole          all parts as one checkpoint, made by the join; of samples whole.film
//   array.sbatch, join.sbatch, submit   for Slurm
#pragma once

#include "shared/command_line.hpp"

namespace lucerna::demo {

Work addCluster(Command app);

}  // namespace lucerna::demo
