// ACTOR: published names and sizes, every network of table 3.4, motions in a batch as if each were alone, losses, noise
// of generated motions, training.
#include <map>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/nn/feed_forward.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/vae/actor_decoder.hpp>
#include <motionlang/vae/actor_encoder.hpp>
#include <motionlang/vae/actor_fully_connected.hpp>
#include <motionlang/vae/actor_gru.hpp>
#include <motionlang/vae/actor_latents.hpp>
#include <motionlang/vae/actor_losses.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_actor.hpp"

namespace ml = motionlang;
using ml::ActorConditioning, ml::ActorConfig, ml::ActorDecoderKind, ml::ActorEncoderKind, ml::ActorSampling;
using ml::Index, ml::NoiseSharing, ml::Offsets;
using small_actor::B, small_actor::model_of, small_actor::motions, small_actor::small, small_actor::variants;
using A = ml::Autodiff<B>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::normal, tensors::same_bits;

TEST_CASE("ACTOR: names and sizes of the published model of HumanAct12") {
  ml::NoInit zeros;
  const ml::Actor<B> model({}, zeros);
  CHECK(ml::parameter_count(model) == 14832022);
  CHECK(ml::parameter_count(*model.encoder) == 6362880);
  CHECK(ml::parameter_count(*model.decoder) == 8469142);
  std::map<std::string, ml::Shape> shapes;
  int encoder = 0, decoder = 0;
  ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
    shapes.emplace(path, t.shape());
    encoder += path.starts_with("encoder.") ? 1 : 0;
    decoder += path.starts_with("decoder.") ? 1 : 0;
  });
  CHECK(encoder == 100);  // and the table of positions, which is not read
  CHECK(decoder == 147);
  CHECK(shapes.at("encoder.muQuery") == ml::Shape{12, 256});
  CHECK(shapes.at("encoder.sigmaQuery") == ml::Shape{12, 256});
  CHECK(shapes.at("encoder.skelEmbedding.weight") == ml::Shape{256, 150});
  CHECK(shapes.at("encoder.seqTransEncoder.layers.7.self_attn.in_proj_weight") == ml::Shape{768, 256});
  CHECK(shapes.at("encoder.seqTransEncoder.layers.0.linear1.weight") == ml::Shape{1024, 256});
  CHECK(shapes.at("decoder.actionBiases") == ml::Shape{12, 256});
  CHECK(shapes.at("decoder.seqTransDecoder.layers.7.multihead_attn.out_proj.bias") == ml::Shape{256});
  CHECK(shapes.at("decoder.seqTransDecoder.layers.3.norm3.weight") == ml::Shape{256});
  CHECK(shapes.at("decoder.finallayer.weight") == ml::Shape{150, 256});
}

TEST_CASE("ACTOR: names of the networks that it is compared with") {
  auto has = [](ActorConfig config, std::initializer_list<const char*> names) {
    std::vector<std::string> found;
    const auto model = model_of(config);
    ml::visit_tensors(model,
                      [&](const std::string& path, const auto&) { found.push_back(ml::Actor<B>::official_key(path)); });
    for (const char* name : names) CHECK_MESSAGE(std::count(found.begin(), found.end(), name) == 1, name);
  };
  auto config = small();
  config.encoder = ActorEncoderKind::average, config.conditioning = ActorConditioning::zandtime;
  has(config, {"encoder.mu_layer.weight", "encoder.sigma_layer.bias", "decoder.ztimelinear.weight"});
  config.encoder = ActorEncoderKind::gru, config.decoder = ActorDecoderKind::gru;
  has(config, {"encoder.feats_embedding.weight", "encoder.gru.weight_ih_l1", "encoder.mu.bias", "encoder.var.bias",
               "decoder.gru.bias_hh_l0", "decoder.final_layer.weight"});
  config.encoder = ActorEncoderKind::fully_connected, config.decoder = ActorDecoderKind::fully_connected;
  has(config,
      {"encoder.fully_connected.0.weight", "encoder.fully_connected.2.bias", "decoder.fully_connected.4.weight"});
  config.decoder = ActorDecoderKind::autoregressive;
  has(config, {"decoder.embedding.weight", "decoder.embedding_x.bias", "decoder.layers.1.trg_trg_att.k_layer.weight",
               "decoder.layers.0.feed_forward.layer_norm.weight", "decoder.layers.0.feed_forward.pwff_layer.3.bias",
               "decoder.layers.0.x_layer_norm.bias", "decoder.layers.0.dec_layer_norm.bias",
               "decoder.layer_norm.weight", "decoder.output_layer.weight"});
}

