// TEMOS and TMR: packing, seeds, dropout, branches and losses of all ablations, motions from texts, similarities.
#include <set>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/tensor/normalize.hpp>
#include <motionlang/vae/text_motion.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_text_motion.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::normal, tensors::same_bits;
namespace small = small_text_motion;

namespace {

std::vector<std::string> names(const ml::LossTerms<B>& losses) {
  std::vector<std::string> out;
  for (const auto& term : losses.terms) out.push_back(term.name);
  return out;
}
ml::TextMotionNoise<B> noise(std::uint64_t seed = 5) {
  return ml::TextMotionNoise<B>::draw(3, 8, ml::Philox{.seed = seed});
}

std::vector<std::string> temos_terms(const ml::TemosConfig& c, const ml::TemosLossOptions& options = {}) {
  const auto motion = small::motions<B>(64);
  return names(ml::temos_losses(small::temos<B>(c).branches(small::texts<B>(), motion, noise()), motion, options));
}

template <class Model>
void check_packing(const Model& model, Index motion_width) {
  const auto text = small::texts<B>(), motion = small::motions<B>(motion_width);
  const auto t = model.encode_text(text), m = model.encode_motion(motion);
  const auto z = normal<B, 2>({3, 8}, 6);
  const auto frames = model.decode(z, motion.offsets);
  for (Index i = 0; i < 3; ++i) {
    const auto alone = [&](const ml::Sequences<B>& x) { return ml::Sequences<B>(x[i], Offsets{x.offsets.length(i)}); };
    const auto row = [&](const Matrix& x) { return ml::slice(x, 0, i, i + 1); };
    CHECK(distance(model.encode_text(alone(text)).mu, row(t.mu)) < 1e-13);
    CHECK(distance(model.encode_text(alone(text)).logvar, row(t.logvar)) < 1e-13);
    CHECK(distance(model.encode_motion(alone(motion)).mu, row(m.mu)) < 1e-13);
    CHECK(distance(model.decode(row(z), Offsets{motion.offsets.length(i)}).rows, frames[i]) < 1e-13);
  }
}

}  // namespace

TEST_CASE("the text encoder may have layers and heads of its own") {
  const auto layers_of = [](auto& network) {
    std::set<std::string> out;
    for (const auto& t : ml::tensors_of(network)) {
      const auto at = t.path.find("layers.");
      if (at != t.path.npos) out.insert(t.path.substr(at + 7, 1));
    }
    return out;
  };
  ml::Philox rng{.seed = 1};
  const ml::TemosConfig config{
      .nfeats = 5, .text_dim = 6, .latent_dim = 8, .ff_size = 8, .num_layers = 2, .num_heads = 2, .text_layers = 1};
  ml::Temos<B> temos(config, rng);
  CHECK(layers_of(temos.textencoder) == std::set<std::string>{"0"});
  CHECK(layers_of(*temos.motionencoder) == std::set<std::string>{"0", "1"});
  ml::Tmr<B> tmr(ml::TmrConfig{.motion_nfeats = 5,
                               .text_nfeats = 6,
                               .latent_dim = 8,
                               .ff_size = 8,
                               .num_layers = 1,
                               .num_heads = 2,
                               .text_layers = 3},
                 rng);
  CHECK(layers_of(tmr.text_encoder) == std::set<std::string>{"0", "1", "2"});
  CHECK(layers_of(tmr.motion_encoder) == std::set<std::string>{"0"});
}

TEST_CASE("a text and a motion have the same latents alone and among others") {
  check_packing(small::temos<B>(), 64);
  check_packing(small::tmr<B>(), 263);
  auto recurrent = small::temos_config;
  recurrent.motion_encoder = recurrent.motion_decoder = ml::TemosNetwork::gru;
  check_packing(small::temos<B>(recurrent), 64);
}

