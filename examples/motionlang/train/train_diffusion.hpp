// The commands train-mdm-smpl, train-mdm and train-motiondiffuse: options, data, the run, the folder of the model.
#pragma once

#include <cstdio>
#include <memory>

#include <motionlang/train/diffusion_training.hpp>

#include "training_command.hpp"

namespace program {

struct DiffusionOptions {
  TrainingOptions common;
  CaptionOptions texts;
  std::filesystem::path text_encoder, statistics;
};

template <class System>
void run_diffusion(const DiffusionOptions& o, typename System::Config config) {
  using B = TrainingBackend;
  constexpr bool of_data_set = !std::is_same_v<System, ml::MdmSmplSystem>;  // HumanML3D or KIT-ML
  ml::DataSources sources = o.texts.sources(o.common);
  if (of_data_set ? !configure(config, o.common, sources) : !configure(config, o.common)) return;
  const bool states = System::states(config);
  as_usage([&] {
    config.require_consistent();
    ml::require_text_source(config.text, o.text_encoder, states);
  });
  std::filesystem::path statistics = o.statistics;
  if (of_data_set && statistics.empty() && std::filesystem::exists(o.common.data / "Mean.npy")) {
    statistics = o.common.data;
    std::printf("mean and deviation of %s\n", (statistics / "Mean.npy").string().c_str());
  }
  const auto data = read_data(sources, config.data, ml::row_maker(config.features));
  std::printf("%zu different texts\n", ml::all_texts(data).size());
  auto texts = ml::diffusion_texts<B>(System::name, config.text, states, o.text_encoder, data);
  train(ml::DiffusionTraining<TrainingTape, System>(config, data, std::move(texts), statistics), o.common, data);
}

/// The options of such a command. `presets` holds their names; the first is the default.
struct DiffusionCommand {
  CLI::App* app;
  std::shared_ptr<DiffusionOptions> options = std::make_shared<DiffusionOptions>();

  DiffusionCommand(CLI::App& program, const char* name, const char* what, const std::vector<std::string>& presets,
                   const char* about_text_encoder)
      : app(program.add_subcommand(name, what)) {
    add_training_options(*app, options->common, presets);
    options->texts.add_to(*app);
    path_option(*app, "--text-encoder", options->text_encoder, about_text_encoder);
    folder_option(*app, "--statistics", options->statistics,
                  "Folder with mean and std of the features. The default is Mean.npy and Std.npy in --data, if the "
                  "system reads data sets that have them, otherwise the statistics of the training motions");
  }
};

template <class System>
void run_diffusion(const DiffusionOptions& o, typename System::Config (*preset)(const std::string&)) {
  run_diffusion<System>(o, named_preset([&] { return preset(o.common.preset); }));
}

template <class System>
void add_diffusion(CLI::App& app, const char* name, const char* what, const std::vector<std::string>& presets,
                   typename System::Config (*preset)(const std::string&), const char* about_text_encoder) {
  const DiffusionCommand c(app, name, what, presets, about_text_encoder);
  c.app->callback([o = c.options, preset] { run_diffusion<System>(*o, preset); });
}

}  // namespace program
