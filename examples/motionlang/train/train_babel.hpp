// The commands train-sinc and train-teach: options, data, the run, the folder of the model.
#pragma once

#include <cstdio>

#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/weights/text_states.hpp>

#include "training_command.hpp"

namespace program {

struct BabelOptions {
  TrainingOptions common;
  std::filesystem::path babel, validation, spelling, text_encoder, statistics, body_parts;
};

inline CLI::App* add_babel_options(CLI::App& app, const char* name, const char* what, BabelOptions& o,
                                   const std::vector<std::string>& presets) {
  CLI::App* c = app.add_subcommand(name, what);
  add_training_options(*c, o.common, presets);
  c->get_option("--data")->description("Folder of the motions, such as AMASS; the paths feat_p of BABEL lead into it");
  file_option(*c, "--babel", o.babel, "BABEL's train.json");
  file_option(*c, "--babel-validation", o.validation,
              "BABEL's val.json, for validation. The default is a part of --babel, chosen by --splits or at random");
  file_option(*c, "--spelling", o.spelling, "JSON of words in labels and their replacements");
  path_option(*c, "--text-encoder", o.text_encoder, "DistilBERT: a folder, or the .npy file of an embedding cache");
  folder_option(*c, "--statistics", o.statistics,
                "Folder with mean and std of the features. The default is the statistics of the training motions");
  return c;
}

/// make(config, data, states): the training.
template <class Config, class Make>
void run_babel(const BabelOptions& o, Config config, ml::BabelReader (*reader)(const decltype(Config::data)&),
               Make make) {
  read_settings(config, o.common);
  config.require_sound();
  if (!begin_training(o.common, ml::config_json(config))) return;
  const ml::BabelSources sources{o.common.data, o.babel, o.validation, o.common.splits, o.spelling};
  as_usage([&] { sources.require_sound(); });
  const bool pieces = as_usage([&] { return ml::reads_pieces(config.text, o.text_encoder); });
  if (config.text.finetune)
    ml::raise<ml::config_error>(
        102, "text.finetune is for train-tmr and train-temos; this command does not train DistilBERT");
  const auto data = [&] {
    ProgressBar bar("reading motions");
    return ml::read_babel_motions(sources, config.features, ml::split_config(config.data), reader(config.data), bar);
  }();
  print_parts(data);
  std::printf("%zu different labels\n", ml::all_texts(data).size());
  train(make(config, data, pieces ? ml::TextStates() : ml::text_states<TrainingBackend>(o.text_encoder)), o.common,
        data);
}

}  // namespace program
