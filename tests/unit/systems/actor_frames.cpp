// ACTOR with a latent for every frame: training reads true frames, generation its own; its prior; what it refuses.
#include <map>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/vae/actor_frames.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_actor.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using small_actor::B, small_actor::model_of, small_actor::motions;
using A = ml::Autodiff<B>;
using tensors::distance, tensors::normal, tensors::same_bits;

namespace {

ml::ActorConfig config() {
  auto c = small_actor::small();
  c.encoder = ml::ActorEncoderKind::frames, c.decoder = ml::ActorDecoderKind::frames;
  return c;
}
const std::vector<Index> actions{1, 3};

}  // namespace

TEST_CASE("a frame depends on the frames and latents up to it, and on no other motion") {
  const auto model = model_of(config());
  const auto x = motions({4, 7});
  const auto latent = model.encode(x, actions);
  CHECK(latent.mu.shape() == ml::Shape{11, 16});
  const auto prior = model.prior(x, actions);
  REQUIRE(prior);
  CHECK(prior->mu.shape() == latent.mu.shape());
  const auto taught = model.teach(latent.mu, actions, x), written = model.decode(latent.mu, actions, x.offsets);
  CHECK(distance(taught[0], written[0]) > 1e-3);  // the true frames are not those that it writes
  for (Index s : {0, 1}) {
    const ml::Sequences<B> one(x[s], Offsets{x.offsets.length(s)});
    const std::vector<Index> action{actions[static_cast<std::size_t>(s)]};
    const auto rows = ml::slice(latent.mu, 0, x.offsets.begin(s), x.offsets.end(s));
    CHECK(distance(model.encode(one, action).mu, rows) < 1e-5);
    CHECK(distance(model.decode(rows, action, one.offsets).rows, written[s]) < 1e-5);
    CHECK(distance(model.teach(rows, action, one).rows, taught[s]) < 1e-5);
  }
  // the last frame of the first motion changes nothing before itself, and never the prior
  auto values = x.rows.to_vector();
  for (int i = 0; i < 18; ++i) values[static_cast<std::size_t>(3 * 18 + i)] += 1;
  const ml::Sequences<B> changed(ml::Tensor<B, 2>::from(values, x.rows.shape()), x.offsets);
  const auto other = model.encode(changed, actions).mu;
  CHECK(same_bits(ml::slice(other, 0, 0, 3), ml::slice(latent.mu, 0, 0, 3)));
  CHECK(distance(ml::slice(other, 0, 3, 4), ml::slice(latent.mu, 0, 3, 4)) > 1e-4);
  CHECK(same_bits(model.prior(changed, actions)->mu, prior->mu));
}

TEST_CASE("what was generated is what the taught network writes from it, with latents of the prior") {
  const auto model = model_of(config());
  const Offsets lengths{4, 7};
  const auto eps = normal<B, 2>({11, 16}, 3);
  const auto made = model.frames->generate(eps, actions, lengths);
  const auto z = model.prior(made, actions)->sample(eps);
  CHECK(distance(model.teach(z, actions, made).rows, made.rows) < 1e-5);
  CHECK(distance(model.decode(z, actions, lengths).rows, made.rows) < 1e-5);
}

TEST_CASE("generate draws noise for every frame; fact scales it") {
  const auto model = model_of(config());
  const std::vector<Index> durations{4, 9};
  const auto made = [&](double fact) {
    ml::Philox rng{.seed = 7};
    return ml::generate(model, actions, durations, rng, {.samples = 2, .fact = fact});
  };
  const auto motions = made(1), still = made(0);
  CHECK(motions.offsets == Offsets{4, 9, 4, 9});
  CHECK(distance(motions[0], motions[2]) > 1e-3);
  CHECK(same_bits(made(1).rows, motions.rows));
  CHECK(distance(still[0], still[2]) < 1e-6);  // the mean motion
  const std::vector<Index> labels{1, 3, 1, 3};
  CHECK(ml::denoise(model, motions, labels).offsets == motions.offsets);
}

TEST_CASE("every value of the network gets a gradient; training lowers the loss and the divergence from the prior") {
  auto model = ml::convert<A>(model_of(config()));
  const auto bare = motions({4, 7});
  const ml::Sequences<A> x(ml::Tensor<A, 2>::from(bare.rows.to_vector(), bare.rows.shape()), bare.offsets);
  const auto eps = normal<B, 2>({11, 16}, 3);
  ml::AdamW<A> adam({.lr = 0.01});
  std::map<std::string, double> first, last;
  for (int step = 0; step < 30; ++step) {
    const auto latent = model.encode(x, actions);
    const auto z = latent.sample(ml::Tensor<A, 2>::from(eps.to_vector(), {11, 16}));
    const auto losses = ml::actor_losses<A>(latent, x, model.teach(z, actions, x), {.rcxyz = 0, .kl = 1e-3}, {},
                                            model.prior(x, actions));
    for (const auto& term : losses.terms) last[term.name] = static_cast<double>(term.value.item());
    const auto gradients = ml::backward(losses.total());
    if (step == 0) {
      first = last;
      ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
        CHECK_MESSAGE(gradients.find(t.data()) != nullptr, path);
      });
    }
    adam.step(model, gradients);
  }
  CHECK(last["rc"] < 0.7 * first["rc"]);
  CHECK(last["kl"] < first["kl"]);
}

TEST_CASE("the divergence from a prior, by hand") {
  const auto row = [](float mu, float logvar) {
    return ml::LatentGaussian<B>{ml::Tensor<B, 2>::from({mu}, {1, 1}), ml::Tensor<B, 2>::from({logvar}, {1, 1})};
  };
  const ml::Sequences<B> x(ml::Tensor<B, 2>::zeros({1, 1}), Offsets{1});
  const auto loss = ml::actor_losses<B>(row(1, 0), x, x, {.rc = 0, .rcxyz = 0, .kl = 2}, {},
                                        row(3, static_cast<float>(std::log(4.0))));
  // KL(N(1, 1) || N(3, 4)) = log 2 + (1 + 4) / 8 - 1 / 2
  CHECK(loss.total().item() == doctest::Approx(2 * (std::log(2.0) + 5.0 / 8 - 0.5)));
}

TEST_CASE("what a model of frames cannot do is refused") {
  auto half = config();
  half.encoder = ml::ActorEncoderKind::gru;
  CHECK_ERROR(model_of(half),
              "[motionlang.config.102] Actor: encoder gru, decoder frames: frames is both of them, or none");
  const auto model = model_of(config());
  const std::vector<Index> unknown{1, 4}, durations{4, 4};
  CHECK_ERROR(model.encode(motions({4, 7}), unknown), "[motionlang.shape.203]");
  CHECK_ERROR(model.decode(ml::Tensor<B, 2>::zeros({2, 16}), actions, Offsets{4, 7}),
              "[motionlang.shape.204] ActorFrames: latents (2, 16) for 11 frames");
  CHECK_ERROR(ml::interpolate_motions(model, motions({4, 4}), 3, 5, 4), "[motionlang.config.102] interpolate_motions");
  ml::Philox rng{.seed = 7};
  CHECK_ERROR(ml::interpolate_actions(model, 3, 1, 5, 6, rng), "[motionlang.config.102]");
  CHECK_ERROR(ml::generate(model, actions, durations, rng, {.samples = 2, .across_samples = ml::NoiseSharing::same}),
              "[motionlang.config.102] generate: shared noise");
  CHECK_ERROR(ml::generate(model, actions, durations, rng, {.samples = 0}),
              "[motionlang.config.101] generate: 0 samples");
}
