// The commands train-tmr and train-temos: options, data, the run, the folder of the model.
#pragma once

#include <cstdio>

#include <motionlang/train/text_motion_texts.hpp>

#include "training_command.hpp"

namespace program {

struct TextMotionOptions {
  TrainingOptions common;
  CaptionOptions texts;
  ml::TextMotionFiles files;
};

template <class Training>
void run_text_motion(const TextMotionOptions& o, ml::TextMotionConfig config) {
  using B = TrainingBackend;
  ml::DataSources sources = o.texts.sources(o.common);
  if (!configure(config, o.common, sources)) return;
  as_usage([&] { ml::reads_pieces(config.text, o.files.text_encoder); });
  as_usage([&] { ml::require_pieces(config.text, o.files); });
  auto language = ml::finetuned_language_model<B>(config.text, o.files.text_encoder);
  const auto data = read_data(sources, config.data, ml::row_maker(config.features));
  std::printf("%zu different texts\n", ml::all_texts(data).size());
  auto texts = ml::text_motion_texts<B>(config.text, o.files, data, std::move(language));
  train(Training(config, data, std::move(texts), o.files.statistics), o.common, data);
}

template <class Training>
void add_text_motion(CLI::App& app, const char* name, const char* what, const char* published,
                     ml::TextMotionConfig (*preset)(const std::string&)) {
  const auto o = std::make_shared<TextMotionOptions>();
  CLI::App* c = app.add_subcommand(name, what);
  add_training_options(*c, o->common, {published, "small"});
  o->texts.add_to(*c);
  path_option(*c, "--text-encoder", o->files.text_encoder,
              "DistilBERT: a folder, which text.finetune trains as well, or the .npy file of an embedding cache");
  path_option(*c, "--sentence-encoder", o->files.sentence_encoder,
              "MPNet, which finds texts of equal meaning: a folder or a cache. The default is to compare the words "
              "of all texts about the same frames");
  file_option(*c, "--word-vectors", o->files.word_vectors,
              "Vectors of words beyond those of the captions, from `motionlang word-vectors`, for a model with word "
              "pieces. Every word that the captions say twice then is one piece");
  folder_option(*c, "--statistics", o->files.statistics,
                "Folder with mean and std of the features, such as HumanML3D or KIT-ML with Mean.npy and Std.npy. The "
                "default is the statistics of the training motions, as in the published programs");
  c->callback([o, preset] { run_text_motion<Training>(*o, named_preset([&] { return preset(o->common.preset); })); });
}

}  // namespace program
