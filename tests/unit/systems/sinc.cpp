// SINC: three ways to encode several texts, the published mask, losses, training steps, motions.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/vae/sinc_text_encoder.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_teach_sinc.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets, ml::SincMode;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;
using Texts = ml::SincTexts<B>;
using tensors::distance, tensors::normal, tensors::same_bits;
namespace small = small_teach_sinc;

namespace {

/// With row `row` of all tokens changed.
Texts changed(Texts texts, Index row) {
  auto numbers = texts.states.rows.to_vector();
  for (Index i = 0; i < 5; ++i) numbers[static_cast<std::size_t>(row * 5 + i)] += 1;
  texts.states.rows = ml::Tensor<B, 2>::from(numbers, texts.states.rows.shape());
  return texts;
}

}  // namespace

TEST_CASE("texts have the same latents alone and among others, without the published mask") {
  for (const SincMode mode : {SincMode::single, SincMode::separate_texts, SincMode::separate_latents}) {
    auto model = small::sinc<B>(mode);
    model.config.legacy_ste_mask = false;
    auto texts = small::texts<B>();
    if (mode == SincMode::single) texts.motion.clear();
    const auto all = model.encode_text(texts);
    const Offsets of_motion = texts.per_motion(),
                  rows = mode == SincMode::separate_latents ? of_motion : Offsets::equal(of_motion.count(), 1);
    CHECK(all.mu.size(0) == rows.rows());
    for (Index m = 0; m < of_motion.count(); ++m) {
      std::vector<Index> lengths;
      for (Index t = of_motion.begin(m); t < of_motion.end(m); ++t) lengths.push_back(texts.states.offsets.length(t));
      const Index first = texts.states.offsets.begin(of_motion.begin(m)),
                  last = texts.states.offsets.end(of_motion.end(m) - 1);
      const Texts own{{ml::slice(texts.states.rows, 0, first, last), Offsets(lengths)},
                      std::vector<Index>(lengths.size(), 0)};
      CHECK(distance(model.encode_text(own).mu, ml::slice(all.mu, 0, rows.begin(m), rows.end(m))) < 1e-13);
    }
  }
}

TEST_CASE("one sentence has no positions, latents of their own have") {
  const auto text = small::sequences<B>({3}, 5, 1);
  const std::vector<Index> order{2, 0, 1};
  const auto turned = text.with(ml::gather(text.rows, order));
  const auto moved = [&](SincMode mode) {
    const auto model = small::sinc<B>(mode);
    return distance(model.encode_text(text).mu, model.encode_text(turned).mu);
  };
  CHECK(moved(SincMode::single) < 1e-13);
  CHECK(moved(SincMode::separate_latents) > 1e-6);
}

TEST_CASE("the published mask hides the last token of a further text and shows the end of its padding") {
  const auto model = small::sinc<B>(SincMode::separate_texts);
  const auto texts = small::texts<B>();  // of 4, 2; 3; 1, 4 tokens
  const auto mu = model.encode_text(texts).mu;
  const auto moves = [&](const Texts& other, Index motion) {
    const auto row = [&](const ml::Tensor<B, 2>& x) { return ml::slice(x, 0, motion, motion + 1); };
    return distance(row(model.encode_text(other).mu), row(mu)) > 1e-9;
  };
  CHECK(moves(changed(texts, 4), 0));        // the first token of the second text
  CHECK_FALSE(moves(changed(texts, 5), 0));  // its last one
  CHECK(moves(changed(texts, 3), 0));        // the last one of a first text
  CHECK(moves(changed(texts, 13), 2));       // the last one of a text as long as the longest
  auto other_end = texts;
  other_end.end = *texts.end + 1.0;
  CHECK(moves(other_end, 0));
  CHECK_FALSE(moves(other_end, 1));
  CHECK_FALSE(moves(other_end, 2));

  auto natural = model;
  natural.config.legacy_ste_mask = false;
  const auto own = natural.encode_text(texts).mu;
  CHECK(distance(ml::slice(own, 0, 2, 3), ml::slice(mu, 0, 2, 3)) < 1e-13);
  CHECK(distance(ml::slice(own, 0, 1, 2), ml::slice(mu, 0, 1, 2)) > 1e-6);  // a row of zeros for the text it lacks
  auto without_end = texts;
  without_end.end.reset();
  CHECK_ERROR(model.encode_text(without_end), "[motionlang.config.101] SincTextEncoder: the published mask");
}

