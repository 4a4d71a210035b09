// The processes that mpirun or srun started together.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <motionlang/train/trainer.hpp>

namespace program {

/// Those of this program; it alone if it was not started with others. All but the first one print nothing but errors.
/// Throws usage_error 102 if others were started and this program was built without MPI.
const motionlang::AnyCommunicator& processes();

/// The last call of main: waits for the others, or ends them if this process failed. Returns the code.
int end_processes(int code);

/// The options --micro-batch and --wire.
void add_micro_batch_option(CLI::App& command, motionlang::TrainingOptions& o);

/// Throws usage_error 102 if there are several processes, for work that one process does.
/// what  names it: "generate --towards"
void require_one_process(const std::string& what);

/// The processes for a training. Throws usage_error 102 if there are several and the option --micro-batch is missing.
const motionlang::AnyCommunicator& training_processes(const motionlang::TrainingOptions& o);

}  // namespace program
