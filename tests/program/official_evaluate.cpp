// The motionlang program on folders as the official repositories leave them: evaluate.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/features/joint_sets.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/metrics/temos_score.hpp>
#include <motionlang/weights/embedding_cache.hpp>

#include "../support/body_arrays.hpp"
#include "../support/official_tm2t.hpp"
#include "../support/official_vaes.hpp"
#include "../support/synthetic_motion.hpp"
#include "official_workplace.hpp"

namespace fs = std::filesystem;

namespace {

/// The numbers of the row that begins so.
std::vector<double> numbers_of_row(const std::string& text, const std::string& name) {
  const auto at = text.find("  " + name + " ");
  REQUIRE_MESSAGE(at != std::string::npos, text);
  std::istringstream rest(text.substr(at + name.size() + 2, text.find('\n', at) - at - name.size() - 2));
  std::vector<double> out;
  std::string word;
  while (rest >> word) {
    if (word.find_first_not_of("+-.0123456789") == word.npos && word.find_first_of("0123456789") == 0)
      out.push_back(std::stod(word));
  }
  return out;
}

}  // namespace

TEST_CASE("evaluate: ACTOR as published, judged by classifiers as published and of our training") {
  const OfficialWorkplace w;
  const auto& names = ml::humanact12_actions;
  official::write_actor_run(w / "actor", official::small_actor());
  ml::Philox rng{.seed = 98};
  const ml::GruClassifier<official::B> gru({.hidden_size = 16, .num_layers = 2, .num_classes = 12}, rng);
  ml::StGcn<official::B> stgcn({.num_classes = 12, .channels = {4, 4, 8}, .strides = {1, 1, 2}}, rng);
  // windows of 60 frames have all of these clips; what the classifiers say of them, found with the library
  std::vector<std::string> ids;
  std::string labels, listed;
  std::vector<ml::Motion> clips;
  for (int i = 0; i < 12; ++i) {
    ids.push_back("clip" + std::to_string(i));
    ml::write_bvh(w / (ids.back() + ".bvh"),
                  synthetic::walk({.frames = 60, .steps_per_second = 0.6 + 0.2 * i, .turn = 0.5 * (i % 4)}));
    listed += ids.back() + "\n";
    labels += ids.back() + "\t0\t3\t" + std::string(names[i]) + "\n";
    clips.push_back(ml::retarget(ml::read_bvh_motion(w / (ids.back() + ".bvh"))));
  }
  using Classes = std::vector<ml::Index>;
  const auto classes = [](const std::vector<ml::Motion>& motions, auto classify) {
    Classes out;
    for (const ml::Motion& m : motions) {
      const ml::Tensor<official::B, 2> logits = classify(m);
      out.push_back(std::max_element(logits.span().begin(), logits.span().end()) - logits.span().begin());
    }
    return out;
  };
  const auto sequence = [](const std::vector<float>& x) {
    return ml::Sequences<official::B>(ml::Tensor<official::B, 2>::from(x, {60, std::ssize(x) / 60}), ml::Offsets{60});
  };
  const auto by_gru = [&](const ml::Motion& m) {  // after 60 frames its first state is forgotten
    std::vector<float> points;
    for (const auto& p : m.positions()) {
      const auto from = p - m.root_at(0);
      for (const double x : {from.x, -from.y, -from.z}) points.push_back(static_cast<float>(x));
    }
    return gru(sequence(points)).logits;
  };
  const auto by_stgcn = [&](const ml::Motion& m) {
    const auto rows = ml::actor_rows_of_motion(m);
    std::vector<float> rotations;
    for (std::ptrdiff_t f = 0; f < 60; ++f)
      rotations.insert(rotations.end(), rows.begin() + 150 * f, rows.begin() + 150 * f + 144);
    return std::as_const(stgcn)(sequence(rotations)).logits;
  };
  auto mean = by_stgcn(clips[0]) * (1.0 / 12);  // taken off, so that it tells clips apart
  for (std::size_t i = 1; i < 12; ++i) mean = mean + by_stgcn(clips[i]) * (1.0 / 12);
  stgcn.fcn.bias = stgcn.fcn.bias - ml::reshape<1>(mean, {12});
  const std::vector<Classes> said{classes(clips, by_gru), classes(clips, by_stgcn)};
  auto others = clips;  // as if nothing stood on its head
  for (ml::Motion& m : others) {
    for (auto& p : m.root) p = ml::rotate(synthetic::about_x(std::numbers::pi), p);
    for (ml::Index f = 0; f < 60; ++f) m.rotations(f)[0] = synthetic::about_x(std::numbers::pi) * m.rotations(f)[0];
  }
  const std::vector<Classes> otherwise{classes(others, by_gru), classes(others, by_stgcn)};
  for (const std::size_t kind : {0u, 1u}) {
    int differ = 0;
    for (std::size_t i = 0; i < 12; ++i) differ += said[kind][i] != otherwise[kind][i] ? 1 : 0;
    CHECK(differ > 3);  // so that the accuracies below would be others
  }
  TorchArchive of_gru, of_stgcn, of_ntu;
  of_gru.begin("model");
  official::add_module(of_gru, gru);
  of_gru.end();
  official::add_module(of_stgcn, stgcn);
  official::add_module(of_ntu,
                       ml::GruClassifier<official::B>({.input_size = 54, .hidden_size = 4, .num_classes = 13}, rng));
  official::write_bytes(w / "humanact12_gru.tar", of_gru.finish());
  official::write_bytes(w / "uestc_rot6d_stgcn.tar", of_stgcn.finish());
  official::write_bytes(w / "ntu13_gru.tar", of_ntu.finish());

  ml::write_file(w / "labels.tsv", labels);
  official::write_text(w / "splits/train.txt", listed);
  const auto train = [&](const std::string& command, const std::string& out, std::vector<std::string> sets,
                         const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{command,  "--data",   ".",     "--labels", "labels.tsv", "--splits",
                                       "splits", "--preset", "small", "--out",    out};
    sets.push_back("clips.fps=20");  // as the published model
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return w.run(arguments);
  };
  const std::string as_they_face = "clips.turned_ahead=false", once = "optimiser.epochs=1";
  const Outcome of_ours = train(
      "train-actor", "ours",
      {as_they_face, once, "network.latent_dim=8", "network.ff_size=8", "network.num_layers=1", "network.num_heads=2"});
  REQUIRE_MESSAGE(of_ours.code == 0, of_ours.text);
  const auto evaluate = [&](const std::string& classifier, const std::string& table,
                            const std::string& model = "actor") {
    return w.run({"evaluate", model, "--data", ".", "--labels", table, "--splits", "splits", "--part", "training",
                  "--classifier", classifier, "--seeds", "2"});
  };
  for (const std::size_t kind : {0u, 1u}) {
    const std::string classifier = kind == 0 ? "humanact12_gru.tar" : "uestc_rot6d_stgcn.tar";
    CAPTURE(classifier);
    std::string table;  // every third label is wrong
    for (std::size_t i = 0; i < 12; ++i)
      table += ids[i] + "\t0\t3\t" + std::string(names[(said[kind][i] + (i % 3 == 0 ? 1 : 0)) % 12]) + "\n";
    ml::write_file(w / "judged.tsv", table);
    const Outcome judged = evaluate(classifier, "judged.tsv");
    REQUIRE_MESSAGE(judged.code == 0, judged.text);
    CHECK(contains(judged.text, "12 motions of the training part, 12 classes"));
    CHECK(numbers_of_row(judged.text, "recorded").at(0) == doctest::Approx(66.7).epsilon(1e-5));
    for (const char* row : {"generated", "denoised", "between two of an action"})
      CHECK(numbers_of_row(judged.text, row).size() >= 4);
    // a model of our training, whose labels are in the order of the alphabet
    const Outcome ours = evaluate(classifier, "judged.tsv", "ours/model");
    REQUIRE_MESSAGE(ours.code == 0, ours.text);
    CHECK(numbers_of_row(ours.text, "recorded").at(0) == doctest::Approx(66.7).epsilon(1e-5));
  }
  const auto refused = [&](const std::string& classifier, const std::string& table, const std::string& message) {
    const Outcome out = evaluate(classifier, table);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  refused("ntu13_gru.tar", "labels.tsv",
          "[motionlang.config.102] ntu13_gru.tar reads 18 points of a body: --body SMPL, --joint-regressor "
          "J_regressor_extra.npy");

  // on points of a body: those of SMPL's joints with the way of the root, Action2Motion's without it
  ml::write_npz(w / "smpl.npz", body_arrays::chain(24, 6890, 10));
  std::vector<float> shares(9 * 6890);
  rng.uniform(std::span(shares));
  for (float& s : shares) s /= 6890;
  ml::write_npy(w / "extra.npy", ml::NpyArray::of(std::span<const float>(shares), {9, 6890}));
  const auto body = ml::read_body<official::B>(w / "smpl.npz").model;
  const auto regressor = ml::Tensor<official::B, 2>::from(shares, {9, 6890});
  const auto on_body = [&](const std::string& classifier, std::vector<std::string> more) {
    more.insert(more.begin(), {"evaluate", "actor", "--data", ".", "--labels", "judged.tsv", "--splits", "splits",
                               "--part", "training", "--classifier", classifier, "--seeds", "1"});
    return w.run(more);
  };
  for (const bool a2m : {false, true}) {
    CAPTURE(a2m);
    ml::GruClassifier<official::B> judge(
        {.input_size = a2m ? 54 : 72, .hidden_size = 16, .num_layers = 2, .num_classes = 12}, rng);
    auto& read = judge.recurrent.layers.front().weight_ih;
    read = read * 0.05;  // the body is large: gates that are open forget the first state, which is drawn
    std::optional<ml::Philox> state;
    const auto logits = [&](const ml::Motion& m) {
      const auto rows = ml::actor_rows_of_motion(m);
      const auto points =
          ml::actor_points<official::B>(sequence({rows.begin(), rows.end()}), body, &regressor,
                                        a2m ? ml::ActorPoints::a2m : ml::ActorPoints::smpl, {.translate = !a2m});
      if (!state) return judge(points).logits;
      const auto h0 = judge.initial_state(1, *state);
      return judge(points, &h0).logits;
    };
    auto usual = logits(clips[0]) * (1.0 / 12);  // taken off, so that it tells clips apart
    for (std::size_t i = 1; i < 12; ++i) usual = usual + logits(clips[i]) * (1.0 / 12);
    judge.linear2.bias = judge.linear2.bias - ml::reshape<1>(usual, {12});
    const Classes wanted = classes(clips, logits);
    CHECK(std::set<ml::Index>(wanted.begin(), wanted.end()).size() > 2);
    state = ml::Philox{.seed = 5};
    CHECK(classes(clips, logits) == wanted);
    TorchArchive archive;
    archive.begin("model");
    official::add_module(archive, judge);
    archive.end();
    official::write_bytes(w / "points_gru.tar", archive.finish());
    std::string table;  // every third label is wrong
    for (std::size_t i = 0; i < 12; ++i)
      table += ids[i] + "\t0\t3\t" + std::string(names[(wanted[i] + (i % 3 == 0 ? 1 : 0)) % 12]) + "\n";
    ml::write_file(w / "judged.tsv", table);
    const Outcome judged =
        on_body("points_gru.tar", a2m ? std::vector<std::string>{"--body", "smpl.npz", "--joint-regressor", "extra.npy"}
                                      : std::vector<std::string>{"--body", "smpl.npz"});
    REQUIRE_MESSAGE(judged.code == 0, judged.text);
    CHECK(numbers_of_row(judged.text, "recorded").at(0) == doctest::Approx(66.7).epsilon(1e-5));
  }
  CHECK(contains(on_body("uestc_rot6d_stgcn.tar", {"--body", "smpl.npz"}).text,
                 "[motionlang.config.102] uestc_rot6d_stgcn.tar has no use for --body 'smpl.npz'"));
  CHECK(contains(on_body("humanact12_gru.tar", {"--joint-regressor", "extra.npy"}).text, "has no use for --body ''"));
  refused("actor/checkpoint_5000.pth.tar", "labels.tsv",
          "[motionlang.io.404] actor/checkpoint_5000.pth.tar: neither the GRU");

  // of our training: on the same labels, whose numbers are others, at the same rate, as the clips face
  const Outcome own =
      train("train-classifier", "own", {as_they_face, "optimiser.epochs=40", "optimiser.lr=0.02", "hidden_size=16"});
  REQUIRE_MESSAGE(own.code == 0, own.text);
  const Outcome by_own = evaluate("own/model", "labels.tsv");
  REQUIRE_MESSAGE(by_own.code == 0, by_own.text);
  const Outcome itself = w.run({"evaluate", "own/model", "--data", ".", "--labels", "labels.tsv", "--splits", "splits",
                                "--part", "training", "--seeds", "2"});
  REQUIRE_MESSAGE(itself.code == 0, itself.text);
  const auto known = numbers_of_row(itself.text, "accuracy %");
  CHECK(known.at(0) > 50);  // so many are not right by chance
  CHECK(numbers_of_row(by_own.text, "recorded").at(0) == known.at(0));
  REQUIRE(train("train-classifier", "turned", {once}).code == 0);
  refused("turned/model", "labels.tsv",
          "different clips: fps 20, turned_ahead false, translation true, global true and fps 20, turned_ahead true, "
          "translation true, global true");
  // a model of positions is judged by a classifier that reads them
  ml::ActorConfig of_positions = official::small_actor();
  of_positions.nfeats = 3, of_positions.njoints = 24;
  official::write_actor_run(w / "positions", of_positions, "", "xyz");
  REQUIRE(train("train-classifier", "reads_positions", {as_they_face, "clips.pose=xyz", once}).code == 0);
  const Outcome judged = evaluate("reads_positions/model", "labels.tsv", "positions");
  REQUIRE_MESSAGE(judged.code == 0, judged.text);
  CHECK_MESSAGE(contains(judged.text, "  generated"), judged.text);
  // its motions to learn from
  const Outcome learnt =
      train("train-classifier", "learnt", {as_they_face, once, "generated_share=1", "generated_kind=denoised"},
            {"--generated", "actor"});
  CHECK_MESSAGE(learnt.code == 0, learnt.text);

  // gone on from, with its actions and in its world
  const auto go_on = [&](const std::string& camera) {
    return train("train-actor", "further",
                 {as_they_face, "clips.camera=" + camera, "optimiser.lr=0", once, "network.latent_dim=16",
                  "network.ff_size=24", "network.num_layers=2"},
                 {"--from", "actor"});
  };
  CHECK(contains(go_on("false").text, "[motionlang.config.102] the model to start from has other clips"));
  const Outcome further = go_on("true");
  REQUIRE_MESSAGE(further.code == 0, further.text);
  const auto before = ml::load_actor_run<official::B>(ml::FilePath(w / "actor")).model;
  const auto weights = ml::SafetensorsFile::open(w / "further/model/weights.safetensors");
  CHECK(ml::values_of<float>(weights.tensor("encoder.muQuery")) == before.encoder->muQuery.to_vector());
  CHECK(numbers_of_row(evaluate("humanact12_gru.tar", "labels.tsv", "further/model").text, "recorded") ==
        numbers_of_row(evaluate("humanact12_gru.tar", "labels.tsv").text, "recorded"));
}

TEST_CASE("evaluate: TEMOS as published, by its own DistilBERT") {
  const OfficialWorkplace w;
  official::write_temos_run(w / "temos", official::small_temos());
  official::write_text(w / "words/vocab.txt", official::bert_vocabulary);
  const ml::MotionFeatures& features = ml::motion_features("rifke64");
  std::string captions;
  std::vector<ml::Motion> clips, dense;  // at 12.5 and at 100 frames per second
  for (int i = 0; i < 3; ++i) {
    const std::string id = "clip" + std::to_string(i);
    ml::write_bvh(w / (id + ".bvh"), synthetic::walk({.frames = 40 + 8 * i, .fps = 12.5, .turn = 0.4 * i}));
    captions += id + "\t0\t" + std::to_string(3 + 0.5 * i) + "\tlegs\t" + (i == 0 ? "a walk" : "walk") + "\n";
    const auto all = ml::retarget(ml::read_bvh_motion(w / (id + ".bvh")));
    clips.push_back(ml::crop(ml::resample(all, 12.5), 0, static_cast<ml::Index>((3 + 0.5 * i) * 12.5 + 0.5)));
    dense.push_back(ml::crop(ml::resample(all, 100), 0, static_cast<ml::Index>((3 + 0.5 * i) * 100 + 0.5)));
  }
  ml::write_file(w / "captions.tsv", captions);
  official::write_text(w / "splits/train.txt", "clip1\nclip2\n");
  official::write_text(w / "splits/test.txt", "clip0\n");
  const auto rows = features.from_motion(clips[0]);  // in KIT's units, as are the statistics
  ml::FeatureStatistics statistics;
  statistics.add(std::span<const double>(rows), 64);
  const auto write = [&](const std::string& file, const std::vector<double>& values) {
    const std::vector<float> x(values.begin(), values.end());
    official::write_bytes(w / ("statistics/" + file),
                          TorchArchive::of_tensor(official::view_of(ml::Tensor<official::B, 1>::from(x, {64}))));
  };
  write("jfeats_mean.pt", statistics.mean());
  write("jfeats_std.pt", std::vector<double>(64, 2.0));

  const std::vector<std::string> command{"evaluate",   "temos",        "--data",   ".",
                                         "--captions", "captions.tsv", "--splits", "splits"};
  const auto evaluate = [&](std::vector<std::string> more) {
    more.insert(more.begin(), command.begin(), command.end());
    return w.run(more);
  };
  const auto measured = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--statistics", "statistics", "--text-encoder", "words", "--samples", "2"});
    const Outcome out = evaluate(more);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return out.text;
  };
  const std::string said = measured({"--strips", "strips", "--rate", "12.5"}), at_100 = measured({});
  CHECK(contains(said, "1 motion of the test part"));
  CHECK(!contains(said, "frames per second"));
  CHECK_MESSAGE(contains(at_100, "joints at 100 frames per second; generated ones are interpolated from 12.5"), at_100);
  for (const char* file : {"strips/1.svg", "strips/1_recorded.svg"})
    CHECK_MESSAGE(contains(ml::read_file(w / file), "a walk"), file);
  const auto run = ml::load_temos_run<official::B>(ml::FilePath(w / "temos"),
                                                   {.text_encoder = w / "words", .statistics = w / "statistics"});
  const std::vector<std::string> text{"a walk"};
  const auto tokens = run.text_encoder.encode<official::B>(std::span<const std::string>(text)).tokens;
  const auto frames = clips[0].frames();
  const auto truth = ml::rifke_joints(ml::temos_rifke(), std::span<const double>(rows));
  const auto dense_rows = features.from_motion(dense[0]);
  const auto dense_truth = ml::rifke_joints(ml::temos_rifke(), std::span<const double>(dense_rows));
  CHECK(dense_truth.size() == 21 * 300);
  const auto check_row = [&](const std::string& name, const ml::Tensor<official::B, 2>& made, bool in_100 = false) {
    std::vector<ml::Vec3<double>> joints;
    std::vector<double> values;
    for (const auto& p : ml::temos_joints(run.normalizer, made)) {
      joints.push_back(ml::vec_cast<double>(p));
      values.insert(values.end(), {joints.back().x, joints.back().y, joints.back().z});
    }
    if (in_100) {
      joints.clear();
      values = ml::upsample_linearly(std::span<const double>(values), 63, 12.5, 100);
      for (std::size_t i = 0; i < values.size(); i += 3) joints.push_back({values[i], values[i + 1], values[i + 2]});
    }
    ml::ApeAveMetric<double> metric(ml::temos_rifke(), 0.001);
    metric.add(joints, in_100 ? dense_truth : truth);
    const auto e = metric.result();
    const auto found = numbers_of_row(in_100 ? at_100 : said, name);
    std::vector<double> wanted;
    for (const ml::PositionErrors* p : {&e.ape, &e.ave})
      for (const double x : {p->root, p->trajectory, p->mean_local(), p->mean_joints()}) wanted.push_back(x);
    REQUIRE_MESSAGE(found.size() == 8, said);
    for (std::size_t i = 0; i < 8; ++i)
      CHECK_MESSAGE(std::abs(found[i] - wanted[i]) < 1.1e-3, name << " " << i << ": " << wanted[i]);
    return wanted;
  };
  const auto of_mean = check_row(
      "mean of the latent",
      ml::text_to_motion(run.model, tokens, ml::Offsets{frames}, ml::Philox{}, 1, {.mean = true}).front().rows);
  const auto of_one =
      check_row("one sample", ml::text_to_motion(run.model, tokens, ml::Offsets{frames}, ml::Philox{}).front().rows);
  CHECK(std::abs(of_mean[0] - of_one[0]) > 2e-3);
  check_row("one sample", ml::text_to_motion(run.model, tokens, ml::Offsets{frames}, ml::Philox{}).front().rows, true);

  // a model on SMPL, measured on MMM's joints: those in KIT's units are 0.64 times as far apart
  official::write_lightning_run(w / "on_smpl", official::temos(official::small_temos(135)), official::small_temos(135),
                                12.5);
  official::write_temos_statistics(w / "of135", 135);
  const auto on_mmm = [&](const std::string& set, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"evaluate", "on_smpl", "--data", ".", "--captions", "captions.tsv", "--splits", "splits",
                               "--statistics", "of135", "--text-encoder", "words", "--samples", "1", "--joints", set});
    return w.run(more);
  };
  const Outcome scaled = on_mmm("mmm"), in_metres = on_mmm("mmmns");
  REQUIRE_MESSAGE(scaled.code == 0, scaled.text);
  CHECK_MESSAGE(contains(scaled.text, "MMM's joints of our own skeleton"), scaled.text);
  const auto small = numbers_of_row(scaled.text, "one sample"), large = numbers_of_row(in_metres.text, "one sample");
  REQUIRE_MESSAGE((small.size() == 8 && large.size() == 8), in_metres.text);
  CHECK(large[0] > 0.05);
  for (const std::size_t i : {1u, 4u, 5u, 6u, 7u}) {  // without heights, which keep the unscaled place of the root
    const double wanted = (i < 4 ? 0.64 : 0.64 * 0.64) * large[i];
    CHECK_MESSAGE(std::abs(small[i] - wanted) < 1.1e-3 * (1 + wanted), i << ": " << small[i] << ", " << wanted);
  }
  const Outcome other_body = on_mmm("mmm", {"--body", "clip0.bvh"});
  CHECK(other_body.code == 1);
  CHECK_MESSAGE(contains(other_body.text, "clip0.bvh"), other_body.text);

  const auto refused = [&](std::vector<std::string> more, const std::string& message) {
    const Outcome out = evaluate(more);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  refused({"--text-encoder", "words"}, "no statistics of the motions");
  refused({"--statistics", "statistics"}, "no tokenizer of DistilBERT");
  const auto with_files = [](std::vector<std::string> more) {
    more.insert(more.end(), {"--statistics", "statistics", "--text-encoder", "words"});
    return more;
  };
  refused(with_files({"--joints", "mmm"}),
          "[motionlang.config.102] MMM's joints of SMPL need a model of smplvelp, this one has 'rifke64'");
  refused(with_files({"--rate", "30"}),
          "[motionlang.config.101] joints of 12.5 frames per second cannot be interpolated to 30");
  const Outcome no_set = evaluate(with_files({"--body", "captions.tsv"}));
  CHECK(no_set.code == 2);
  CHECK_MESSAGE(contains(no_set.text, "--body of TEMOS is for --joints mmm or mmmns"), no_set.text);
  const auto teach = official::small_teach();
  official::write_lightning_run(w / "teach", official::teach(teach), teach, 30);
  const Outcome other = w.run({"evaluate", "teach", "--data", ".", "--captions", "captions.tsv"});
  CHECK(other.code == 2);
  CHECK_MESSAGE(contains(other.text, "[motionlang.config.102] --babel is required"), other.text);
}

