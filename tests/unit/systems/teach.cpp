// TEACH: the four ways to encode a text, training steps with all switches, sequences of actions.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/vae/teach_text_encoder.hpp>
#include <motionlang/vae/teach_training.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_teach_sinc.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;
using Past = ml::TeachPast<B>;
using tensors::distance, tensors::normal, tensors::same_bits;
namespace small = small_teach_sinc;

namespace {

ml::TeachNoise<B> noise(std::uint64_t seed = 5) { return ml::TeachNoise<B>::draw(3, 8, ml::Philox{.seed = seed}); }

}  // namespace

TEST_CASE("a text has the same latent alone and among others, with every past; each past gives another latent") {
  const auto model = small::teach<B>();
  const auto text = small::sequences<B>({2, 4, 1}, 5, 2), frames = small::sequences<B>({2, 2, 2}, 135, 3);
  const auto z = normal<B, 2>({3, 8}, 4);
  const std::vector<Past> pasts{{}, {.frames = frames}, {.z = z}, {.frames = frames, .z = z}};
  std::vector<ml::Tensor<B, 2>> means;
  for (const Past& past : pasts) {
    const auto all = model.encode_text(text, past);
    for (Index i = 0; i < 3; ++i) {
      Past own;
      if (past.frames) own.frames = ml::Sequences<B>((*past.frames)[i], Offsets{2});
      if (past.z) own.z = ml::slice(*past.z, 0, i, i + 1);
      const auto alone = model.encode_text({text[i], Offsets{text.offsets.length(i)}}, own);
      CHECK(distance(alone.mu, ml::slice(all.mu, 0, i, i + 1)) < 1e-13);
      CHECK(distance(alone.logvar, ml::slice(all.logvar, 0, i, i + 1)) < 1e-13);
    }
    for (const auto& other : means) CHECK(distance(all.mu, other) > 1e-3);
    means.push_back(all.mu);
  }
  CHECK_ERROR(model.encode_text(text, {.frames = small::sequences<B>({2, 3, 2}, 135, 3)}),
              "[motionlang.shape.205] TeachTextEncoder: 3 pasts of 7 frames");
}

TEST_CASE("branches: where the past comes from, padding, the terms of the loss") {
  const auto pairs = small::pairs<B>();
  const auto model = small::teach<B>();
  const auto out = model.branches(pairs, noise()), forced = model.branches(pairs, noise(), {}, true);
  const auto ends = [](const ml::Sequences<B>& x) { return ml::last_rows(x, Offsets{2, 2, 2}).rows; };
  CHECK(same_bits(out.past.rows, ends(pairs.first_motion.with(out.first.text.frames))));
  CHECK(same_bits(forced.past.rows, ends(pairs.first_motion)));
  CHECK(same_bits(out.first.text.z, forced.first.text.z));
  CHECK(distance(out.second.text.distribution.mu, forced.second.text.distribution.mu) > 1e-3);

  auto config = small::teach_config;
  config.z_prev_text = true;
  CHECK(distance(small::teach<B>(config).branches(pairs, noise()).second.text.z, out.second.text.z) > 1e-3);
  config = small::teach_config;
  config.mask_padding = true;
  const auto masked = small::teach<B>(config).branches(pairs, noise());
  const auto mu = [](const ml::TextMotionBranches<B>& b, Index i) {
    return ml::slice(b.motion->distribution.mu, 0, i, i + 1);
  };
  CHECK(distance(mu(masked.first, 0), mu(out.first, 0)) < 1e-13);  // the longest one has no padding
  CHECK(distance(mu(masked.first, 1), mu(out.first, 1)) > 1e-3);
  config.motion_encoder = false;
  CHECK_FALSE(small::teach<B>(config).branches(pairs, noise()).first.motion);
  CHECK_ERROR(small::teach<B>(config).encode_motion(pairs.first_motion), "[motionlang.config.101] Teach");

  const auto all = ml::teach_losses(out, pairs), action = ml::teach_losses(out, pairs, {.loss_on_transition = false});
  REQUIRE(all.terms.size() == 14);
  for (std::size_t i = 0; i < 14; ++i) {
    const auto& [name, weight, value] = all.terms[i];
    CHECK(name.ends_with(i < 7 ? "_0" : "_1"));
    CHECK(weight == (name.starts_with("recons") ? 1 : 1e-5));
    CHECK((action.terms[i].value.item() == value.item()) == !(name.starts_with("recons") && i >= 7));
  }
  // the last pair has 2 frames of transition and 4 of action
  const auto error = [&](Index pair, Index skipped) {
    const auto cut = [&](const ml::Sequences<B>& x) { return ml::slice(x[pair], 0, skipped, x.offsets.length(pair)); };
    const auto& motion = pairs.second_motion;
    return ml::smooth_l1(cut(motion), cut(motion.with(out.second.text.frames))).item();
  };
  CHECK(action.sum_of("recons_text2rfeats_1").item() == doctest::Approx((error(0, 1) + error(1, 0) + error(2, 2)) / 3));
  CHECK(all.sum_of("recons_text2rfeats_1").item() == doctest::Approx((error(0, 0) + error(1, 0) + error(2, 0)) / 3));
}