TEST_CASE("the same seed gives the same model, noise and dropout; another one another") {
  const auto text = small::texts<B>();
  const auto mu = [&](std::uint64_t seed) { return small::tmr<B>(small::tmr_config, seed).encode_text(text).mu; };
  CHECK(same_bits(mu(1), mu(1)));
  CHECK_FALSE(same_bits(mu(1), mu(2)));
  CHECK(same_bits(noise(1).text, noise(1).text));
  CHECK_FALSE(same_bits(noise(1).text, noise(1).motion));
  const auto model = small::temos<B>();
  const auto dropped = [&](std::uint64_t seed) {
    return model.encode_text(text, {.dropout = ml::Philox{.seed = seed}}).mu;
  };
  CHECK(same_bits(dropped(1), dropped(1)));
  CHECK_FALSE(same_bits(dropped(1), dropped(2)));
  CHECK_FALSE(same_bits(dropped(1), model.encode_text(text).mu));
}

TEST_CASE("the terms of TEMOS' loss, and of its ablations") {
  using List = std::vector<std::string>;
  const auto& c = small::temos_config;
  CHECK(temos_terms(c) == List{"recons_jfeats2jfeats", "recons_text2jfeats", "kl_text2motion", "kl_motion2text",
                               "kl_text", "kl_motion", "latent_manifold"});
  CHECK(temos_terms(c, {.cross_modal_kl = false, .embedding = false, .feats = "rfeats"}) ==
        List{"recons_rfeats2rfeats", "recons_text2rfeats", "kl_text", "kl_motion"});
  CHECK(temos_terms(c, {.gaussian_kl = false}) ==
        List{"recons_jfeats2jfeats", "recons_text2jfeats", "kl_text2motion", "kl_motion2text", "latent_manifold"});
  auto alone = c;
  alone.motion_encoder = ml::TemosNetwork::none;
  CHECK(temos_terms(alone) == List{"recons_text2jfeats", "kl_text"});
  auto deterministic = c;
  deterministic.vae = false;
  CHECK(temos_terms(deterministic, {.embedding = false}) ==
        List{"recons_jfeats2jfeats", "recons_text2jfeats", "latent_manifold"});
  CHECK_ERROR(small::temos<B>(alone).encode_motion(small::motions<B>(64)), "[motionlang.config.101] Temos");
  auto mute = c;
  mute.motion_decoder = ml::TemosNetwork::none;
  CHECK_ERROR(small::temos<B>(mute), "[motionlang.config.101] Temos: a model needs a motion decoder");
}

TEST_CASE("the terms of TMR's loss are TEMOS' in groups, and a contrastive one") {
  const auto model = small::tmr<B>();
  const auto text = small::texts<B>(), motion = small::motions<B>(263);
  const auto both = model.branches(text, motion, noise());
  const auto sentences = ml::normalize_rows(normal<B, 2>({3, 4}, 7));
  const auto terms = ml::tmr_losses(both, motion, &sentences);
  CHECK(names(terms) == std::vector<std::string>{"recons", "kl", "latent", "contrastive"});
  const auto parts = ml::temos_losses(both, motion);
  CHECK(terms.sum_of("kl").item() == parts.sum_of("kl_").item());
  CHECK(terms.sum_of("contrastive").item() ==
        ml::info_nce(both.text.z, both.motion->z, 0.1, ml::false_negatives(sentences, 0.8)).item());
  CHECK(terms.total().item() == doctest::Approx(parts.sum_of("recons").item() +
                                                1e-5 * (parts.sum_of("kl").item() + parts.sum_of("latent").item()) +
                                                0.1 * terms.sum_of("contrastive").item()));

  auto deterministic = small::tmr_config;
  deterministic.vae = false;
  const auto retrieval = small::tmr<B>(deterministic).branches(text, motion, noise(), {}, false);
  const auto margin = ml::tmr_losses<B>(retrieval, motion, nullptr, {.contrastive_loss = ml::ContrastiveLoss::margin});
  CHECK(names(margin) == std::vector<std::string>{"latent", "contrastive"});
  CHECK(margin.terms[1].value.item() == ml::margin_loss(retrieval.text.z, retrieval.motion->z).item());
  CHECK(names(ml::tmr_losses<B>(both, motion, nullptr, {.contrastive_loss = ml::ContrastiveLoss::none})).size() == 3);
  auto alone = both;
  alone.motion.reset();
  CHECK_THROWS_WITH_AS(ml::tmr_losses<B>(alone, motion), doctest::Contains("101"), ml::config_error);
}

