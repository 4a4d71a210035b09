// The same as several_processes.cpp for trainings with texts, of classifiers and of evaluators. TMR and the evaluator
// compare all samples of a batch.
#include <doctest/doctest.h>

#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/datasets/described_words.hpp>
#include <motionlang/train/classifier_training.hpp>
#include <motionlang/train/guo_matching_training.hpp>
#include <motionlang/train/guo_movement_training.hpp>
#include <motionlang/train/sinc_training.hpp>
#include <motionlang/train/teach_training.hpp>
#include <motionlang/train/temos_training.hpp>
#include <motionlang/train/tm2t_describer_training.hpp>
#include <motionlang/train/tm2t_tokenizer_training.hpp>
#include <motionlang/train/tm2t_transformer_training.hpp>
#include <motionlang/train/tm2t_writer_training.hpp>
#include <motionlang/train/tmr_training.hpp>

#include "../support/check_error.hpp"
#include "../support/divided_training.hpp"

using namespace divided;

namespace {

/// Motions with one text or two. Any five of the seven to train on have two with the same text.
ml::DescribedMotions described_motions(Index width, std::string key = {}) {
  const std::vector<std::string> texts{"a person walks",     "someone jumps",    "a person walks",
                                       "someone turns left", "a dog jumps high", "someone turns left",
                                       "a person walks",     "a cat sits",       "a dog walks"};
  auto out = motions_of_noise(
      width, 7, 9, [](int i) { return Index{48 + 4 * (i * 3 % 7)}; },
      [&](int i, Index frames) {
        std::vector<ml::DescribedText> own{{texts[static_cast<std::size_t>(i)], {0, frames}}};
        if (i % 3 == 1) own.push_back({"it " + texts[static_cast<std::size_t>(i) + 1], {0, frames}});
        return own;
      });
  if (!key.empty()) {
    for (ml::DescribedMotion& m : out.training) m.id = key + m.id;
  }
  return out;
}
/// Two actions in each motion.
ml::DescribedMotions pairs_of_actions(Index width) {
  return motions_of_noise(
      width, 7, 9, [](int i) { return Index{40 + 3 * (i * 3 % 7)}; },
      [](int i, Index frames) {
        return std::vector<ml::DescribedText>{{i % 2 == 0 ? "walk" : "turn", {0, 15 + i % 3}},
                                              {i % 3 == 0 ? "jump" : "sit", {18 + i % 3, frames - 18 - i % 3}}};
      });
}

ml::TextMotionConfig tiny_tmr() {
  auto config = tiny_with_texts(ml::tmr_preset("small"));
  config.losses.threshold = 0.6;
  return config;
}
ml::Tm2tTrainingConfig tiny_tm2t(ml::Tm2tStage stage) {
  auto c = ml::tm2t_preset("small", stage);
  c.tokenizer.channels = {6, 6}, c.tokenizer.codes = 12, c.tokenizer.residual_blocks = 1, c.tokenizer.window = 40;
  c.motion_to_text.latent_dim = 8, c.motion_to_text.ff_size = 8, c.motion_to_text.num_layers = 1;
  c.motion_to_text.num_heads = 2;
  c.text_to_motion.latent_dim = 8, c.text_to_motion.ff_size = 8, c.text_to_motion.num_layers = 1;
  c.text_to_motion.num_heads = 2, c.text_to_motion.text_hidden = 6, c.text_to_motion.motion_hidden = 8;
  c.text_to_motion.word_width = 6, c.text_to_motion.alignment = false;
  c.optimiser.batch = 5, c.optimiser.epochs = stage == ml::Tm2tStage::tokenizer ? 1 : 4;
  c.optimiser.schedule = "constant", c.optimiser.lr = 0.01;
  c.validation.every = 2;
  return c;
}

}  // namespace

TEST_CASE("TMR: every sample is compared with all others, without those whose texts mean the same") {
  const auto data = described_motions(263);
  const auto config = tiny_tmr();
  const auto make = [&] { return ml::TmrTraining<A>(config, data); };
  check_parts(make());
  check_processes(make);
  // The filter decides: without it, the loss is another one.
  auto unfiltered = config;
  unfiltered.losses.threshold = 0;
  const auto loss = [&](const ml::TextMotionConfig& c) {
    auto task = ml::TmrTraining<A>(c, data);
    const ml::Philox rng{.seed = 3};
    const ml::AnyCommunicator alone;
    ml::PartThreads threads;
    ml::detail::StepParts<ml::TmrTraining<A>> parts{.task = task,
                                                    .communicator = alone,
                                                    .threads = threads,
                                                    .rng = rng,
                                                    .step = 0,
                                                    .micro_batch = 1,
                                                    .recompute = false};
    return parts.sum().front();
  };
  CHECK(loss(config) < loss(unfiltered));
}

