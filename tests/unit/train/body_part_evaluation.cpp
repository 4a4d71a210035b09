// Labellers of body parts against people; filtered negatives.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/sinc_part_motion.hpp>
#include <motionlang/train/body_part_evaluation.hpp>
#include <motionlang/train/filtered_negatives.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

TEST_CASE("table B.1: the share of right answers of each part, without those that may be either") {
  const auto truth = ml::parse_body_part_truth(
      "walk\t1\t0.5\t0\t0\t1\t1\nwave\t0\t0\t0\t1\t0\t0\nnod\t0\t1\t0\t0\t0\t0\nunknown\t0\t0\t0\t0\t0\t0\n");
  const ml::BodyPartAnswers answers{
      {"walk", "right leg\nleft leg\ntorso"}, {"wave", "Answer: right arm"}, {"nod", "moves the left hand"}};
  const auto a = ml::part_accuracy(truth, ml::answered_parts(answers));
  CHECK(a.items == 3);                               // "unknown" has no answer
  CHECK(a.of_parts[0] == doctest::Approx(2.0 / 3));  // walk lacks the pelvis
  CHECK(a.of_parts[1] == doctest::Approx(1.0 / 2));  // walk's torso does not count; nod's is missing
  CHECK(a.of_parts[2] == doctest::Approx(2.0 / 3));  // nod got a left arm, by the lexicon
  CHECK(a.of_parts[3] == 1);
  CHECK(a.mean() == doctest::Approx((2.0 / 3 + 0.5 + 2.0 / 3 + 1 + 1 + 1) / 6));

  const auto rows = ml::labeller_accuracies(truth, nullptr, &answers);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].accuracy.items == 4);  // the lexicon answers always
  CHECK(rows[1].accuracy.mean() == a.mean());
  CHECK(ml::labellers_table(truth, std::span(rows).last(1)) ==
        "4 labels\n"
        "                                     global      torso   left arm  right arm   left leg  rig"
        "ht leg    mean   items\n"
        "  answers                              0.67       0.50       0.67       1.00       1.00       1.00    0.81    "
        "   3\n");
}

TEST_CASE("velocities: the legs of a walk move fastest against the pelvis that they carry") {
  const auto truth = ml::parse_body_part_truth("walk\t0\t0\t0\t0\t1\t1\n");
  const auto& f = ml::motion_features("smplvelp");
  const auto rows = f.from_motion(synthetic::walk({.frames = 60, .fps = 30}));
  const ml::DescribedMotion walk{"seg-1-0", "1", {rows.begin(), rows.end()}, {{"walk", {0, 60}}}},
      other{"seg-2-0", "2", {rows.begin(), rows.end()}, {{"run", {0, 60}}}};
  const auto a = ml::velocity_part_accuracy(truth, {walk, other}, "smplvelp");
  CHECK(a.items == 1);
  const auto all_rows = std::vector<double>(walk.rows.begin(), walk.rows.end());
  const auto joints = f.joints_of(all_rows);
  std::vector<ml::Vec3<double>> first;
  const auto count = static_cast<std::size_t>(f.joints);
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (i % count < 22) first.push_back(joints[i]);
  const auto parts = ml::moving_sinc_parts(ml::sinc_part_speeds(std::span<const ml::Vec3<double>>(first)));
  for (std::size_t p = 0; p < 6; ++p) CHECK(a.of_parts[p] == (parts[p] == (p >= 4) ? 1 : 0));
}

TEST_CASE("filtered negatives: the share of a batch, and similar pairs of a list") {
  ml::EmbeddingCache sentences(2);
  const std::vector<float> right{1, 0}, nearly{0.96f, 0.28f}, up{0, 1};
  sentences.add("walk", right), sentences.add("a walk", nearly), sentences.add("sit", up);
  std::vector<ml::DescribedMotion> motions;
  for (const char* text : {"walk", "a walk", "sit", "walk"})
    motions.push_back({std::to_string(motions.size()), "c", {}, {{text, {}}}});
  // of six pairs, walk with walk and twice walk with "a walk" (0.96 > 0.6)
  CHECK(ml::filtered_negatives<B>(motions, sentences, 0.8, 4) == doctest::Approx(100.0 * 3 / 6));
  CHECK(ml::filtered_negatives<B>(motions, sentences, 0.99, 4) == doctest::Approx(100.0 * 1 / 6));
  CHECK_ERROR(ml::filtered_negatives<B>(motions, sentences, 0.8, 1), "[motionlang.numeric.302]");
  ml::FilteredShares table{.thresholds = {0.8, 0.99}, .batches = {4}, .by_threshold = {50, 16.666}, .by_batch = {50}};
  CHECK(ml::filtered_negatives_table(table) ==
        "negatives that training leaves out, %\n"
        "  threshold            0.80    0.99\n"
        "  batches of 32       50.00   16.67\n"
        "  batch                   4\n"
        "  threshold 0.8       50.00\n");
  const auto shares = ml::filtered_shares<B>(motions, sentences);
  CHECK(shares.by_threshold[5] == ml::filtered_negatives<B>(motions, sentences, 0.8, 32));
  CHECK(shares.by_batch == std::vector<double>(4, shares.by_threshold[5]));
  const std::vector<float> all{1, 0, 0.96f, 0.28f, 0, 1};
  const auto pairs = ml::similar_pairs(ml::Rows(std::span<const float>(all), 2), 0.95);
  CHECK(pairs.all == 3);
  CHECK(pairs.similar == 1);
  CHECK(pairs.percent() == doctest::Approx(100.0 / 3));
}