TEST_CASE("a learned temperature takes the place of the other, and has a gradient") {
  const auto model = small::tmr<B>();
  const auto motion = small::motions<B>(263);
  const auto both = model.branches(small::texts<B>(), motion, noise());
  const auto loss = [&](double log_temperature) {
    const auto tau = exp(ml::Tensor<B, 0>(log_temperature));
    return ml::tmr_losses<B>(both, motion, nullptr, {.temperature = 7}, &tau).sum_of("contrastive").item();
  };
  CHECK(loss(std::log(0.1)) == doctest::Approx(ml::tmr_losses<B>(both, motion).sum_of("contrastive").item()));
  const auto on_tape = ml::convert<A>(model);
  const auto frames = small::motions<A>(263);
  const auto log_temperature = ml::variable<A>(ml::Tensor<B, 0>(-1.5));
  const auto tau = exp(log_temperature);
  const auto branches =
      on_tape.branches(small::texts<A>(), frames, ml::TextMotionNoise<A>::draw(3, 8, ml::Philox{.seed = 5}));
  const auto g =
      ml::backward(ml::tmr_losses<A>(branches, frames, nullptr, {}, &tau).sum_of("contrastive"))[log_temperature];
  constexpr double h = 1e-5;
  CHECK(g.item() == doctest::Approx((loss(-1.5 + h) - loss(-1.5 - h)) / (2 * h)).epsilon(1e-6));
}

TEST_CASE("a few steps of training lower the loss; the same seeds give the same weights") {
  const auto run = [] {
    auto model = ml::convert<A>(small::tmr<B>());
    ml::AdamW<A> adam({.lr = 1e-2});
    const auto text = small::texts<A>(), motion = small::motions<A>(263);
    std::vector<double> losses;
    for (std::uint64_t k = 0; k < 8; ++k) {
      const ml::Philox rng = ml::Philox{.seed = 9}.split(k);
      const auto both = model.branches(text, motion, ml::TextMotionNoise<A>::draw(3, 8, rng, 0.1), {.dropout = rng});
      const auto loss = ml::tmr_losses<A>(both, motion).total();
      losses.push_back(loss.item());
      adam.step(model, ml::backward(loss));
    }
    return std::pair{losses, ml::to_inner(model)};
  };
  const auto [losses, model] = run();
  CHECK(losses.back() < losses.front());
  const auto [again, same] = run();
  CHECK(losses == again);
  CHECK(same_bits(model.encode_text(small::texts<B>()).mu, same.encode_text(small::texts<B>()).mu));
}

TEST_CASE("motions from texts: samples, seeds, no noise, alone and among others") {
  const auto model = small::temos<B>();
  const auto text = small::texts<B>();
  const Offsets lengths{4, 2, 3};
  const auto make = [&](std::uint64_t seed, Index samples, const ml::LatentSampling& s = {}) {
    return ml::text_to_motion(model, text, lengths, ml::Philox{.seed = seed}, samples, s);
  };
  const auto two = make(1, 2);
  REQUIRE(two.size() == 2);
  CHECK(two[0].offsets == lengths);
  CHECK(same_bits(two[0].rows, make(1, 1)[0].rows));
  CHECK_FALSE(same_bits(two[0].rows, two[1].rows));
  CHECK_FALSE(same_bits(two[0].rows, make(2, 1)[0].rows));
  const ml::Sequences<B> last(text[2], Offsets{1});
  CHECK(distance(ml::text_to_motion(model, last, Offsets{3}, ml::Philox{.seed = 1})[0].rows, two[0][2]) < 1e-13);
  const auto mean = make(1, 1, {.mean = true})[0].rows;
  CHECK(same_bits(mean, make(2, 1, {.mean = true})[0].rows));
  CHECK(distance(mean, make(1, 1, {.fact = 0})[0].rows) < 1e-13);
  CHECK(distance(mean, model.decode(model.encode_text(text).mu, lengths).rows) == 0);
}