TEST_CASE("TMR with a learned temperature, texts that no motion shows, and strange words") {
  const auto data = described_motions(263);
  auto config = tiny_tmr();
  config.losses.learned_temperature = true, config.losses.strangers = 4, config.text.strange_words = 0.5;
  const auto make = [&] { return ml::TmrTraining<A>(config, data); };
  check_parts(make());
  check_processes(make);
}

TEST_CASE("TMR with a margin, without reconstruction, and without a loss that compares") {
  const auto data = described_motions(263);
  auto config = tiny_tmr();
  config.losses.contrastive_loss = "margin", config.losses.recons = 0, config.network.vae = false;
  check_parts(ml::TmrTraining<A>(config, data));
  config.losses.contrastive_loss = "none", config.losses.recons = 1;
  check_parts(ml::TmrTraining<A>(config, data));
}

TEST_CASE("fifty steps of TMR, and a resume from four processes with one") {
  const auto data = described_motions(263);
  auto config = tiny_tmr();
  config.optimiser.epochs = 25;  // of two batches
  const auto make = [&] { return ml::TmrTraining<A>(config, data); };
  const TemporaryFolder folder;
  const std::string one = trained(make, folder / "1", 1);
  for (const Index processes : {2, 4}) {
    CAPTURE(processes);
    const Threads two(2);
    CHECK(trained(make, folder / ("of" + std::to_string(processes)), processes) == one);
  }
  trained(make, folder / "parts", 4, 2, 23);
  CHECK(trained(make, folder / "parts", 1) == one);
  CHECK(ml::values_of<float>(ml::SafetensorsFile::open(folder / "parts/checkpoint.safetensors").tensor("losses"))
            .size() == 50);
}

TEST_CASE("TEMOS, with transformers and recurrent networks") {
  const auto data = described_motions(263);
  auto config = tiny_with_texts(ml::temos_preset("small"));
  const auto make = [&] { return ml::TemosTraining<A>(config, data); };
  check_parts(make());
  check_processes(make);
  config.network.motion_encoder = config.network.motion_decoder = "gru";
  check_parts(make());
}

TEST_CASE("SINC: sentences, texts of their own, and latents of their own") {
  const auto data = described_motions(135);
  auto config = tiny_with_texts(ml::sinc_preset("small"));
  config.data.proportion = 0;
  for (const char* texts : {"joined", "separate", "latents"}) {
    CAPTURE(texts);
    config.network.texts = texts;
    const auto make = [&] { return ml::SincTraining<A>(config, data); };
    check_parts(make());
    if (config.network.texts != "separate") check_processes(make);
  }
}

TEST_CASE("SINC: motions that are combined from two") {
  const auto data = described_motions(135, "seg-");
  auto config = tiny_with_texts(ml::sinc_preset("small"));
  config.data.proportion = 1, config.data.random = true;
  std::string parts = "{";
  for (const auto& text : ml::all_texts(data))
    parts += (parts.size() > 1 ? ", \"" : "\"") + text + "\": [\"\", \"\", \"Answer: left arm\"]";
  const TemporaryFolder folder;
  ml::write_file(folder / "parts.json", parts + "}");
  const auto table = ml::open_body_part_table(ml::FilePath(folder / "parts.json"));
  check_parts(ml::SincTraining<A>(config, data, {}, {}, &table));
}

TEST_CASE("TEACH, whose published encoder reads padding") {
  const auto data = pairs_of_actions(135);
  auto config = tiny_with_texts(ml::teach_preset("small"));
  config.losses.velocity = 0.5;
  for (const bool mask : {false, true}) {
    config.network.mask_padding = mask, config.losses.loss_on_transition = mask;
    const auto make = [&] { return ml::TeachTraining<A>(config, data); };
    check_parts(make());
    if (!mask) check_processes(make);
  }
}

TEST_CASE("classifiers: a GRU that starts from drawn states, and ST-GCN, whose parts meet in each norm") {
  auto config = ml::classifier_preset("small");
  config.clips.num_frames = 12, config.hidden_size = 8, config.drawn_state = true;
  config.optimiser.batch = 5, config.optimiser.epochs = 4, config.optimiser.lr = 0.01, config.validation.every = 2;
  const auto data = random_motions(config.clips.width());
  const auto make = [&] { return ml::ClassifierTraining<A>(config, data); };
  check_parts(make());
  check_processes(make);
  config.kind = "stgcn", config.clips.translation = false, config.width = 4;
  const auto rotations = random_motions(config.clips.width());
  const auto stgcn = [&] { return ml::ClassifierTraining<A>(config, rotations); };
  check_parts(stgcn());
  check_processes(stgcn);
  check_one_part(stgcn);
}