TEST_CASE("ACTOR: layers of a stack begin with the same numbers") {
  const auto model = model_of(small());
  const auto& layers = model.encoder->seqTransEncoder.layers;
  CHECK(same_bits(layers[0].linear1.weight, layers[1].linear1.weight));
  CHECK_FALSE(same_bits(layers[0].linear1.weight, model.decoder->seqTransDecoder.layers[0].linear1.weight));
}

TEST_CASE("ACTOR: a motion in a batch is encoded and decoded as if it were alone") {
  const std::vector<Index> actions{1, 3};
  for (const ActorConfig& config : variants()) {
    const bool fixed = config.decoder == ActorDecoderKind::fully_connected;
    const auto model = model_of(config);
    const auto x = fixed ? motions({5, 5}) : motions({4, 7});
    const auto latent = model.encode(x, actions);
    CHECK(latent.mu.shape() == ml::Shape{2, 16});
    const auto together = model.decode(latent.mu, actions, x.offsets);
    CHECK(together.width() == 18);
    for (Index s : {0, 1}) {
      const ml::Sequences<B> one(x[s], Offsets{x.offsets.length(s)});
      const std::vector<Index> action{actions[static_cast<std::size_t>(s)]};
      const auto alone = model.encode(one, action);
      // The mean of average_encoder counts padding: there the shorter one is another.
      const bool padded = config.encoder == ActorEncoderKind::average && s == 0;
      CHECK((distance(alone.mu, ml::slice(latent.mu, 0, s, s + 1)) < 1e-5) != padded);
      const auto beside_a_longer = model.encode(one, action, {}, x.offsets.longest());
      CHECK(distance(beside_a_longer.mu, ml::slice(latent.mu, 0, s, s + 1)) < 1e-5);
      CHECK(distance(model.decode(ml::slice(latent.mu, 0, s, s + 1), action, one.offsets).rows, together[s]) < 1e-5);
    }
  }
}

TEST_CASE("ACTOR: every number of every network gets a gradient, and training lowers the loss") {
  const std::vector<Index> actions{0, 2};
  for (const ActorConfig& config : variants()) {
    CAPTURE(static_cast<int>(config.encoder));
    CAPTURE(static_cast<int>(config.decoder));
    auto model = ml::convert<A>(model_of(config));
    const auto bare = config.decoder == ActorDecoderKind::fully_connected ? motions({5, 5}) : motions({4, 7});
    const ml::Sequences<A> x(ml::Tensor<A, 2>::from(bare.rows.to_vector(), bare.rows.shape()), bare.offsets);
    const auto eps = normal<B, 2>({2, 16}, 3);
    const ml::ActorLossWeights weights{.rcxyz = 0, .kl = 1e-3};
    ml::AdamW<A> adam({.lr = 0.01});
    double first = 0, last = 0;
    for (int step = 0; step < 12; ++step) {
      const auto latent = model.encode(x, actions);
      const auto z = latent.sample(ml::Tensor<A, 2>::from(eps.to_vector(), {2, 16}));
      const auto loss = ml::actor_losses(latent, x, model.teach(z, actions, x), weights).total();
      last = static_cast<double>(loss.item());
      const auto gradients = ml::backward(loss);
      if (step == 0) {
        first = last;
        ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
          CHECK_MESSAGE(gradients.find(t.data()) != nullptr, path);
        });
      }
      adam.step(model, gradients);
    }
    CHECK(last < 0.9 * first);
  }
}

