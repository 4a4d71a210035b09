// The commands train-tmr and train-temos: options, data, the run, the folder of the model.
#pragma once

#include "text_motion_task.hpp"
#include "text_sources.hpp"
#include "training_command.hpp"

namespace program {

struct TextMotionOptions {
  TrainingOptions common;
  CaptionOptions texts;
  std::filesystem::path text_encoder, sentence_encoder, statistics;
};

template <template <class> class System>
void run_text_motion(const TextMotionOptions& o, const TextMotionConfig& preset) {
  DataSources sources = o.texts.sources(o.common);
  TextMotionConfig config = preset;
  config.features.clear();
  read_settings(config, o.common);
  if (config.features.empty()) config.features = ready_made_features(sources);  // not named: those that are there
  if (config.features.empty()) config.features = preset.features;
  if (!begin_training(o.common, config_json(config))) return;
  const bool pieces = reads_pieces(config.text, o.text_encoder);
  if (config.text.finetune && (pieces || !std::filesystem::is_directory(o.text_encoder)))
    ml::raise<ml::config_error>(102, "text.finetune trains DistilBERT: text.encoder is '", config.text.encoder,
                                "', --text-encoder '", o.text_encoder.string(),
                                "', expected distilbert and its folder");
  std::optional<LanguageModel<TrainingBackend>> language;
  if (config.text.finetune) language = read_language_model<TrainingBackend>(o.text_encoder);
  const auto data = read_data(o.common, sources, config.data, row_maker(config.features));
  const auto texts = all_texts(data);
  std::printf("%zu different texts\n", texts.size());
  std::optional<ml::EmbeddingCache> states;
  if (!pieces && !language) states = token_states(o.text_encoder, texts);
  const auto sentences = sentence_vectors(o.sentence_encoder, data);
  Trainer trainer(
      TextMotionTask<System>(config, data, states ? &*states : nullptr, sentences, o.statistics, std::move(language)));
  trainer.run(o.common.run, [] {});
  const auto folder = o.common.run.out / "model";
  save_text_motion(folder, trainer.task().result(), trainer.task().config(), data.fps, about(o.common, data));
  tell_results(o.common, folder);
}

template <template <class> class System>
void add_text_motion(CLI::App& app, const char* name, const char* what, const char* published,
                     TextMotionConfig (*preset)(const std::string&)) {
  const auto o = std::make_shared<TextMotionOptions>();
  CLI::App* c = app.add_subcommand(name, what);
  add_training_options(*c, o->common, {published, "small"});
  o->texts.add_to(*c);
  c->add_option("--text-encoder", o->text_encoder,
                "DistilBERT: a folder, which text.finetune trains, too, or the .npy file of an embedding cache")
      ->check(CLI::ExistingPath);
  c->add_option("--sentence-encoder", o->sentence_encoder,
                "MPNet, which tells texts that mean the same: a folder or a cache; the words of all texts about the "
                "same frames are "
                "compared unless given")
      ->check(CLI::ExistingPath);
  c->add_option("--statistics", o->statistics,
                "Folder with mean and std of the features, such as that of HumanML3D or KIT-ML with Mean.npy and "
                "Std.npy; those of the "
                "motions to train on unless given, as the published programs have it")
      ->check(CLI::ExistingDirectory);
  c->callback([o, preset] { run_text_motion<System>(*o, preset(o->common.preset)); });
}

}  // namespace program