TEST_CASE("evaluate: SINC and TEACH as published, on labels of BABEL") {
  using official::B;
  const OfficialWorkplace w;
  const auto small_sinc = official::small_sinc();
  const auto small_teach = official::small_teach();
  const auto small_temos = official::small_temos(135);
  official::write_lightning_run(w / "sinc", official::sinc(small_sinc), small_sinc, 30);
  official::write_lightning_run(w / "teach", official::teach(small_teach), small_teach, 30);
  official::write_lightning_run(w / "temos", official::temos(small_temos), small_temos, 12.5);
  official::write_temos_statistics(w / "of135", 135);
  official::write_text(w / "words/vocab.txt", official::bert_vocabulary);
  fs::create_directories(w / "CMU");
  const auto entry = [](const std::string& id, const std::string& second) {
    const auto label = [](const std::string& text, const std::string& start, const std::string& end) {
      return R"({"raw_label": "", "proc_label": ")" + text + R"(", "seg_id": "", "act_cat": null, "start_t": )" +
             start + R"(, "end_t": )" + end + "}";
    };
    return "\"" + id + R"(": {"babel_sid": )" + id + R"(, "url": "", "feat_p": "CMU/CMU/)" + id +
           R"(_poses.npz", "dur": 4.0, "frame_ann": {"labels": [)" + label("walk", "0", "2") + ", " +
           label(second, "1", "3.5") + "]}}";
  };
  std::vector<ml::Motion> clips;
  for (int i : {1, 2}) {
    const std::string id = std::to_string(i);
    ml::write_amass(w / ("CMU/" + id + "_poses.npz"), synthetic::walk({.frames = 120, .fps = 30, .turn = 0.2 * i}));
    clips.push_back(ml::read_amass(w / ("CMU/" + id + "_poses.npz")).motion);
  }
  ml::write_file(w / "val.json", "{" + entry("1", "wave") + ", " + entry("2", "wave") + "}");
  ml::write_file(w / "train.json", "{" + entry("1", "turn") + "}");
  ml::write_file(w / "same.json", "{" + entry("1", "wave") + "}");
  ml::write_file(w / "stand.json", "{" + entry("2", "stand") + "}");
  const auto evaluate = [&](const std::string& model, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"evaluate", model, "--data",       ".",     "--babel",        "val.json",
                                       "--part",   "all", "--statistics", "of135", "--text-encoder", "words"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return w.run(arguments);
  };
  const auto measured = [&](const std::string& model, const std::vector<std::string>& more) {
    const Outcome out = evaluate(model, more);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return out.text;
  };
  const auto close = [](double a, double b) { return std::abs(a - b) < 1.1e-3 * (1 + std::abs(b)); };
  using Joints = std::vector<ml::Vec3<double>>;
  const auto check_row = [&](const std::string& said, const std::string& name, const ml::RifkeVariant& variant,
                             const std::vector<Joints>& made, const std::vector<Joints>& truth) {
    CAPTURE(name);
    ml::ApeAveMetric<double> metric(variant);
    for (std::size_t i = 0; i < made.size(); ++i) metric.add(made[i], truth[i]);
    const auto e = metric.result();
    std::vector<double> wanted;
    for (const ml::PositionErrors* p : {&e.ape, &e.ave})
      for (const double x : {p->root, p->trajectory, p->mean_local(), p->mean_joints()}) wanted.push_back(x);
    const auto found = numbers_of_row(said, name);
    REQUIRE_MESSAGE(found.size() == 8, said);
    for (std::size_t i = 0; i < 8; ++i) CHECK_MESSAGE(close(found[i], wanted[i]), said << i << ": " << wanted[i]);
    return wanted;
  };
  const auto joints_of = [](const ml::SmplVelpMotion<float>& clip) {
    return ml::detail::turned_up(ml::detail::first_joints(ml::motion_of_smplvelp(clip, 30), 22), true);
  };
  const auto rows_of = [&](const ml::Motion& clip, ml::Index first, ml::Index last) {
    const auto rows = ml::motion_features("smplvelp-published").from_motion(ml::crop(clip, first, last));
    return std::vector<float>(rows.begin(), rows.end());
  };
  const auto recorded = [](const std::vector<float>& rows) {
    return ml::smplvelp_inverse(std::span<const float>(rows));
  };
  const ml::TemosRunOptions sources{.text_encoder = w / "words", .statistics = w / "of135"};

  ml::write_file(w / "keys.txt", std::string_view("spatial_pairs-2-0\nspatial_pairs-7-0\n"));
  // two labels at the same time, between 1 and 2 seconds
  const auto sinc = ml::load_sinc_run<B>(ml::find_run(w / "sinc"), sources);
  ml::write_file(w / "parts.json", R"({"walk": ["", "", "right leg\nleft leg"], "wave": ["", "", "right arm"]})");
  const std::string of_sinc = measured("sinc", {"--samples", "2", "--temos", "sinc", "--body-parts", "parts.json",
                                                "--conjunction", "while", "--strips", "strips"});
  for (const char* text : {"2 motions of val.json", "two labels as in 'walk while wave'", "joints of our own skeleton",
                           "  best of 2 samples ", "  mean of the latent ", "  labels alone, composed "})
    CHECK_MESSAGE(contains(of_sinc, text), of_sinc);
  // both motions have the same text, of which there are strips once
  const auto check_strips = [&](const std::string& folder, const std::string& text) {
    for (const char* file : {"/1.svg", "/1_recorded.svg"})
      CHECK_MESSAGE(contains(ml::read_file(w / (folder + file)), text), folder << file);
    CHECK(ml::read_file(w / (folder + "/1.svg")) != ml::read_file(w / (folder + "/1_recorded.svg")));
    CHECK(!fs::exists(w / (folder + "/2.svg")));
  };
  check_strips("strips", "walk while wave");
  std::vector<Joints> truth, made, others;
  std::vector<float> of_made, of_recorded;
  for (const ml::Motion& clip : clips) {
    const auto rows = rows_of(clip, 30, 60);
    const auto tokens = sinc.text_encoder.encode<B>(std::vector<std::string>{"walk while wave"}).tokens;
    const auto motion = ml::sinc_motion(
        sinc.normalizer, ml::text_to_motion(sinc.model, tokens, ml::Offsets{30}, ml::Philox{}).front().rows);
    truth.push_back(joints_of(recorded(rows))), made.push_back(joints_of(motion));
    const auto add = [&](std::vector<float>& to, const std::vector<float>& features) {
      const auto x = sinc.normalizer.normalize(ml::Tensor<B, 2>::from(features, {30, 135}));
      const auto mu = sinc.model.encode_motion({x, ml::Offsets{30}}).mu.to_vector();
      to.insert(to.end(), mu.begin(), mu.end());
    };
    add(of_recorded, rows);
    add(of_made, ml::smplvelp_features(std::span<const ml::Matrix3<float>>(motion.rotations),
                                       std::span<const ml::Vec3<float>>(motion.trans)));
  }
  others = {truth[1], truth[0]};
  const auto one = check_row(of_sinc, "one sample", ml::sinc_rifke(), made, truth);
  const auto clip = check_row(of_sinc, "random clip", ml::sinc_rifke(), others, truth);
  CHECK(!close(one[0], clip[0]));
  const std::string likeness = of_sinc.substr(of_sinc.find("TEMOS score"));
  const auto rows = [](const std::vector<float>& x) { return ml::Rows(std::span(x), 16); };
  CHECK(close(numbers_of_row(likeness, "one sample").at(0), ml::temos_score(rows(of_made), rows(of_recorded))));
  auto swapped = of_recorded;
  std::rotate(swapped.begin(), swapped.begin() + 16, swapped.end());
  CHECK(
      close(numbers_of_row(likeness, "another recorded one").at(0), ml::temos_score(rows(swapped), rows(of_recorded))));
  const std::string in_code = measured("sinc", {"--samples", "1"});
  CHECK(contains(in_code, "two labels as in 'walk and wave at the same time'"));
  CHECK(!contains(in_code, "TEMOS score"));
  CHECK(numbers_of_row(in_code, "one sample") != numbers_of_row(of_sinc, "one sample"));  // another sentence
  CHECK(numbers_of_row(in_code, "random clip") == numbers_of_row(of_sinc, "random clip"));
  CHECK(contains(of_sinc, "without the -ing form of its paper"));
  // with the second verb in its -ing form, as the published routine writes it
  ml::write_file(w / "tags.txt", std::string_view("walk while wave#walk/VERB while/SCONJ wave/VERB#0.0#0.0\n"));
  const std::string gerund = measured("sinc", {"--samples", "1", "--conjunction", "while", "--tags", "tags.txt",
                                               "--strips", "gerund", "--keys", "keys.txt"});
  check_strips("gerund", "walk while waveing");
  CHECK_MESSAGE(contains(gerund, "1 motion of val.json, of 2 keys"), gerund);
  CHECK(contains(gerund, "'walk while wave', with the -ing form of the second verb"));
  // pairs that training lacks
  const auto unseen = [&](const std::string& training, const std::string& validation) {
    return w.run({"evaluate", "sinc", "--data", ".", "--babel", training, "--babel-validation", validation, "--part",
                  "validation", "--items", "unseen", "--samples", "1", "--statistics", "of135", "--text-encoder",
                  "words"});
  };
  const Outcome others_learnt = unseen("train.json", "val.json");
  CHECK(others_learnt.code == 0);
  CHECK_MESSAGE(contains(others_learnt.text, "2 motions of the validation part"), others_learnt.text);
  for (const Outcome& none : {unseen("same.json", "val.json"), unseen("train.json", "stand.json")}) {
    CHECK(none.code == 1);
    CHECK_MESSAGE(contains(none.text, "[motionlang.config.101] the validation part has no motions to measure"),
                  none.text);
  }
  CHECK(contains(measured("sinc", {"--samples", "1", "--items", "single"}), "4 motions of val.json"));
  CHECK(contains(measured("sinc", {"--samples", "1", "--items", "all"}), "6 motions of val.json"));

  // one after the other: 76 frames, and 29 of the second, of which the first ones may be interpolated
  const auto teach = ml::load_teach_run<B>(ml::find_run(w / "teach"), sources);
  const auto mmm = [&](const ml::SmplVelpMotion<float>& motion) {
    const Joints all = joints_of(motion);
    Joints out;
    for (std::size_t t = 0; t < motion.trans.size(); ++t) {
      for (const std::size_t j : ml::mmm_of_smplh) {
        const auto& p = all[22 * t + (j == 59 ? 7 : j == 62 ? 8 : j)];  // heels: ankles
        out.push_back({p.y, p.z, -p.x});
      }
    }
    return out;
  };
  const auto tokens = teach.text_encoder.encode<B>(std::vector<std::string>{"walk", "wave"}).tokens;
  const auto generated = [&](ml::Index window, ml::Alignment alignment) {
    const auto noise = ml::Philox{}.split(std::uint64_t{0});
    return mmm(ml::teach_motion(teach.normalizer,
                                ml::actions_to_motion(teach.model, tokens, ml::Offsets{76, 29}, noise, window), window,
                                alignment));
  };
  truth = {mmm(recorded(rows_of(clips[0], 0, 105))), mmm(recorded(rows_of(clips[1], 0, 105)))};
  const auto check_teach = [&](const std::vector<std::string>& more, ml::Index window, ml::Alignment alignment) {
    const std::string said = measured("teach", more);
    CHECK_MESSAGE(contains(said, "2 motions of val.json"), said);
    const auto motion = generated(window, alignment);
    check_row(said, "random clip", ml::temos_rifke(), {truth[1], truth[0]}, truth);
    return check_row(said, "one sample", ml::temos_rifke(), {motion, motion}, truth);
  };
  const auto full = check_teach({"--samples", "2"}, 8, ml::Alignment::full);
  const auto moved = check_teach({"--samples", "1", "--alignment", "translation"}, 8, ml::Alignment::translation);
  const auto none = check_teach({"--samples", "1", "--slerp-window", "0"}, 0, ml::Alignment::full);
  const auto same = [&](const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), close);
  };
  CHECK(!same(full, moved));
  CHECK(!same(full, none));
  const std::string of_teach = measured("teach", {"--samples", "1", "--strips", "one_after_the_other"});
  check_strips("one_after_the_other", "walk, wave");
  const auto jump = [&](const Joints& joints) {
    return ml::transition_distance(std::span<const ml::Vec3<double>>(joints), 21, 76);
  };
  CHECK(close(numbers_of_row(of_teach, "turned and moved").at(0), jump(generated(0, ml::Alignment::full))));
  CHECK(close(numbers_of_row(of_teach, "moved").at(0), jump(generated(0, ml::Alignment::translation))));
  CHECK(close(numbers_of_row(of_teach, "recorded").at(0), (jump(truth[0]) + jump(truth[1])) / 2));
  CHECK(!contains(of_teach, "independent"));

  // its baselines: both actions alone, and both as one text
  const auto noise = ml::Philox{}.split(std::uint64_t{0});
  const auto alone = [&](ml::Index window, ml::Alignment alignment) {
    auto own = noise;
    const auto eps = ml::Tensor<B, 2>::randn({2, sinc.model.config.latent_dim}, own);
    const auto states = sinc.text_encoder.encode<B>(std::vector<std::string>{"walk", "wave"}).tokens;
    const auto parts = ml::independent_actions(sinc.model, states, ml::Offsets{76, 29}, eps, window);
    return mmm(ml::teach_motion(sinc.normalizer, parts, window, alignment));
  };
  const auto sentence = sinc.text_encoder.encode<B>(std::vector<std::string>{"walk, wave"}).tokens;
  const auto together = mmm(
      ml::sinc_motion(sinc.normalizer, ml::text_to_motion(sinc.model, sentence, ml::Offsets{105}, noise).front().rows));
  const std::string beside = measured("teach", {"--samples", "1", "--independent", "sinc", "--joint", "sinc"});
  const auto independent = alone(8, ml::Alignment::full);
  const auto of_alone = check_row(beside, "independent", ml::temos_rifke(), {independent, independent}, truth);
  const auto of_both = check_row(beside, "joint", ml::temos_rifke(), {together, together}, truth);
  CHECK(!same(of_alone, of_both));
  CHECK(!same(of_alone, full));
  CHECK(numbers_of_row(beside, "one sample") == numbers_of_row(of_teach, "one sample"));
  const std::string distances = beside.substr(beside.find("transition distance"));
  CHECK(close(numbers_of_row(distances, "independent, turned and moved").at(0), jump(alone(0, ml::Alignment::full))));
  CHECK(close(numbers_of_row(distances, "independent, moved").at(0), jump(alone(0, ml::Alignment::translation))));
  CHECK(close(numbers_of_row(distances, "joint").at(0), jump(together)));
  const std::string without_past = measured("teach", {"--samples", "1", "--independent", "teach"});
  CHECK(numbers_of_row(without_past, "independent") != numbers_of_row(without_past, "one sample"));
  CHECK(!contains(without_past, "  joint "));

  const auto refused = [&](const std::string& model, const std::vector<std::string>& more, const std::string& message,
                           int code = 1) {
    const Outcome out = evaluate(model, more);
    CHECK(out.code == code);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  ml::write_file(w / "other.txt", std::string_view("walk while turn#walk/VERB while/SCONJ turn/VERB#0.0#0.0\n"));
  refused("sinc", {"--conjunction", "while", "--tags", "other.txt"},
          "[motionlang.config.103] --tags other.txt: no words of 1 sentence:\nwalk while wave");
  refused("sinc", {"--tags", "tags.txt"}, "[motionlang.config.102] --tags is for --conjunction while and during", 2);
  refused("sinc", {"--items", "unseen"}, "--items unseen needs motions to train on; --part all does not have any", 2);
  refused("teach", {"--keys", "keys.txt"}, "[motionlang.config.101] val.json has no motions to measure, of 2 keys");
  refused("sinc", {"--babel-validation", "val.json"}, "[motionlang.config.102] --part all measures all of --babel", 2);
  refused("sinc", {"--temos", "temos"},
          "--temos temos: a model of smplvelp-published at 12.5 frames per second, the motions are smplvelp-published "
          "at 30");
  refused("teach", {"--joint", "temos"}, "--joint temos: a model of smplvelp-published at 12.5 frames per second");
  refused("teach", {"--independent", "words"},
          "[motionlang.config.103] --independent words: a model of ''; expected sinc or teach, or temos as published");
  refused("teach", {"--slerp-window", "28"},
          "[motionlang.config.101] TEACH: action 1 has 29 frames; two or more must follow the gap of 28");
  ml::write_npz(w / "small.npz", body_arrays::chain(24, 4, 10));
  refused("teach", {"--body", "small.npz"},
          "small.npz: a body of 24 joints and 4 vertices; BABEL is measured on SMPL-H's 52 and 6890");
  CHECK(evaluate("teach", {"--alignment", "half"}).code == 2);
  CHECK(evaluate("sinc", {"--conjunction", "and"}).code == 2);
}

TEST_CASE("evaluate: TM2T from texts to motions as published, by the networks of Guo et al.") {
  using official::B;
  const OfficialWorkplace w;
  official::write_tm2t_runs(w.path, official::small_tm2t());
  const std::string runs = "checkpoints/t2m/";
  const auto write_evaluator = [&](const std::string& folder, ml::Index features) {
    ml::Philox rng{.seed = 41};
    const ml::GuoEvaluator<B> networks({.features = features,
                                        .movement_hidden = 6,
                                        .movement_latent = 5,
                                        .word = 4,
                                        .pos = 15,
                                        .text_hidden = 7,
                                        .motion_hidden = 6,
                                        .embedding = 8},
                                       rng);
    TorchArchive archive;
    archive.begin("text_encoder"), official::add_module(archive, networks.text_encoder), archive.end();
    archive.begin("motion_encoder"), official::add_module(archive, networks.motion_encoder), archive.end();
    archive.begin("movement_encoder"), official::add_module(archive, networks.movement_encoder), archive.end();
    archive.begin("opt_text_encoder"), official::add_zeros(archive, "moment", {3}), archive.end();
    archive.number("epoch", 10);
    official::write_bytes(w / (runs + folder + "/model/finest.tar"), archive.finish());
    return networks;
  };
  const auto networks = write_evaluator("text_mot_match", 263);
  const std::vector<std::string> said{"a walk", "person turn", "walk turn"};
  std::string captions, listed;
  for (int i = 0; i < 3; ++i) {
    const std::string id = "clip" + std::to_string(i);
    ml::write_bvh(w / (id + ".bvh"), synthetic::walk({.frames = 70, .turn = 0.4 * i}));
    captions += id + "\t0\t3\tlegs\t" + said[static_cast<std::size_t>(i)] + "\n";
    listed += id + "\n";
  }
  ml::write_file(w / "captions.tsv", captions);
  official::write_text(w / "splits/train.txt", listed);
  const auto evaluate = [&](const std::string& model, std::vector<std::string> more) {
    more.insert(more.begin(), {"evaluate", runs + model, "--data", ".", "--captions", "captions.tsv", "--splits",
                               "splits", "--part", "training", "--seeds", "1"});
    return w.run(more);
  };
  const Outcome judged = evaluate("T2M_Seq2Seq", {"--evaluator", runs + "text_mot_match"});
  REQUIRE_MESSAGE(judged.code == 0, judged.text);
  CHECK_MESSAGE(contains(judged.text,
                         "3 motions of the training part in batches of 3, drawn 1 time; diversity of 2 pairs, "
                         "multimodality of 3 texts"),
                judged.text);
  // R@1, R@2, R@3, FID, distance, diversity, multimodality
  const auto recorded = numbers_of_row(judged.text, "recorded"),
             others = numbers_of_row(judged.text, "recorded, of other texts"),
             generated = numbers_of_row(judged.text, "generated");
  REQUIRE_MESSAGE(recorded.size() == 6, judged.text);
  REQUIRE_MESSAGE(others.size() == 4, judged.text);
  REQUIRE_MESSAGE(generated.size() == 7, judged.text);
  for (const auto& row : {recorded, others, generated}) {
    CHECK(row[0] <= row[1]);
    CHECK(row[2] == 1);
  }
  // the texts in the order that the first replication draws, their motions with its noise
  ml::NumpyRandom numpy(0);
  std::vector<std::string> texts;
  for (const ml::Index i : numpy.permutation(3)) texts.push_back(said[static_cast<std::size_t>(i)]);
  const auto run = ml::load_tm2t_run<B>(ml::find_run(w / (runs + "T2M_Seq2Seq")));
  const auto motions = run.model.generate(
      run.words.encode<B>(texts),
      ml::Philox{}.split("replications").split(std::uint64_t{0}).split("one").split(std::uint64_t{0}));
  std::vector<float> rows;
  std::vector<ml::Index> frames;
  ml::Index empty = 0;
  for (ml::Index i = 0; i < 3; ++i) {
    frames.push_back(motions.offsets.length(i));
    if (frames.back() == 0) {  // counts as four frames of the mean pose
      ++empty, frames.back() = 4, rows.resize(rows.size() + 4 * 263);
      continue;
    }
    const auto own = run.model.statistics.normalize(motions[i]).to_vector();
    rows.insert(rows.end(), own.begin(), own.end());
  }
  const ml::Offsets offsets(frames);
  const auto text = networks.embed_texts(run.words.encode<B>(texts).tokens).to_vector(),
             motion =
                 networks.embed_motions({ml::Tensor<B, 2>::from(rows, {offsets.rows(), 263}), offsets}).to_vector();
  ml::MatchingMetric metric;
  metric.add(ml::Rows(text, 8), ml::Rows(motion, 8));
  CHECK(empty < 3);
  CHECK(std::abs(generated[4] - metric.matching_score()) < 1.1e-3);
  CHECK(std::abs(generated[0] - metric.r_precision(1)) < 1.1e-3);
  CHECK(std::abs(generated[4] - recorded[4]) > 2e-3);
  CHECK(generated[6] > 0);
  const Outcome file = evaluate("T2M_Seq2Seq", {"--evaluator", runs + "text_mot_match/model/finest.tar"});
  CHECK(numbers_of_row(file.text, "generated") == generated);

  const Outcome timed =
      evaluate("T2M_Seq2Seq", {"--evaluator", runs + "text_mot_match", "--repeats", "0", "--time", "5"});
  CHECK_MESSAGE(contains(timed.text, "\ngenerating 5 motions took "), timed.text);

  const auto refused = [&](const std::string& model, const std::vector<std::string>& more, const std::string& message,
                           int code = 1) {
    const Outcome out = evaluate(model, more);
    CHECK(out.code == code);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  refused("T2M_Seq2Seq", {}, "--evaluator names their finest.tar");
  const Outcome described = evaluate("M2T_EL2_DL1_NH2_PS", {"--evaluator", runs + "text_mot_match"});
  REQUIRE_MESSAGE(described.code == 0, described.text);
  CHECK_MESSAGE(contains(described.text, "     R@1     R@2     R@3  MM-Dist  BLEU-1"), described.text);
  const auto of_people = numbers_of_row(described.text, "the first text of people");
  REQUIRE_MESSAGE(of_people.size() == 10, described.text);
  CHECK(of_people[0] <= of_people[2]);
  // another program's descriptions, the same words as the texts
  for (std::size_t i = 0; i < said.size(); ++i)
    official::write_text(w / ("others/clip" + std::to_string(i) + ".txt"), said[i]);
  const Outcome beside = evaluate("M2T_EL2_DL1_NH2_PS", {"--evaluator", runs + "text_mot_match", "--made", "others"});
  REQUIRE_MESSAGE(beside.code == 0, beside.text);
  CHECK_MESSAGE(numbers_of_row(beside.text, "others") == of_people, beside.text);
  for (const std::vector<std::string>& timed_words :
       {std::vector<std::string>{"--time", "5"}, {"--time", "5", "--evaluator", runs + "text_mot_match"}})
    refused("M2T_EL2_DL1_NH2_PS", timed_words, "--time measures how a model generates the motions that --evaluator", 2);
  refused("T2M_Seq2Seq", {"--time", "5"}, "--time measures how a model generates the motions that --evaluator", 2);
  refused("M2T_EL2_DL1_NH2_PS", {"--made", ".", "--made-rate", "20"}, "--made-rate is for motions", 2);
  refused("M2T_EL2_DL1_NH2_PS", {"--made", "splits"}, "a file is needed for each of");
  refused("T2M_Seq2Seq", {"--evaluator", "splits"}, "[motionlang.io.401] --evaluator splits: no finest.tar");

  // as a model that retrieves, on motions of a TEMOS whose language model and statistics are elsewhere
  official::write_temos_run(w / "temos", official::small_temos());
  official::write_temos_statistics(w / "of64", 64);
  official::write_text(w / "words/vocab.txt", official::bert_vocabulary);
  std::vector<std::string> synthesis{"--statistics", runs + "VQVAEV3/meta",      "--synthesis", "--generator",
                                     "temos",        "--generator-text-encoder", "words"};
  refused("text_mot_match", synthesis, "no statistics of the motions");
  synthesis.insert(synthesis.end(), {"--generator-statistics", "of64"});
  const Outcome searched = evaluate("text_mot_match", synthesis);
  REQUIRE_MESSAGE(searched.code == 0, searched.text);
  CHECK_MESSAGE(contains(searched.text, "\n    generated"), searched.text);
  const Outcome nothing = evaluate("text_mot_match", {"--generator-statistics", "of64"});
  CHECK_MESSAGE((nothing.code == 2 && contains(nothing.text, "--generator")), nothing.text);
  write_evaluator("of_kit", 251);
  refused("T2M_Seq2Seq", {"--evaluator", runs + "of_kit"}, "reads features of 251 numbers, the motions have 263");
}