TEST_CASE("ACTOR: an autoregressive decoder that is taught its own frames writes them") {
  auto config = small();
  config.decoder = ActorDecoderKind::autoregressive;
  const auto model = model_of(config);
  const std::vector<Index> actions{1, 3};
  const auto z = normal<B, 2>({2, 16}, 4);
  const auto written = model.decode(z, actions, Offsets{3, 6});
  CHECK(distance(model.teach(z, actions, written).rows, written.rows) < 1e-5);
}

TEST_CASE("ACTOR: dropout runs with a context only") {
  const std::vector<Index> actions{1, 3};
  for (const ActorConfig& config : variants()) {
    if (config.encoder == ActorEncoderKind::gru || config.encoder == ActorEncoderKind::fully_connected) continue;
    const auto model = model_of(config);
    const auto x = motions({4, 7});
    const ml::Context context{.dropout = ml::Philox{.seed = 5}};
    CHECK(same_bits(model.encode(x, actions).mu, model.encode(x, actions).mu));
    CHECK(distance(model.encode(x, actions, context).mu, model.encode(x, actions).mu) > 1e-3);
  }
}

TEST_CASE("ACTOR: its loss, by hand") {
  const Offsets offsets{2, 1};
  auto column = [&](const std::vector<float>& v) { return ml::Sequences<B>(Matrix::from(v, {3, 1}), offsets); };
  const ml::LatentGaussian<B> latent{Matrix::from({1, 2}, {2, 1}), Matrix::zeros({2, 1})};
  const auto x = column({0, 1, 5}), written = column({1, 4, 3});
  const ml::ActorLossPoints<B> points{column({0, 0, 0}), column({0, 2, 1})};
  const auto loss = ml::actor_losses<B>(latent, x, written, {.rc = 2, .kl = 3, .vel = 1, .velxyz = 1}, points);
  std::map<std::string, double> value;
  for (const auto& term : loss.terms) value[term.name] = static_cast<double>(term.value.item());
  CHECK(value["rc"] == doctest::Approx((1 + 9 + 4) / 3.0));
  CHECK(value["rcxyz"] == doctest::Approx((4 + 1) / 3.0));
  CHECK(value["kl"] == doctest::Approx((1 + 4) / 2.0));  // summed, not averaged
  CHECK(value["vel"] == doctest::Approx(4));             // steps 1 and 3; none in the second motion
  CHECK(value["velxyz"] == doctest::Approx(4));
  CHECK(loss.total().item() == doctest::Approx(2 * 14 / 3.0 + 5 / 3.0 + 7.5 + 8));
  CHECK(ml::actor_losses<B>(latent, x, written, {.rcxyz = 0}).terms.size() == 2);
  CHECK_ERROR(ml::actor_losses<B>(latent, x, written), "[motionlang.config.102]");
}

TEST_CASE("ACTOR: which latents share their noise") {
  const Index actions = 2, samples = 3;
  auto latents = [&](NoiseSharing across_samples, NoiseSharing across_actions, double fact = 1) {
    const ActorSampling o{samples, across_samples, across_actions, fact};
    return ml::actor_latents<B>(normal<B, 2>({o.noise_rows(actions), 4}, 6), actions, o);
  };
  auto row = [](const Matrix& z, Index i) { return ml::slice(z, 0, i, i + 1); };
  const auto random = NoiseSharing::random, same = NoiseSharing::same, between = NoiseSharing::interpolate;
  const auto all = latents(random, random), per_sample = latents(random, same), per_action = latents(same, random),
             one = latents(same, same), line = latents(between, random);
  for (Index i = 1; i < 6; ++i) CHECK_FALSE(same_bits(row(all, i), row(all, 0)));
  CHECK(same_bits(row(per_sample, 0), row(per_sample, 1)));  // sample 0 of both actions
  CHECK_FALSE(same_bits(row(per_sample, 0), row(per_sample, 2)));
  CHECK(same_bits(row(per_action, 1), row(per_action, 5)));
  CHECK_FALSE(same_bits(row(per_action, 0), row(per_action, 1)));
  for (Index i = 1; i < 6; ++i) CHECK(same_bits(row(one, i), row(one, 0)));
  CHECK(distance(row(line, 0), -row(line, 4)) == 0);
  CHECK(row(line, 3).to_vector() == std::vector<float>(4));
  CHECK(distance(latents(random, random, 0.5), all * 0.5) == 0);
  CHECK_ERROR(latents(random, between), "[motionlang.config.101]");
  CHECK_ERROR(ml::actor_latents<B>(Matrix::zeros({5, 4}), actions, {.samples = samples}), "[motionlang.shape.204]");
}

