// What the commands train-tmr, train-temos, train-sinc, train-teach, train-tm2t, train-actor and train-classifier have
// in common: options, configuration, reading of data.
#pragma once

#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "../commands.hpp"
#include "../machine_options.hpp"
#include "config_json.hpp"
#include "described_motions.hpp"
#include "trainer.hpp"

namespace program {

struct TrainingOptions {
  std::filesystem::path data, splits, config;
  std::string preset;
  std::vector<std::string> set;
  bool print_config = false;
  RunOptions run;
  std::string license = "not stated", provenance = "own training", commit;
  MachineOptions machine;
};

/// Where the actions of train-actor and train-classifier are from.
struct LabelOptions {
  std::filesystem::path labels, annotations;

  void add_to(CLI::App& command);
  DataSources sources(const TrainingOptions& o) const { return {o.data, {}, labels, annotations, o.splits, true}; }
};

/// Where the texts of train-tmr, train-temos and train-tm2t are from.
struct CaptionOptions {
  std::filesystem::path captions, annotations;

  void add_to(CLI::App& command);
  DataSources sources(const TrainingOptions& o) const { return {o.data, captions, {}, annotations, o.splits}; }
};

/// `presets` are their names; the first is taken unless another is named.
void add_training_options(CLI::App& command, TrainingOptions& o, const std::vector<std::string>& presets);

/// How many motions each part has.
void tell_parts(const DescribedMotions& data);
/// Where the model and the curves are.
void tell_results(const TrainingOptions& o, const std::filesystem::path& model);

/// Reads the motions and says how many there are.
DescribedMotions read_data(const TrainingOptions& o, const DataSources& sources, const DataConfig& config,
                           const RowMaker& rows);

/// License, provenance, data, command: for the metadata of a model.
std::map<std::string, std::string> about(const TrainingOptions& o, const DescribedMotions& data);

/// Puts --config and --set over a preset.
template <ml::Module C>
void read_settings(C& config, const TrainingOptions& o);
/// The same, and puts --threads and --precision to work. False if it was only to be printed.
template <ml::Module C>
bool configure(C& config, const TrainingOptions& o);

/// Prints, and applies --threads and --precision.
bool begin_training(const TrainingOptions& o, const nlohmann::ordered_json& config);

template <ml::Module C>
void read_settings(C& config, const TrainingOptions& o) {
  if (!o.config.empty()) {
    const auto document = ml::read_json(o.config);
    read_config(config, ml::JsonView(document, o.config.string()));
  }
  set_config(config, o.set);
}

template <ml::Module C>
bool configure(C& config, const TrainingOptions& o) {
  read_settings(config, o);
  return begin_training(o, config_json(config));
}

}  // namespace program
