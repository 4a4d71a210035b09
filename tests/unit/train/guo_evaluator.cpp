// The data and the settings with which Guo's evaluator is trained, and its rows in TMR's tables.
#include <set>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/train/guo_config.hpp>
#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/guo_matching_training.hpp>
#include <motionlang/train/guo_movement_training.hpp>
#include <motionlang/train/guo_retrieval.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

namespace {

ml::DescribedMotion motion(const std::string& id, std::vector<ml::DescribedText> texts, Index frames, Index width) {
  ml::DescribedMotion out{id, id, std::vector<float>(static_cast<std::size_t>(width * frames)), std::move(texts)};
  for (std::size_t i = 0; i < out.rows.size(); ++i) out.rows[i] = static_cast<float>(i % 7) - 3;
  return out;
}

}  // namespace

TEST_CASE("presets of the evaluator have the published numbers") {
  const auto movement = ml::guo_preset("guo-published", ml::GuoStage::movement),
             matching = ml::guo_preset("guo-published", ml::GuoStage::matching);
  CHECK(movement.movement.window == 24);
  CHECK(movement.optimiser.batch == 128);
  CHECK(movement.optimiser.epochs == 270);
  CHECK(movement.optimiser.clip_norm == 0);
  CHECK(matching.optimiser.batch == 8);
  CHECK(matching.optimiser.clip_norm == 0.5);
  CHECK(matching.matching.margin == 10);
  CHECK(matching.optimiser.weight_decay == 0);
  for (const auto& config : {movement, matching, ml::guo_preset("small", ml::GuoStage::matching)}) {
    auto read = config;
    const nlohmann::json document = ml::config_json(config);
    CHECK_NOTHROW(ml::read_config(read, ml::JsonView(document, "preset")));
  }
  CHECK_ERROR(ml::guo_preset("x", ml::GuoStage::movement), "[motionlang.config.103] preset 'x' is not guo-published");
  ml::GuoMovementConfig odd;
  odd.window = 10;
  CHECK_ERROR(odd.require_sound(), "window is 10");
}

TEST_CASE("windows of the movement stage: the first of two equal ones, never the last start") {
  ml::GuoTrainingConfig config;
  ml::DescribedMotions data{.width = 2, .fps = 20, .training = {}, .validation = {}, .test = {}};
  for (const Index frames : {24, 25, 30, 60})
    data.training.push_back(motion(std::to_string(frames), {{"walk", {0, frames}}}, frames, 2));
  const auto windows = ml::detail::guo_training_windows(config, data);
  REQUIRE(windows.size() == 1 + 6 + 36);
  CHECK(windows[0] == ml::ClipWindow{0, 0});
  CHECK(windows[1] == ml::ClipWindow{1, 0});
  CHECK(windows.back() == ml::ClipWindow{3, 34});
  config.movement.window = 64;
  CHECK_ERROR(ml::detail::guo_training_windows(config, data), "movement.window = 64 frames; the longest has 60");
  CHECK(ml::detail::training_windows(data, 24, "tokenizer.window") == windows);
  CHECK_ERROR(
      ml::detail::training_windows(data, 64, "tokenizer.window"),
      "[motionlang.config.102] no motion to train on has more than tokenizer.window = 64 frames; the longest has "
      "60");
  data.training.clear();
  CHECK_ERROR(ml::detail::training_windows(data, 24, "tokenizer.window"),
              "[motionlang.config.102] no motion to train on has more than tokenizer.window = 24 frames");
}

TEST_CASE("entries have 40 to 199 frames, the shortest first; parts of clips are entries of their own") {
  const std::vector<ml::DescribedMotion> part{
      motion("a", {{"walk", {0, 120}}, {"someone walks", {0, 120}}, {"turn", {10, 50}}}, 120, 3),
      motion("short", {{"sit", {0, 39}}}, 39, 3), motion("long", {{"run", {0, 200}}}, 200, 3)};
  const auto entries = ml::guo_entries(part, 263);
  REQUIRE(entries.size() == 2);
  CHECK(entries[0].frames == ml::FrameSlice{10, 50});
  CHECK(entries[1].texts.size() == 2);
  CHECK(ml::guo_entries({}, 263).empty());
  CHECK(ml::guo_entries(part, 251).size() == 3);  // KIT: from 24 on

  auto rng = ml::Philox{.seed = 3};
  std::set<std::string> texts;
  std::set<Index> lengths;
  for (int i = 0; i < 60; ++i) {
    const auto s = ml::guo_sample(entries[1], rng);
    texts.insert(s.text->text), lengths.insert(s.frames.length);
    CHECK(s.frames.first >= 0);
    CHECK(s.frames.first + s.frames.length <= 120);
  }
  CHECK(texts == std::set<std::string>{"walk", "someone walks"});
  CHECK(lengths == std::set<Index>{116, 120});
  CHECK(ml::tagged_text({"a man walks", {}, {{"man", "NOUN"}, {"walk", "VERB"}}}) == "man/NOUN walk/VERB");
  CHECK(ml::tagged_text({"a man walks", {}, {}}) == "a man walks");

  ml::DescribedMotions data{.width = 3, .fps = 20, .training = part, .validation = {}, .test = {}};
  data.training.erase(data.training.begin());
  CHECK_ERROR(ml::detail::guo_training_entries(data), "0 texts with 40 to 199 frames: two are needed");
}