TEST_CASE("ACTOR: motions of actions and durations, without their noise, between two others") {
  const auto model = model_of(small());
  const std::vector<Index> actions{3, 1}, durations{4, 9}, each{4, 9, 5, 6}, unknown{3, 4}, three{1, 2, 3};
  ml::Philox rng{.seed = 7};
  const auto motions = ml::generate(model, actions, durations, rng, {.samples = 2});
  CHECK(motions.offsets == Offsets{4, 9, 4, 9});
  ml::Philox again{.seed = 7};
  const auto other = ml::generate(model, actions, each, again, {.samples = 2});
  CHECK(other.offsets == Offsets{4, 9, 5, 6});
  CHECK(same_bits(other[1], motions[1]));
  CHECK_ERROR(ml::generate(model, unknown, durations, rng), "[motionlang.shape.203]");
  CHECK_ERROR(ml::generate(model, actions, three, rng), "[motionlang.shape.204]");

  const std::vector<Index> labels{3, 1, 3, 1}, both{3, 3};
  const auto cleaned = ml::denoise(model, motions, labels);
  CHECK(cleaned.offsets == motions.offsets);
  const ml::Sequences<B> pair(ml::concat(0, motions[0], motions[2]), Offsets{4, 4});
  const auto line = ml::interpolate_motions(model, pair, 3, 5, 4);
  CHECK(line.count() == 5);
  CHECK(distance(line[0], cleaned[0]) < 1e-5);
  CHECK(distance(line[4], cleaned[2]) < 1e-5);
  CHECK(distance(line[2], line[0]) > 1e-4);
  CHECK_ERROR(ml::interpolate_motions(model, pair, 3, -1, 4), "[motionlang.config.101] interpolate_rows: -1 rows");
}

TEST_CASE("ACTOR: between two actions, the ends are the motions of the actions alone") {
  const auto alone = [](const ml::Actor<B>& model, Index action) {
    ml::Philox rng{.seed = 7};
    return ml::generate(model, std::vector{action}, std::vector<Index>{6}, rng)[0];
  };
  for (const ActorConfig& config : variants()) {
    CAPTURE(static_cast<int>(config.conditioning));
    const auto model = model_of(config);
    ml::Philox rng{.seed = 7};
    if (config.decoder != ActorDecoderKind::transformer) {
      CHECK_ERROR(ml::interpolate_actions(model, 3, 1, 5, 6, rng),
                  "[motionlang.config.102] interpolate_actions: actions 3 and 1");
      continue;
    }
    const auto line = ml::interpolate_actions(model, 3, 1, 5, 6, rng);
    CHECK(line.offsets == Offsets{6, 6, 6, 6, 6});
    CHECK(distance(line[0], alone(model, 3)) < 1e-5);
    CHECK(distance(line[4], alone(model, 1)) < 1e-5);
    CHECK(distance(line[2], line[0]) > 1e-4);
    CHECK(distance(line[2], line[4]) > 1e-4);
    CHECK_ERROR(ml::interpolate_actions(model, 3, 4, 5, 6, rng), "[motionlang.shape.203]");
    CHECK_ERROR(ml::interpolate_actions(model, 3, 1, 1, 6, rng), "[motionlang.config.101] interpolate_rows: 1 rows");
  }
}

