// Checkpoints of ACTOR and of its classifiers: sizes from shapes, options beside them, what is skipped, what is
// refused.
#include <fstream>

#include <motionlang/weights/actor_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/file_of_model.hpp"
#include "../../support/small_actor.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using models::file_of;
using small_actor::B;
using tensors::same_bits;

TEST_CASE("ACTOR: networks are known by their tensors, the rest by the options; tables of positions are skipped") {
  const std::vector<Index> actions{1, 3};
  for (ml::ActorConfig config : small_actor::variants()) {
    if (!config.concatenate_time) continue;  // does not show in published files, which always have it
    config.ff_size =
        config.encoder == ml::ActorEncoderKind::gru && config.decoder == ml::ActorDecoderKind::gru ? 1024 : 24;
    const bool fixed = config.decoder == ml::ActorDecoderKind::fully_connected;
    config.num_frames = fixed ? 5 : 60;
    if (fixed) config.num_layers = 8, config.ff_size = 1024;
    const auto model = small_actor::model_of(config);
    ml::RunFolder run;
    run.options = {{"num_frames", std::int64_t{5}}, {"pose_rep", std::string("rot6d")}};
    if (config.conditioning == ml::ActorConditioning::concat_bias)
      run.options.push_back({"ablation", std::string("concat_bias")});
    if (config.conditioning == ml::ActorConditioning::time_encoding)
      run.options.push_back({"ablation", std::string("time_encoding")});
    const auto loaded = ml::actor_network<B>(
        file_of(model, {"encoder.sequence_pos_encoder.pe", "decoder.sequence_pos_encoder.pe", "decoder.pe.pe"}), run);
    CHECK(loaded.config == config);
    const auto x = fixed ? small_actor::motions({5, 5}) : small_actor::motions({4, 7});
    const auto mu = model.encode(x, actions).mu;
    CHECK(same_bits(loaded.encode(x, actions).mu, mu));
    CHECK(same_bits(loaded.decode(mu, actions, x.offsets).rows, model.decode(mu, actions, x.offsets).rows));
  }
}

TEST_CASE("ACTOR: a run folder") {
  const TemporaryFolder folder;
  auto config = small_actor::small();
  config.njoints = 6, config.nfeats = 3, config.num_heads = 2, config.num_frames = 60;
  const auto model = small_actor::model_of(config);
  for (const char* name : {"checkpoint_0100.pth.tar", "checkpoint_0200.pth.tar"}) {
    ml::TensorStore store;
    store.add_module(name[12] == '2' ? model : small_actor::model_of([&] {
      auto other = config;
      other.num_classes = 9;
      return other;
    }()));
    ml::write_safetensors((folder / name).string(), store.views());  // the format is known by content
  }
  std::ofstream(folder / "opt.yaml") << "pose_rep: rotvec\nglob: false\nglob_rot:\n- 3\n- 0.5\n- 0\ntranslation: true\n"
                                        "num_heads: 2\nnum_layers: 2\nvertstrans: true\n";
  const auto run = ml::find_run(folder.path);
  const auto last = ml::open_weights(run.weights);
  CHECK(ml::actor_network<B>(last, run).config == config);
  auto first = config;
  first.num_classes = 9;
  CHECK(ml::actor_network<B>(ml::open_weights(folder / "checkpoint_0100.pth.tar"), run).config == first);
  const auto o = ml::actor_point_options(run, last);
  CHECK(o.features.rotations == ml::PoseRepresentation::rotvec);
  CHECK_FALSE(o.features.global);
  CHECK(o.features.translation);
  CHECK(o.translate);
  CHECK(o.global_rotation == ml::Vec3<double>{3, 0.5, 0});
}