TEST_CASE("TM2T: the tokenizer without a discriminator, and with one") {
  const auto data = described_motions(263);
  auto config = tiny_tm2t(ml::Tm2tStage::tokenizer);
  const auto make = [&] { return ml::Tm2tTokenizerTraining<A>(config, data, ml::tm2t_statistics<B>(data, {}, 5)); };
  check_parts(make());
  check_processes(make);
  // From the second epoch on, a discriminator makes the first update of a step, and its parts meet in each norm.
  config.tokenizer.adversarial = 0.5, config.tokenizer.discriminator = 4, config.tokenizer.adversarial_from = 1;
  config.optimiser.epochs = 2;
  const Index first = make().steps() / 2;
  CHECK((make().updates(first - 1) == 1 && make().updates(first) == 2));
  check_processes(make);
  check_one_part(make);
  config.tokenizer.adversarial_from = 0;
  // The norms of the judge amplify rounding: the same case in double differs by 8e-14, 400 times its epsilon.
  for (const Index update : {0, 1}) check_parts(make(), update, 1e-4);
}

TEST_CASE("TM2T: from motions to texts, and from texts to motions") {
  const auto data = described_motions(263);
  auto config = tiny_tm2t(ml::Tm2tStage::text_to_motion);
  ml::Philox rng{.seed = 4};
  ml::TokenizedData<B> tokens{{}, ml::words_of(data, 6, rng)};
  tokens.model.statistics = ml::tm2t_statistics<B>(data, {}, 5);
  tokens.model.tokenizer =
      ml::MotionTokenizer<B>({.features = 263, .channels = {6, 6}, .codes = 12, .residual_blocks = 1, .beta = 1}, rng);
  tokens.tokenize(data);
  {
    const auto make = [&] { return ml::Tm2tDescriberTraining<A>(config, data, tokens); };
    check_parts(make());
    check_processes(make);
  }
  config.motion_to_text.tokens = false;
  check_parts(ml::Tm2tDescriberTraining<A>(config, data, tokens));
  {
    const auto make = [&] { return ml::Tm2tWriterTraining<A>(config, data, tokens); };
    check_parts(make());
    check_processes(make);
  }
  {  // two updates in a step, from the second epoch on
    config.text_to_motion.alignment = true, config.text_to_motion.alignment_from = 1;
    config.motion_to_text.tokens = true, config.motion_to_text.dropout = 0;
    tokens.model.m2t_transformer = ml::Seq2SeqTransformer<B>(
        ml::describer_sizes(config.motion_to_text, tokens.model.vocabulary(), tokens.words, data.width), rng);
    const auto make = [&] { return ml::Tm2tWriterTraining<A>(config, data, tokens); };
    CHECK((make().updates(1) == 1 && make().updates(2) == 2));
    check_processes(make);
    check_one_part(make);
    // The terms of each update are sums over the parts.
    config.text_to_motion.alignment_from = 0;
    // The norms of the judge amplify rounding: the same case in double differs by 8e-14, 400 times its epsilon.
    for (const Index update : {0, 1}) check_parts(make(), update, 1e-4);
    config.text_to_motion.alignment = false;
  }
  config.text_to_motion.network = "transformer";
  check_parts(ml::Tm2tTransformerTraining<A>(config, data, tokens));
}

TEST_CASE("the evaluator of Guo et al.: its movements, and its pair of encoders, which are compared") {
  const auto data = described_motions(263);
  auto config = ml::guo_preset("small", ml::GuoStage::movement);
  config.movement.hidden = 6, config.movement.latent = 6, config.movement.window = 40;
  config.matching.text_hidden = 6, config.matching.motion_hidden = 6, config.matching.embedding = 5;
  config.optimiser.batch = 5, config.optimiser.epochs = 1, config.optimiser.lr = 0.01, config.validation.every = 1;
  const auto statistics = ml::tm2t_statistics<B>(data, {}, 5);
  {
    const auto make = [&] { return ml::GuoMovementTraining<A>(config, data, statistics); };
    check_parts(make());
    check_processes(make);
  }
  ml::Philox rng{.seed = 4};
  const ml::GuoMatchingParts<B> parts{ml::MovementEncoder<B>(259, 6, 6, rng), statistics, ml::words_of(data, 6, rng)};
  config.optimiser.epochs = 4;
  const auto make = [&] { return ml::GuoMatchingTraining<A>(config, data, parts); };
  check_parts(make());
  check_processes(make);
}