TEST_CASE("ACTOR: half way between two actions is the motion of the mean of their biases") {
  const auto model = model_of(small());
  ml::Philox rng{.seed = 7}, again{.seed = 7};
  const auto line = ml::interpolate_actions(model, 3, 1, 3, 6, rng);
  const auto& biases = *model.decoder->actionBiases;
  const auto z = Matrix::randn({1, 16}, again);
  const auto half = z + (ml::slice(biases, 0, 1, 2) - ml::slice(biases, 0, 3, 4)) * 0.5;  // the decoder adds that of 3
  CHECK(distance(line[1], model.decode(half, std::vector<Index>{3}, Offsets{6})[0]) < 1e-5);
}

TEST_CASE("ACTOR: what a network cannot take is refused") {
  const std::vector<Index> one{1}, two{1, 2}, unknown{1, 4};
  const auto model = model_of(small());
  const auto x = motions({4, 7});
  CHECK_ERROR(model.encode(x, unknown), "[motionlang.shape.203]");
  CHECK_ERROR(model.encode(x, one), "[motionlang.shape.204]");
  CHECK_ERROR(model.decode(Matrix::zeros({2, 16}), unknown, x.offsets), "[motionlang.shape.203]");
  CHECK_ERROR(model.decode(Matrix::zeros({2, 16}), one, x.offsets), "[motionlang.shape.204] ActorDecoder: 1 labels");
  auto config = small();
  config.encoder = ActorEncoderKind::fully_connected, config.decoder = ActorDecoderKind::fully_connected;
  const auto fixed = model_of(config);
  CHECK_ERROR(fixed.encode(x, two), "[motionlang.shape.207]");
  CHECK_ERROR(fixed.decode(Matrix::zeros({2, 16}), two, x.offsets), "[motionlang.shape.207]");
  config.encoder = ActorEncoderKind::gru;
  CHECK_ERROR(model_of(config).encode(x, unknown), "[motionlang.shape.203]");
}

TEST_CASE("encoders without tokens: one length, padding that counts, and actions") {
  ml::Philox rng{.seed = 3};
  const std::vector<Index> labels{0, 1}, exchanged{1, 0}, unknown{0, 2};
  const ml::Sequences<B> x{normal<B, 2>({8, 5}, 1), Offsets{4, 4}}, other_lengths{x.rows, Offsets{3, 5}};

  const ml::ActorFullyConnectedEncoder<B> connected(5, 4, 2, 3, rng);
  CHECK(connected(x, labels, 2).mu.shape() == ml::Shape{2, 3});
  CHECK_ERROR(connected(other_lengths, labels, 2), "[motionlang.shape.207]");
  const ml::ActorFullyConnectedDecoder<B> decoder(5, 4, 2, 3, rng);
  const auto z = normal<B, 2>({2, 3}, 2);
  CHECK(decoder(z, labels, x.offsets, 5).rows.shape() == x.rows.shape());
  CHECK_ERROR(decoder(z, labels, Offsets{3, 5}, 5), "[motionlang.shape.207]");

  const ml::ActorAverageEncoder<B> average(5, {.d_model = 8, .heads = 2, .d_ff = 16, .layers = 1}, 10, rng);
  CHECK(same_bits(average(x).mu, average(x, {}, 4).mu));
  CHECK_FALSE(same_bits(average(x).mu, average(x, {}, 7).mu));
  CHECK_ERROR(average(x, {}, 11), "[motionlang.shape.203]");

  const ml::ActorGruEncoder<B> gru(5, 2, 6, 1, true, rng);
  CHECK(gru(other_lengths, labels).mu.shape() == ml::Shape{2, 6});
  CHECK_FALSE(same_bits(gru(x, labels).mu, gru(x, exchanged).mu));
  CHECK_ERROR(gru(x, unknown), "[motionlang.shape.203]");
}
