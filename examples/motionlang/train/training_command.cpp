#include "training_command.hpp"

#include <cmath>
#include <cstdio>

#include "../files/motion_files.hpp"
#include "../usage_error.hpp"

namespace program {

void add_training_options(CLI::App& command, TrainingOptions& o, const std::vector<std::string>& presets) {
  o.preset = presets.front();
  std::string names = presets.front();
  for (std::size_t i = 1; i < presets.size(); ++i) names += (i + 1 < presets.size() ? ", " : " or ") + presets[i];
  folder_option(command, "--data", o.data, "Folder with the clips of the table, or in the form of HumanML3D or KIT-ML");
  folder_option(command, "--splits", o.splits,
                "Folder with train.txt, val.txt and test.txt. The default is a random split");
  command.add_option("--preset", o.preset, "Hyperparameters: " + names)->capture_default_str();
  file_option(command, "--config", o.config, "JSON with the hyperparameters that differ from the preset");
  command.add_option("--set", o.set, "One hyperparameter, such as optimiser.lr=3e-4; may be repeated")
      ->allow_extra_args(false);
  command.add_flag("--print-config", o.print_config, "Print all hyperparameters as JSON and stop");
  command.add_option("--out", o.run.out, "Folder for checkpoint, curves and model")->capture_default_str();
  command.add_option("--save-minutes", o.run.save_minutes, "Minutes between checkpoints")->capture_default_str();
  command.add_flag("--fresh", o.run.fresh, "Start over even if there is a checkpoint");
  command.add_flag("--other-settings", o.run.other_settings,
                   "Continue a checkpoint that began with other rates or weights of losses");
  command.add_flag("--recompute", o.run.recompute, about_recompute);
  command.add_option("--license", o.license, "Licence of the weights, for their metadata")->capture_default_str();
  command.add_option("--provenance", o.provenance, "Origin of the data, for the metadata")->capture_default_str();
  command.add_option("--commit", o.commit, "Commit of the program, for the metadata");
  o.machine.add_to(command);
  add_micro_batch_option(command, o.run);
}

void LabelOptions::add_to(CLI::App& command) {
  file_option(command, "--labels", labels,
              "Table of clips, with columns clip, start, end, label; or clip, label for whole clips. With "
              "--annotations: the id of a segment or motion, or a text, and its label");
  file_option(
      command, "--annotations", annotations,
      "Annotation file (JSON) whose paths lead into --data: BABEL's own with categories of actions, or the unified "
      "one with a label for each segment");
}

void CaptionOptions::add_to(CLI::App& command) {
  file_option(command, "--captions", captions,
              "Table of clips, with columns clip, start, end, body parts, captions; or clip, captions for whole clips");
  file_option(command, "--annotations", annotations, "Unified annotation file (JSON); its paths lead into --data");
}

bool begin_training(const TrainingOptions& o, const nlohmann::ordered_json& config) {
  if (o.print_config) {
    std::printf("%s\n", config.dump(2).c_str());
    return false;
  }
  if (o.data.empty()) ml::raise<usage_error>(102, "--data is required");
  training_processes(o.run);
  o.machine.apply();
  make_output_folder("--out", o.run.out);
  return true;
}

void require_assignments(const std::vector<std::string>& set) {
  for (const std::string& assignment : set) {
    if (assignment.find('=') == assignment.npos)
      ml::raise<usage_error>(103, "--set ", assignment, ": expected name=value");
  }
}

void print_parts(const ml::DescribedMotions& data) {
  std::printf("%s to train on, %zu for validation, %zu for tests; %s\n",
              ml::counted(data.training.size(), "motion").c_str(), data.validation.size(), data.test.size(),
              data.left_out.text().c_str());
}
void print_results(const TrainingOptions& o) {
  std::printf("model    %s\nlosses   %s\n", (o.run.out / "model").string().c_str(),
              (o.run.out / "loss.svg").string().c_str());
}

ml::DescribedMotions read_motions_of(const ml::DataSources& sources, const ml::DataConfig& config,
                                     const ml::RowMaker& rows) {
  as_usage([&] { sources.require_sound(); });
  ProgressBar bar("reading motions");
  return ml::read_described_motions(sources, config, rows, bar);
}

ml::DescribedMotions read_data(const ml::DataSources& sources, const ml::DataConfig& config, const ml::RowMaker& rows) {
  auto data = read_motions_of(sources, config, rows);
  print_parts(data);
  return data;
}

std::map<std::string, std::string> about(const TrainingOptions& o, const ml::DescribedMotions& data) {
  double frames = 0;
  for (const ml::DescribedMotion& m : data.training)
    frames += static_cast<double>(m.rows.size()) / static_cast<double>(data.width);
  return {{"license", o.license},
          {"provenance", o.provenance},
          {"data", ml::concat_text(ml::counted(data.training.size(), "motion"), ", ",
                                   std::floor(frames / data.fps / 6) / 10, " minutes")},
          {"command", command_line},
          {"commit", o.commit},
          {"version", MOTIONLANG_VERSION}};
}

}  // namespace program