TEST_CASE("ACTOR: how long the motions were that a run learned from") {
  const auto model = small_actor::model_of(small_actor::small());
  const auto longest = [&](std::vector<ml::FileValue> options) {
    ml::RunFolder run;
    run.options = std::move(options);
    return ml::actor_longest(run, file_of(model), model.config);
  };
  const auto option = [](const char* key, std::int64_t frames) { return ml::FileValue{key, frames}; };
  CHECK(longest({}) == 60);
  CHECK(longest({option("num_frames", 40), option("max_len", 100)}) == 40);
  CHECK(longest({option("num_frames", -2), option("min_len", 60), option("max_len", 100)}) == 100);
  CHECK(longest({option("num_frames", -1), option("max_len", 90)}) == 90);
  // 5000 positions, of which tokens have two
  CHECK(longest({option("num_frames", -1), option("max_len", -1)}) == 4998);
  CHECK(longest({option("num_frames", -2)}) == 4998);
  CHECK(longest({option("num_frames", 9000)}) == 4998);
  for (const std::int64_t none : {-3, 0, 1})
    CHECK_ERROR(longest({option("num_frames", none)}), "[motionlang.config.101]");
  CHECK_ERROR(longest({option("num_frames", -1), option("max_len", 0)}), "[motionlang.config.101]");
}

TEST_CASE("ACTOR: which frames a run took of clips, and which points its loss compared") {
  const auto model = small_actor::model_of(small_actor::small());
  ml::RunFolder run;
  CHECK(ml::actor_loss_points(run, file_of(model)) == ml::ActorPoints::vertices);
  const auto frames = [&](std::vector<ml::FileValue> options) {
    run.options = std::move(options);
    return ml::actor_frame_options(run, file_of(model));
  };
  CHECK(frames({}).step == 1);
  const auto steps = frames({{"sampling", std::string("random_conseq")}, {"sampling_step", std::int64_t{-1}}});
  CHECK((steps.random_step && !steps.scattered && steps.step == -1));
  const auto any = frames({{"sampling", std::string("random")}, {"jointstype", std::string("a2mpl")}});
  CHECK((any.scattered && !any.random_step && any.step == 1));
  CHECK(ml::actor_loss_points(run, file_of(model)) == ml::ActorPoints::a2mpl);
  CHECK_ERROR(frames({{"sampling", std::string("evenly")}}), "[motionlang.io.404]");
  CHECK_ERROR(frames({{"sampling_step", std::int64_t{0}}}), "[motionlang.config.101]");
  run.options = {{"jointstype", std::string("coco")}};
  CHECK_ERROR(ml::actor_loss_points(run, file_of(model)), "[motionlang.config.103]");
}

TEST_CASE("ACTOR: a run of positions has three numbers for each joint") {
  const auto model = small_actor::model_of(small_actor::small());  // 18 numbers a frame
  ml::RunFolder run;
  CHECK_FALSE(ml::actor_has_positions(run, file_of(model)));
  run.options = {{"pose_rep", std::string("xyz")}};
  CHECK(ml::actor_has_positions(run, file_of(model)));
  const auto config = ml::actor_network<B>(file_of(model), run).config;
  CHECK(config.nfeats == 3);
  CHECK(config.njoints == 6);
}

TEST_CASE("ACTOR: what does not fit is refused") {
  const auto model = small_actor::model_of(small_actor::small());
  CHECK_ERROR(ml::actor_network<B>(file_of(model, {"encoder.extra"})), "[motionlang.io.406]");
  CHECK_ERROR(ml::actor_network<B>(file_of(*model.decoder)), "[motionlang.io.406]");
  auto refused = [&](const char* key, auto value, const char* id) {
    ml::RunFolder run;
    run.options = {{key, value}};
    CHECK_ERROR(ml::actor_network<B>(file_of(model), run), id);
  };
  refused("num_heads", std::int64_t{3}, "[motionlang.config.101]");
  refused("num_heads", std::string("four"), "[motionlang.config.107]");
  refused("ablation", std::string("shuffle"), "[motionlang.io.404]");
  refused("ablation", std::string("zandtime"), "[motionlang.config.102]");
  refused("ablation", std::string("average_encoder"), "[motionlang.config.102]");
  refused("pose_rep", std::string("euler"), "[motionlang.config.103]");
  refused("pose_rep", std::string("rotquat"), "[motionlang.config.102]");  // 18 numbers
  refused("archiname", std::string("autotrans"), "[motionlang.config.102]");
  refused("num_layers", std::int64_t{8}, "[motionlang.config.102]");
  refused("latent_dim", std::int64_t{256}, "[motionlang.config.102]");
}

