// motionlang train-sinc: motions for simultaneous actions.
#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/train/sinc_training.hpp>

#include "train_babel.hpp"

namespace program {

void add_train_sinc(CLI::App& app) {
  const auto o = std::make_shared<BabelOptions>();
  const auto tags = std::make_shared<std::filesystem::path>();
  CLI::App* c = add_babel_options(app, "train-sinc",
                                  "Trains SINC, which generates motions from several actions at the same time. Ctrl-C "
                                  "saves; the same command continues",
                                  *o, {"sinc-published", "sinc-paper", "small"});
  file_option(*c, "--body-parts", o->body_parts,
              "JSON of labels and the body parts that a language model named for them, as SINC has it. Training then "
              "combines actions of different parts (data.proportion)");
  file_option(*c, "--tags", *tags,
              "Labels tagged by spaCy, one per line: 'wave#wave/VERB#0.0#0.0'. They give the -ing form after while and "
              "during");
  c->callback([o, tags] {
    std::optional<ml::BodyPartTable> table;
    std::optional<ml::LabelTags> words;
    run_babel(*o, named_preset([&] { return ml::sinc_preset(o->common.preset); }), &ml::sinc_reader,
              [&](const ml::SincTrainingConfig& config, const ml::DescribedMotions& data, ml::TextStates states) {
                if (!o->body_parts.empty()) table = ml::open_body_part_table(ml::FilePath(o->body_parts));
                if (!tags->empty()) words.emplace(ml::FilePath(*tags));
                return ml::SincTraining<TrainingTape>(config, data, std::move(states), o->statistics,
                                                      table ? &*table : nullptr, words ? &*words : nullptr);
              });
  });
}

}  // namespace program
