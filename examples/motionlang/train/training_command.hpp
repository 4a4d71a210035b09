// The common part of train-tmr, train-temos, train-sinc, train-teach, train-tm2t, train-actor and train-classifier:
// options, configuration, reading of data, output.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/file/fields_json.hpp>
#include <motionlang/train/trainer.hpp>

#include "../commands.hpp"
#include "../machine_options.hpp"
#include "processes.hpp"
#include "training_display.hpp"

namespace program {

namespace ml = motionlang;

/// The backend of all trainings.
using TrainingBackend = ml::EigenBackend<float>;
using TrainingTape = ml::Autodiff<TrainingBackend>;

struct TrainingOptions {
  std::filesystem::path data, splits, config;
  std::string preset;
  std::vector<std::string> set;
  bool print_config = false;
  ml::TrainingOptions run;
  std::string license = "not stated", provenance = "own training", commit;
  MachineOptions machine;
};

/// The source of the actions of train-actor, train-classifier and train-mdm-actions.
struct LabelOptions {
  std::filesystem::path labels, annotations;

  void add_to(CLI::App& command);
  ml::DataSources sources(const TrainingOptions& o) const { return {o.data, {}, labels, annotations, o.splits, true}; }
};

/// The source of the texts of the trainings that take captions.
struct CaptionOptions {
  std::filesystem::path captions, annotations;

  void add_to(CLI::App& command);
  ml::DataSources sources(const TrainingOptions& o) const { return {o.data, captions, {}, annotations, o.splits}; }
};

/// `presets` holds their names; the first is the default.
void add_training_options(CLI::App& command, TrainingOptions& o, const std::vector<std::string>& presets);

/// Prints the number of motions in each part.
void print_parts(const ml::DescribedMotions& data);
/// Prints the places of the model and the curves.
void print_results(const TrainingOptions& o);

/// ml::read_described_motions with a progress bar.
ml::DescribedMotions read_motions_of(const ml::DataSources& sources, const ml::DataConfig& config,
                                     const ml::RowMaker& rows);
/// The same, and prints their numbers.
ml::DescribedMotions read_data(const ml::DataSources& sources, const ml::DataConfig& config, const ml::RowMaker& rows);

/// License, provenance, data, command: for the metadata of a model.
std::map<std::string, std::string> about(const TrainingOptions& o, const ml::DescribedMotions& data);

/// Throws usage_error 103 unless each is name=value.
void require_assignments(const std::vector<std::string>& set);
/// Prints, finds the other processes, and applies --threads and --precision.
bool begin_training(const TrainingOptions& o, const nlohmann::ordered_json& config);

/// Puts --config and --set over a preset.
template <ml::Module C>
void read_settings(C& config, const TrainingOptions& o) {
  if (!o.config.empty()) {
    const auto document = ml::read_json(o.config);
    ml::read_config(config, ml::JsonView(document, o.config.string()));
  }
  require_assignments(o.set);
  for (const std::string& assignment : o.set) ml::set_config(config, assignment, "--set " + assignment);
}
/// The same, and applies --threads and --precision. False if the configuration was only to be printed.
template <ml::Module C>
bool configure(C& config, const TrainingOptions& o) {
  read_settings(config, o);
  return begin_training(o, ml::config_json(config));
}
/// The same. Unless a setting names the features, they are those of ready-made rows in the data, or else of the preset.
template <ml::Module C>
bool configure(C& config, const TrainingOptions& o, ml::DataSources& sources) {
  const std::string usual = std::exchange(config.features, {});
  read_settings(config, o);
  if (config.features.empty()) config.features = ml::ready_made_features(sources);
  if (config.features.empty()) config.features = usual;
  return begin_training(o, ml::config_json(config));
}

/// Trains, and prints the result.
template <ml::TrainingTask Task>
void train(Task task, const TrainingOptions& o, const ml::DescribedMotions& data) {
  TrainingDisplay display;
  ml::TrainingOptions run = o.run;
  run.communicator = processes();
  ml::train(std::move(task), run, about(o, data), display.callbacks());
  print_results(o);
}

}  // namespace program