void check_published_mask(const std::vector<Index>& lengths) {
  const Index words = 4;
  const auto padded = normal<B, 3>({6, words, 5}, 30);
  const std::vector<Index> motion{0, 0, 0, 1, 2, 2};
  const Texts texts{ml::from_padded(padded, std::span<const Index>(lengths)), motion,
                    ml::last_row(ml::from_equal(padded)), words};
  const auto model = small::sinc<B>(SincMode::separate_texts);
  const auto& encoder = model.textencoder.text;
  const auto table = ml::concat(0, encoder.beginning(), encoder.separation(), ml::Tensor<B, 2>::zeros({1, 8}),
                                encoder.projected(ml::from_equal(padded)).rows);
  std::vector<Index> rows;
  std::vector<unsigned char> mask;
  for (Index m = 0, t = 0; m < 3; ++m) {
    rows.insert(rows.end(), {0, 1});
    mask.insert(mask.end(), {1, 1});
    for (int slot = 0; slot < 3; ++slot) {
      const bool there = t < 6 && motion[static_cast<std::size_t>(t)] == m;
      if (slot > 0) rows.push_back(2);
      for (Index i = 0; i < words; ++i) {
        rows.push_back(there ? 4 + t * words + i : 3);
        mask.push_back(there && i < lengths[static_cast<std::size_t>(t)]);
      }
      if (slot > 0) mask.push_back(1);  // meant for the separation token, which stands before the text
      t += there;
    }
  }
  const auto sequence = ml::reshape<3>(ml::gather(table, rows), {3, 2 + 3 * words + 2, 8});
  const auto seen = ml::from_padded(sequence, std::span<const unsigned char>(mask));
  CHECK(model.textencoder.joined(texts, true).offsets == seen.offsets);
  CHECK(distance(model.encode_text(texts).mu, encoder.encode(seen).mu) < 1e-13);
}
TEST_CASE("the published mask, as it lies over the padded batch: shifted by one behind the first text") {
  check_published_mask({3, 4, 1, 2, 4, 2});
  check_published_mask({3, 3, 1, 2, 3, 2});  // no text is as long as the padding
  check_published_mask({3, 3, 3, 3, 3, 3});
}

TEST_CASE("texts say in order of which motion they are") {
  const auto per_motion = [](std::vector<Index> motion) {
    return Texts{small::sequences<B>({1, 1, 1}, 5, 1), std::move(motion)}.per_motion();
  };
  CHECK(per_motion({}) == Offsets{1, 1, 1});
  CHECK(per_motion({0, 1, 1}) == Offsets{1, 2});
  CHECK_ERROR(per_motion({0, 0}), "[motionlang.shape.205] SincTexts: 2 numbers of motions for 3 texts");
  CHECK_ERROR(per_motion({0, 2, 2}), "[motionlang.shape.205] SincTexts: motion 2 behind 1 motions");
  CHECK_ERROR(per_motion({0, 1, 0}), "[motionlang.shape.205] SincTexts: motion 0 behind 2 motions");
  CHECK_ERROR(per_motion({1, 1, 1}), "[motionlang.shape.205] SincTexts: motion 1 behind 0 motions");
  CHECK_ERROR(small::sinc<B>().encode_text(small::texts<B>()), "[motionlang.shape.205] SincTextEncoder: 2 texts");
}