TEST_CASE("ACTOR: a file that is too small for a network of its sizes is refused before memory is taken") {
  CHECK_ERROR(
      ml::actor_network<B>(models::file_of_shapes({{"encoder.muQuery", {2, 70'000}},
                                                   {"encoder.seqTransEncoder.layers.0.linear1.weight", {2, 1}},
                                                   {"decoder.finallayer.weight", {6, 1}},
                                                   {"decoder.actionBiases", {2, 1}},
                                                   {"decoder.seqTransDecoder.layers.0.linear1.weight", {2, 1}}})),
      "[motionlang.config.102] model.ckpt: 140012 numbers");
  const auto connected = [](ml::Index latent) {
    return ml::ActorConfig{.latent_dim = latent,
                           .encoder = ml::ActorEncoderKind::fully_connected,
                           .decoder = ml::ActorDecoderKind::fully_connected};
  };
  const auto made = [](const ml::ActorConfig& config) {
    const auto file = models::file_of_shapes({{"encoder.mu.weight", {256, 256}}});
    const auto room = ml::detail::room_of(file);
    ml::NoInit zeros;
    return ml::Actor<B>(config, zeros);
  };
  CHECK(made(connected(2048)).config == connected(2048));  // it has no layers, whatever their number is
  ml::ActorConfig long_ones = connected(256);
  long_ones.num_frames = 100'000;
  CHECK_ERROR(made(long_ones),
              "[motionlang.config.102] model.ckpt: 65536 numbers, a network of its sizes has at least");
}

TEST_CASE("classifiers of ACTOR's motions") {
  ml::Philox rng{.seed = 3};
  const ml::GruClassifier<B> gru({.input_size = 18, .hidden_size = 8, .num_classes = 5}, rng);
  const ml::StGcn<B> graph({.in_channels = 3, .num_classes = 4, .channels = {4, 6, 6}, .strides = {1, 2, 1}}, rng);
  const auto x = small_actor::motions({4, 7});
  CHECK(same_bits(ml::load_gru_classifier<B>(file_of(gru))(x).logits, gru(x).logits));
  const ml::Sequences<B> y(tensors::normal<B, 2>({20, 72}, 4), ml::Offsets{20});
  CHECK(same_bits(std::as_const(graph)(y).logits, ml::load_stgcn<B>(file_of(graph))(y).logits));
  CHECK_ERROR(ml::load_stgcn<B>(file_of(gru)), "[motionlang.io.406]");
  CHECK_ERROR(
      ml::load_gru_classifier<B>(models::file_of_shapes(
          {{"recurrent.weight_ih_l0", {1, 1}}, {"recurrent.weight_hh_l0", {1, 70'000}}, {"linear2.weight", {1, 1}}})),
      "[motionlang.config.102] model.ckpt: 70002 numbers");
  CHECK_ERROR(ml::load_stgcn<B>(models::file_of_shapes({{"A", {3, 2, 2}},
                                                        {"data_bn.weight", {2}},
                                                        {"fcn.weight", {1, 1, 1, 1}},
                                                        {"st_gcn_networks.0.tcn.2.weight", {70'000, 1, 1, 1}}})),
              "[motionlang.config.102] model.ckpt: 70015 numbers");
  CHECK_ERROR(ml::load_stgcn<B>(models::file_of_shapes({{"A", {3, 70'000, 1}}, {"data_bn.weight", {1}}})),
              "[motionlang.io.407] model.ckpt: tensor 'A' is (3, 70000, 1)");
  CHECK_ERROR(ml::load_gru_classifier<B>(file_of(graph)), "[motionlang.io.406]");
}
