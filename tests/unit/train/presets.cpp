// Hyperparameters by name, and the batches of an epoch.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include <motionlang/file/fields_json.hpp>
#include <motionlang/train/epoch_batches.hpp>
#include <motionlang/train/presets.hpp>
#include <motionlang/train/tm2t_config.hpp>
#include <motionlang/weights/actor_training_config.hpp>
#include <motionlang/weights/babel_config.hpp>
#include <motionlang/weights/text_motion_config.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("presets have the published numbers; an unknown name is reported with those that there are") {
  CHECK(ml::tmr_preset("tmr-published").losses.temperature == 0.1);
  CHECK(ml::temos_preset("temos-published").optimiser.epochs == 1001);
  CHECK(ml::sinc_preset("sinc-published").optimiser.lr == 3e-4);
  CHECK(ml::teach_preset("teach-published").optimiser.batch == 8);
  CHECK(ml::actor_preset("actor-variable").clips.num_frames == -2);
  CHECK(ml::classifier_preset("stgcn-published").kind == "stgcn");
  CHECK(ml::tm2t_preset("tm2t-published-kit", ml::Tm2tStage::text_to_motion).optimiser.clip_norm == 0.5);
  CHECK_ERROR(ml::tmr_preset("x"), "[motionlang.config.103] preset 'x' is not tmr-published or small");
  CHECK_ERROR(ml::temos_preset("x"), "preset 'x' is not temos-published or small");
  CHECK_ERROR(ml::sinc_preset("x"), "preset 'x' is not sinc-published, sinc-paper or small");
  CHECK_ERROR(ml::teach_preset("x"), "preset 'x' is not teach-published, teach-paper or small");
  CHECK_ERROR(ml::actor_preset("x"), "preset 'x' is not actor-published, actor-published-ntu13");
  CHECK_ERROR(ml::classifier_preset("x"), "preset 'x' is not stgcn-published, gru-published or small");
  CHECK_ERROR(ml::tm2t_preset("x", ml::Tm2tStage::tokenizer), "preset 'x' is not tm2t-published, tm2t-published-kit");
}

TEST_CASE("the papers' own numbers, where the published programs have others") {
  const auto sinc = ml::sinc_preset("sinc-paper");
  CHECK(sinc.optimiser.batch == 64);
  CHECK(sinc.optimiser.rate(900, 1000) == 3e-4);  // no steps
  CHECK(sinc.losses.kl == 1);
  CHECK(sinc.data.longest == 600);
  const auto teach = ml::teach_preset("teach-paper");
  CHECK(teach.optimiser.lr == 1e-4);
  CHECK(teach.network.mask_padding);
  const auto tokenizer = ml::tm2t_preset("tm2t-paper", ml::Tm2tStage::tokenizer);
  CHECK(tokenizer.optimiser.lr == 2e-4);
  CHECK(std::abs(tokenizer.tokenizer.feature_bias * tokenizer.tokenizer.feature_bias - 5) < 1e-12);
  CHECK(ml::tm2t_preset("tm2t-paper", ml::Tm2tStage::text_to_motion).text_to_motion.forced_last == 0.4);
  // ACTOR's numbers of epochs for its three data sets, and UESTC's shortest motion
  CHECK(ml::actor_preset("actor-published").optimiser.epochs == 5000);
  CHECK(ml::actor_preset("actor-published-ntu13").optimiser.epochs == 2000);
  const auto uestc = ml::actor_preset("actor-published-uestc");
  CHECK(uestc.optimiser.epochs == 1000);
  CHECK(45 / uestc.clips.fps >= uestc.data.min_seconds);
  CHECK(44 / uestc.clips.fps < uestc.data.min_seconds);
}

TEST_CASE("every preset passes its own checks") {
  const auto sound = [](auto config) {
    const nlohmann::json document = ml::config_json(config);
    CHECK_NOTHROW(ml::read_config(config, ml::JsonView(document, "preset")));
  };
  for (const char* name : {"tmr-published", "small"}) sound(ml::tmr_preset(name));
  for (const char* name : {"temos-published", "small"}) sound(ml::temos_preset(name));
  for (const char* name : {"sinc-published", "sinc-paper", "small"}) sound(ml::sinc_preset(name));
  for (const char* name : {"teach-published", "teach-paper", "small"}) sound(ml::teach_preset(name));
  for (const char* name :
       {"actor-published", "actor-published-ntu13", "actor-published-uestc", "actor-variable", "small"})
    sound(ml::actor_preset(name));
  for (const char* name : {"stgcn-published", "gru-published", "small"}) sound(ml::classifier_preset(name));
  for (const char* name : {"tm2t-published", "tm2t-published-kit", "tm2t-paper", "small"})
    sound(ml::tm2t_preset(name, ml::Tm2tStage::motion_to_text));
}

TEST_CASE("an epoch has every item once, in an order of its own") {
  const ml::EpochBatches batches(10, 4);
  CHECK(batches.per_epoch() == 3);
  std::vector<ml::Index> first, second;
  for (ml::Index k = 0; k < 3; ++k) {
    for (const ml::Index i : batches(k, 7)) first.push_back(i);
    for (const ml::Index i : batches(k + 3, 7)) second.push_back(i);
  }
  CHECK(first.size() == 10);
  CHECK(std::set<ml::Index>(first.begin(), first.end()).size() == 10);
  CHECK(std::set<ml::Index>(second.begin(), second.end()).size() == 10);
  CHECK(first != second);
  CHECK(batches(2, 7).size() == 2);
  CHECK(batches(1, 7) == std::vector<ml::Index>(first.begin() + 4, first.begin() + 8));
  CHECK_ERROR(ml::EpochBatches(0, 4), "[motionlang.config.101] batches of 4 out of 0 items");
}

TEST_CASE("values that cannot work are refused by name") {
  ml::ActorLossConfig losses{.rc = 0, .rcxyz = 0, .kl = 0};
  CHECK_ERROR(losses.require_any(), "[motionlang.config.101] losses.rc, rcxyz, kl, vel and velxyz are 0");
  losses.velxyz = -1;
  CHECK_ERROR(losses.require_sound(), "velxyz");
  ml::TeachTrainingConfig teach = ml::teach_preset("small");
  teach.network.hist_frames = teach.data.shortest + 1;
  CHECK_ERROR(teach.require_sound(), "[motionlang.config.102] data.shortest is ");
  CHECK_ERROR(ml::TeachLossesConfig{.velocity = -0.5}.require_sound(), "velocity");
  CHECK_ERROR(ml::TextTokensConfig{.width = 0}.require_sound(), "width");
  CHECK_ERROR(ml::TextMotionLossConfig{.margin = -1}.require_sound(), "margin");
}