TEST_CASE("losses of separate latents: means over texts, then over motions; empty latents count as 0") {
  const auto model = small::sinc<B>(SincMode::separate_latents);
  const auto texts = small::texts<B>();
  const auto motion = small::sequences<B>({4, 2, 3}, 135, 2);
  const auto both = model.branches(texts, motion, {normal<B, 2>({5, 8}, 3), normal<B, 2>({3, 8}, 4)});
  const auto losses = model.losses(both, texts, motion);
  std::vector<std::string> names;
  for (const auto& term : losses.terms) names.push_back(term.name);
  CHECK(names == std::vector<std::string>{"recons_rfeats2rfeats", "recons_text2rfeats", "kl_text2motion_multi",
                                          "kl_motion2text_multi", "kl_text_multi", "kl_motion",
                                          "latent_manifold_multi"});
  CHECK(losses.terms[4].weight == 32e-5);
  const auto row = [](const ml::Tensor<B, 2>& x, Index i) { return ml::slice(x, 0, i, i + 1); };
  const std::vector<std::pair<Index, double>> motion_and_share{{0, 0.5}, {0, 0.5}, {1, 1}, {2, 0.5}, {2, 0.5}};
  double kl = 0, latent = 0;
  for (Index t = 0; t < 5; ++t) {
    const auto [m, share] = motion_and_share[static_cast<std::size_t>(t)];
    const auto &p = both.text.distribution, &q = both.motion->distribution;
    kl += share / 3 * ml::kl_divergence(row(p.mu, t), row(p.logvar, t), row(q.mu, m), row(q.logvar, m)).item();
    latent += ml::smooth_l1(row(both.text.z, t), row(both.motion->z, m)).item() / 6;
  }
  CHECK(losses.sum_of("kl_text2motion_multi").item() == doctest::Approx(kl));
  CHECK(losses.sum_of("latent_manifold_multi").item() == doctest::Approx(latent));
}

TEST_CASE("a few steps of training lower the loss in every mode; a token that no text needs is left alone") {
  for (const SincMode mode : {SincMode::single, SincMode::separate_texts, SincMode::separate_latents}) {
    auto model = ml::convert<A>(small::sinc<B>(mode));
    auto texts = small::texts<A>();
    if (mode == SincMode::single) texts.motion.clear();
    const Index motions = texts.per_motion().count(), latents = model.latents(texts).rows();
    const auto motion = small::sequences<A>(Offsets::equal(motions, 3), 135, 2);
    const auto before = model.textencoder.text.separation_token.to_vector();
    ml::AdamW<A> adam({.lr = 1e-2});
    std::vector<double> losses;
    for (std::uint64_t k = 0; k < 6; ++k) {
      const ml::TextMotionNoise<A> noise{normal<A, 2>({latents, 8}, 2 * k), normal<A, 2>({motions, 8}, 2 * k + 1), 0.1};
      const auto both = model.branches(texts, motion, noise, {.dropout = ml::Philox{.seed = 9}.split(k)});
      const auto loss = model.losses(both, texts, motion).total();
      losses.push_back(loss.item());
      adam.step(model, ml::backward(loss));
    }
    CHECK(losses.back() < losses.front());
    CHECK((model.textencoder.text.separation_token.to_vector() == before) == (mode != SincMode::separate_texts));
  }
}

TEST_CASE("motions of texts, and of two motions by body parts") {
  const auto model = small::sinc<B>(SincMode::separate_latents);
  const auto texts = small::texts<B>();
  const Offsets lengths{4, 2, 3};
  const auto motions = model.generate(texts, lengths, normal<B, 2>({5, 8}, 5));
  CHECK(motions.offsets == lengths);
  CHECK_FALSE(same_bits(motions.rows, model.generate(texts, lengths, normal<B, 2>({5, 8}, 6), 0).rows));
  CHECK(same_bits(model.generate(texts, lengths, normal<B, 2>({5, 8}, 5), 0).rows,
                  model.generate(texts, lengths, normal<B, 2>({5, 8}, 6), 0).rows));

  const auto single = small::sinc<B>();
  const auto two =
      ml::text_to_motion(single, small::sequences<B>({2, 3}, 5, 7), Offsets{4, 4}, ml::Philox{.seed = 8})[0];
  const ml::Normalizer<B> normalizer{normal<B, 1>({135}, 9), ml::Tensor<B, 1>::full({135}, 2), ml::sinc_eps};
  using enum ml::SincPart;
  const auto both = ml::sinc_composed(normalizer, two[0], ml::sinc_parts(global, left_leg, right_leg), two[1],
                                      ml::sinc_parts(right_arm));
  const auto walk = ml::sinc_motion(normalizer, two[0]), wave = ml::sinc_motion(normalizer, two[1]);
  CHECK(both.rotations[0].m == walk.rotations[0].m);
  CHECK(both.rotations[21].m == wave.rotations[21].m);  // the right wrist
  CHECK(both.trans[3] == walk.trans[3]);
}