TEST_CASE("velocities: steps of the rotations, each sequence on its own") {
  const auto pairs = small::pairs<B>();
  const auto out = small::teach<B>().branches(pairs, noise());
  const auto losses = ml::teach_losses(out, pairs, {.velocity = 0.5});
  REQUIRE(losses.terms.size() == 18);
  CHECK(losses.terms[7].name == "velocity_text2rfeats_0");
  CHECK(losses.terms[8].name == "velocity_rfeats2rfeats_0");
  CHECK(losses.terms[8].weight == 0.5);
  double wanted = 0;
  for (Index i = 0; i < 3; ++i) {
    const auto steps = [&](const ml::Sequences<B>& x) {
      const auto rows = ml::slice(x[i], 1, 3, 135);
      return ml::slice(rows, 0, 1, rows.size(0)) - ml::slice(rows, 0, 0, rows.size(0) - 1);
    };
    wanted +=
        ml::smooth_l1(steps(pairs.first_motion), steps(pairs.first_motion.with(out.first.text.frames))).item() / 3;
  }
  CHECK(losses.terms[7].value.item() == doctest::Approx(wanted));
}

TEST_CASE("gradients pass through the decoded past; a few steps lower the loss") {
  const auto pairs = small::pairs<A>();
  const auto draw = [](std::uint64_t seed) { return ml::TeachNoise<A>::draw(3, 8, ml::Philox{.seed = seed}, 0.1); };
  auto model = ml::convert<A>(small::teach<B>());
  const auto reaches_first_text = [&](bool teacher_forcing) {
    const auto gradients =
        ml::backward(ml::sum(ml::square(model.branches(pairs, draw(1), {}, teacher_forcing).second.text.frames)));
    return gradients.find(pairs.first_text.rows.data()) != nullptr;
  };
  CHECK(reaches_first_text(false));
  CHECK_FALSE(reaches_first_text(true));

  ml::AdamW<A> adam({.lr = 1e-2});
  std::vector<double> losses;
  for (std::uint64_t k = 0; k < 6; ++k) {
    const auto out = model.branches(pairs, draw(k), {.dropout = ml::Philox{.seed = 9}.split(k)});
    const auto loss = ml::teach_losses(out, pairs).total();
    losses.push_back(loss.item());
    adam.step(model, ml::backward(loss));
  }
  CHECK(losses.back() < losses.front());
}

TEST_CASE("a sequence of actions: gaps, pasts, seeds, refusals") {
  const auto model = small::teach<B>();
  const auto texts = small::sequences<B>({2, 4, 1}, 5, 6);
  const Offsets lengths{5, 7, 6};
  const auto eps = normal<B, 2>({3, 8}, 7);
  const auto parts = model.generate(texts, lengths, eps, 3);
  CHECK(parts.offsets == lengths);
  const auto sample = [&](Index i, const Past& past) {
    return model.encode_text({texts[i], Offsets{texts.offsets.length(i)}}, past).sample(ml::slice(eps, 0, i, i + 1));
  };
  const auto first = model.decode(sample(0, {}), Offsets{5});
  CHECK(same_bits(parts[0], first.rows));
  const auto second = model.decode(sample(1, model.past_of(first, sample(0, {}))), Offsets{4});
  CHECK(same_bits(ml::slice(parts[1], 0, 3, 7), second.rows));
  CHECK(same_bits(ml::slice(parts[1], 0, 0, 3), ml::Tensor<B, 2>::zeros({3, 135})));
  CHECK(model.generate(texts, lengths, eps).rows.size(0) == 18);
  CHECK(distance(model.generate(texts, lengths, eps)[0], parts[0]) < 1e-13);

  const auto make = [&](std::uint64_t seed, const ml::LatentSampling& s = {}) {
    return ml::actions_to_motion(model, texts, lengths, ml::Philox{.seed = seed}, 3, s).rows;
  };
  CHECK(same_bits(make(1), make(1)));
  CHECK(distance(make(1), make(2)) > 1e-6);
  CHECK(same_bits(make(1, {.mean = true}), make(2, {.fact = 0})));
  CHECK_ERROR(model.generate(texts, Offsets{5, 4, 6}, eps, 3), "[motionlang.config.101] TEACH: action 1 has 4 frames");
  CHECK_ERROR(model.generate(texts, Offsets{5, 4}, eps), "[motionlang.shape.204] Teach: 3 texts, 2 lengths");
  CHECK_ERROR(model.generate(texts, Offsets{1, 4, 4}, eps), "[motionlang.shape.207] last_rows");

  const auto independent = ml::independent_actions(model, texts, lengths, eps, 3);
  CHECK(independent.offsets == lengths);
  CHECK(distance(independent[0], parts[0]) < 1e-13);
  CHECK(distance(ml::slice(independent[2], 0, 3, 6), model.decode(sample(2, {}), Offsets{3}).rows) < 1e-13);
  CHECK(same_bits(ml::slice(independent[2], 0, 0, 3), ml::Tensor<B, 2>::zeros({3, 135})));

  const auto motion = ml::teach_motion(ml::Normalizer<B>::identity(135), parts, 3);
  REQUIRE(motion.trans.size() == 18);
  CHECK(motion.trans[8].x == doctest::Approx(motion.trans[4].x));  // the second action begins where the first one ends
  CHECK(motion.trans[8].y == doctest::Approx(motion.trans[4].y));
  CHECK(motion.trans[6].z == doctest::Approx((motion.trans[4].z + motion.trans[8].z) / 2));
}