TEST_CASE("a movement encoder and statistics of other features are refused before the matching stage learns") {
  auto init = ml::Philox{.seed = 1};
  const ml::MovementEncoder<B> encoder(259, 4, 8, init);
  CHECK(ml::tensors_of(encoder).at(0).shape()[1] == 259);  // what the training compares
  CHECK_NOTHROW(ml::detail::require_guo_widths(263, 259, 263));
  CHECK_ERROR(ml::detail::require_guo_widths(263, 247, 263),
              "[motionlang.config.102] the movement encoder reads 247 numbers, the motions have 263 and 4 of them are "
              "contacts");
  CHECK_ERROR(ml::detail::require_guo_widths(263, 259, 251),
              "[motionlang.config.102] the statistics have 251 numbers, the motions have 263");
}

TEST_CASE("figures of motions need replications, and none or more than ten repeats") {
  CHECK_NOTHROW(ml::detail::require_guo_figure_options({.replications = 1, .repeats = 0, .seed = 0}));
  CHECK_NOTHROW(ml::detail::require_guo_figure_options({.replications = 1, .repeats = 11, .seed = 0}));
  for (const Index none : {0, -1})
    CHECK_ERROR(ml::detail::require_guo_figure_options({.replications = none, .repeats = 0, .seed = 0}),
                "[motionlang.config.101] `replications`");
  CHECK_ERROR(ml::detail::require_guo_figure_options({.replications = 1, .repeats = 10, .seed = 0}),
              "[motionlang.config.101] multimodality by 10 motions of a text");
}

TEST_CASE("the folder of a stage: statistics are found beside the checkpoint, and the choice of the data") {
  const TemporaryFolder place;
  ml::GuoTrainingConfig config;
  config.data.split_seed = 7, config.data.mirror = true;
  const ml::Normalizer<B> statistics{ml::Tensor<B, 1>::from({1, 2, 3}, {3}), ml::Tensor<B, 1>::from({4, 5, 6}, {3})};
  const ml::GloVe words({"sos", "eos", "unk"}, std::vector<float>(6), 2);
  const std::map<std::string, std::string> about{{"license", "MIT"}, {"provenance", "made up"}};
  ml::save_guo_folder<B>(place / "out/model", "guo evaluator", config, 20, about, statistics, &words);
  const auto found = ml::guo_statistics_near<B>(place / "out/model/finest.tar", 3);
  REQUIRE(found.has_value());
  CHECK(found->mean.to_vector() == std::vector<float>{1, 2, 3});
  CHECK(found->std.to_vector() == std::vector<float>{4, 5, 6});
  CHECK(found->eps == 0);
  CHECK(!ml::guo_statistics_near<B>(place / "finest.tar", 3).has_value());
  CHECK(ml::read_glove(place / "out/model/glove/our_vab").size() == 3);
  const auto data = ml::data_config_of(place / "out/model");
  REQUIRE(data.has_value());
  CHECK(data->split_seed == 7);
  CHECK(!data->mirror);
  CHECK(!ml::data_config_of(place.path).has_value());
}

TEST_CASE("the nearest answer, not the most parallel one, when distances are wanted") {
  const std::vector<float> texts{1, 0, 0, 1, 3, 0}, motions{1.1f, 0, 0, 1, 2.9f, 0.5f};
  const std::vector<std::string> ids{"a", "b", "c"};
  const auto r = [&](bool euclidean) {
    return ml::retrieve(ml::RetrievalProtocol::normal, ml::Rows(std::span<const float>(texts), 2),
                        ml::Rows(std::span<const float>(motions), 2),
                        {.threshold = 0.95, .batch = 32, .ids = ids, .nsim_ids = {}, .euclidean = euclidean});
  };
  CHECK(r(true).text_to_motion.recall[0] == doctest::Approx(100));
  CHECK(r(false).text_to_motion.recall[0] == doctest::Approx(200.0 / 3));  // c is more parallel to a's motion
}
