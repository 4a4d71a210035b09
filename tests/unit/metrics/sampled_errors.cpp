// Errors of several motions for each text, and of motions that know no text.
#include <doctest/doctest.h>

#include <motionlang/metrics/sampled_errors.hpp>

namespace ml = motionlang;

namespace {

// The root of 22 joints is `away` metres to the side of where it should be; Z up.
ml::JointFrames standing(double away, int frames = 4) {
  ml::JointFrames out;
  for (int t = 0; t < frames; ++t) {
    for (int j = 0; j < 22; ++j) out.push_back({0.1 * (j % 3), 0.05 * (j % 5), 1 + 0.01 * j + away * (t % 2)});
  }
  return out;
}

}  // namespace

TEST_CASE("the first, the mean, the best and the worst motion of each text") {
  const ml::JointErrors none(ml::sinc_rifke());
  ml::SampledErrors errors(none, 3);
  const auto truth = standing(0);
  errors.add({standing(0.2), standing(0), standing(0.4)}, truth);
  const auto first = errors.first().ape.mean_joints(), mean = errors.mean().ape.mean_joints(),
             best = errors.best().ape.mean_joints(), worst = errors.worst().ape.mean_joints();
  CHECK(best == 0);
  CHECK(first > 0);
  CHECK(worst > first);
  CHECK(mean == doctest::Approx((first + best + worst) / 3));
  CHECK(errors.best_of(1).ape.root == errors.first().ape.root);
  CHECK(errors.best_of(1).ape.root > 0);
  CHECK(errors.best_of(2).ape.root == 0);  // the second motion is the true one
  CHECK(errors.best_of(3).ape.root == 0);
  const std::string table = ml::best_of_table(errors);
  CHECK(table.find("  samples  ") == 0);
  CHECK(table.find("          1          2          3\n") != table.npos);
  CHECK(table.substr(table.size() - 23) == "     0.0000     0.0000\n");
  const auto rows = ml::named_errors(errors);
  REQUIRE(rows.size() == 4);
  CHECK(rows[0].name == "one sample");
  CHECK(rows[1].name == "mean of 3 samples");
  CHECK(rows[2].name == "best of 3 samples");
  CHECK(rows[3].name == "worst of 3 samples");
  CHECK(rows[0].errors.ape.mean_joints() == first);
  CHECK(rows[3].errors.ape.mean_joints() == worst);

  ml::SampledErrors one(none, 1);
  one.add({standing(0.2)}, truth);
  CHECK(ml::named_errors(one).size() == 1);
}

TEST_CASE("another motion than its own is drawn, if there is one") {
  const ml::JointErrors none(ml::sinc_rifke());
  const std::vector<ml::JointFrames> training{standing(0), standing(0.3)};
  const auto of = [&](ml::Index i) { return training[static_cast<std::size_t>(i)]; };
  ml::BlindErrors blind(ml::sinc_rifke(), none, 2, of, 7), alone(ml::sinc_rifke(), none, 1, of, 7);
  for (int k = 0; k < 8; ++k) blind.add(training[0], 0);
  alone.add(training[0], 0);
  CHECK(blind.random_clip().ape.mean_joints() > 0);
  CHECK(alone.random_clip().ape.mean_joints() == 0);
  const auto rows = ml::named_errors(blind);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].name == "mean pose");
  CHECK(rows[1].name == "random clip");
  CHECK(rows[1].errors.ape.mean_joints() == blind.random_clip().ape.mean_joints());
}

TEST_CASE("a table of errors has a line for each row, in metres") {
  ml::ApeAve errors;
  errors.ape.root = 0.5, errors.ape.trajectory = 0.25, errors.ape.local = {1, 2}, errors.ape.joints = {0.125, 0.375};
  errors.ave.root = 0.0625;
  const std::vector<ml::NamedErrors> rows{{"one sample", errors}};
  const std::string table = ml::errors_table(rows), header = ml::errors_table({});
  CHECK(header.find("APE (m)") < header.find("AVE (m^2)"));
  REQUIRE(table.starts_with(header));
  CHECK(table.substr(header.size()) ==
        "  one sample                 0.500   0.250   1.500   0.250     0.062   0.000   0.000   0.000\n");
}