TEST_CASE("between two texts: the ends are their means, the middle is the middle") {
  const auto model = small::tmr<B>();
  const ml::Sequences<B> two(ml::slice(small::texts<B>().rows, 0, 0, 6), Offsets{2, 4});
  const auto mu = model.encode_text(two).mu;
  const auto path = ml::interpolate_texts(model, two, 3, 5);
  CHECK(path.offsets == Offsets{5, 5, 5});
  const auto ends = model.decode(mu, Offsets{5, 5});
  CHECK(distance(path[0], ends[0]) < 1e-13);
  CHECK(distance(path[2], ends[1]) < 1e-13);
  const auto middle = (ml::slice(mu, 0, 0, 1) + ml::slice(mu, 0, 1, 2)) * 0.5;
  CHECK(distance(path[1], model.decode(middle, Offsets{5})[0]) < 1e-13);
  CHECK_ERROR(ml::interpolate_texts(model, two, 1, 5), "[motionlang.config.101] interpolate_rows: 1 rows");

  const ml::Philox rng{.seed = 3};
  const auto drawn = ml::interpolate_texts(model, two, 3, 5, rng);
  const auto alone = ml::text_to_motion(model, two, Offsets{5, 5}, rng).front();
  CHECK(distance(drawn[0], alone[0]) < 1e-13);
  CHECK(distance(drawn[2], alone[1]) < 1e-13);
  CHECK(distance(drawn[1], path[1]) > 1e-4);  // there is noise in it
}

TEST_CASE("the width says whether it is a text or a motion") {
  const auto model = small::tmr<B>();
  CHECK(same_bits(model.encode(small::texts<B>()).mu, model.encode_text(small::texts<B>()).mu));
  CHECK(same_bits(model.encode(small::motions<B>(263)).mu, model.encode_motion(small::motions<B>(263)).mu));
  CHECK_ERROR(model.encode(small::texts<B>(6)), "[motionlang.shape.204] Tmr: features (7, 6)");
  auto equal = small::tmr_config;
  equal.motion_nfeats = 5;
  CHECK_ERROR(small::tmr<B>(equal).encode(small::texts<B>()), "[motionlang.config.101] Tmr");
}

TEST_CASE("equal rows have equal similarities, bit by bit, wherever they stand") {
  using F = ml::EigenBackend<float>;
  for (Index n : {2, 7, 33, 130}) {
    const auto one = normal<F, 2>({1, 37}, 11), others = normal<F, 2>({n, 37}, 12);
    const auto y = ml::concat(0, one, others, one, others, one);
    const auto s = ml::cosine_similarity(others, y);
    const auto back = ml::cosine_similarity(y, others);
    for (Index i = 0; i < n; ++i) {
      const auto at = [&](Index j) { return s.span()[static_cast<std::size_t>(i * s.size(1) + j)]; };
      CHECK(at(0) == at(n + 1));
      CHECK(at(0) == at(2 * n + 2));
      CHECK(at(1) == at(n + 2));
      CHECK(at(5 % n + 1) == back.span()[static_cast<std::size_t>((5 % n + 1) * n + i)]);
    }
  }
  const auto zero = ml::cosine_similarity(Matrix::zeros({1, 3}), normal<B, 2>({2, 3}, 13));
  CHECK(zero.to_vector() == std::vector<double>{0, 0});
  CHECK(ml::tmr_score(zero).to_vector() == std::vector<double>{0.5, 0.5});
}

TEST_CASE("joints and poses of decoded features") {
  const ml::Normalizer<B> n{normal<B, 1>({64}, 14), ml::Tensor<B, 1>::full({64}, 2)};
  const auto x = normal<B, 2>({3, 64}, 15);
  const auto joints = ml::temos_joints(n, x);
  CHECK(joints.size() == 3 * 21);
  CHECK(joints[0].y == doctest::Approx(x.span()[0] * 2 + n.mean.span()[0]));  // the height of the root
  const auto tmr = ml::tmr_joints(ml::Normalizer<B>::identity(263), normal<B, 2>({4, 263}, 16));
  CHECK(tmr.size() == 4 * 22);
  CHECK(tmr[0].z == doctest::Approx(normal<B, 2>({4, 263}, 16).at(0, 3)));  // Z is up
  CHECK(ml::temos_smpl(ml::Normalizer<B>::identity(135), normal<B, 2>({2, 135}, 17)).rotations.size() == 2 * 22);
}
