// The training of the bundled model, for the commands train and train-mdm-smpl --preset bundled.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include <CLI/CLI.hpp>

#include <motionlang/train/stmc_training_config.hpp>
#include <motionlang/train/trainer.hpp>

namespace program {

namespace ml = motionlang;

struct StmcRun {
  std::filesystem::path data, captions, vectors, start;
  ml::StmcTrainingConfig config;
  ml::TrainingOptions run;
  std::map<std::string, std::string> about;  // license, provenance, commit
};

/// The options --word-vectors and --start. `when` begins their help.
void add_start_options(CLI::App& command, StmcRun& o, const std::string& when = {});
/// A training that starts from a model need not learn texts first, unless a setting says so.
void skip_texts_of(StmcRun& o);

/// Reads the clips, trains, prints where the model is. Begins when processes, threads and the folder are ready.
void run_stmc(const StmcRun& o);

}  // namespace program
