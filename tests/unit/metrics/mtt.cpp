// STMC's metrics on motions and latents whose figures are known.
#include <motionlang/metrics/mtt.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"

namespace ml = motionlang;
using doctest::Approx;
using ml::Index;
using Joints = std::vector<ml::Vec3<double>>;
using Points = std::vector<Index>;

namespace {

/// Features of `frames` rows: the root 1 m high, going ahead by `speed` a frame and turning; nothing else.
std::vector<double> going(Index frames, double speed) {
  std::vector<double> out(static_cast<std::size_t>(frames * 263), 0);
  for (std::size_t at = 0; at < out.size(); at += 263) out[at] = 0.1, out[at + 2] = speed, out[at + 3] = 1;
  return out;
}
ml::Timeline timeline(const std::vector<std::pair<Index, Index>>& times) {
  ml::Timeline out;
  for (const auto& [start, end] : times) out.intervals.push_back({"", start, end, {}});
  return out;
}
const auto one_number = [](const ml::Rows<double>& rows) {
  return std::vector<double>{static_cast<double>(rows.size()), rows[0][2]};
};

}  // namespace

TEST_CASE("transition_points: as coded the last one is lost") {
  using enum ml::MttFlavour;
  const auto t = timeline({{0, 60}, {60, 100}, {20, 80}});
  CHECK(ml::transition_points(t, 99, as_written) == Points{20, 60, 80});
  CHECK(ml::transition_points(t, 99, as_coded) == Points{20, 60});
  CHECK(ml::transition_points(t, 101, as_coded) == Points{20, 60, 80});
  CHECK(ml::transition_points(timeline({{0, 60}}), 59, as_coded).empty());
  CHECK(ml::transition_points({}, 59, as_written).empty());
  CHECK(ml::quarter_points(79) == std::array<Index, 3>{19, 39, 59});
}

TEST_CASE("mtt_local_joints: turns are left out, the root goes ahead") {
  const auto features = going(5, 0.3);
  const auto joints = ml::mtt_local_joints(lists::view(features));
  REQUIRE(joints.size() == 5 * 22);
  CHECK(norm(joints[4 * 22] - ml::Vec3<double>{0, -1.2, 1}) == Approx(0));  // Z up, ahead is -Y
  CHECK_ERROR(ml::mtt_local_joints(lists::view(std::vector<double>(100))), "[motionlang.shape.205]");
}

TEST_CASE("mtt_transitions: what the root does is taken off, or as coded each joint's own x") {
  // Joint 0 goes along y by 1, joint 1 along x and y by 1.
  const Joints two{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 1, 1}};
  const Points at{1, 0, 2};  // only frame 1 has one before
  CHECK(ml::mtt_transitions(lists::view(two), at, ml::MttOrigin::root, 2) == std::vector<double>{0.5});
  // (0, 1, 0) and (0, 0, -1): 1 each.
  CHECK(ml::mtt_transitions(lists::view(two), at, ml::MttOrigin::own_x, 2)[0] == Approx(1));
  CHECK_ERROR(ml::mtt_transitions(lists::view(two), at, ml::MttOrigin::root, 3), "[motionlang.shape.205]");
}

TEST_CASE("crops: fixed starts as coded, anywhere as written") {
  CHECK(ml::fixed_crop_starts() == Points{47, 117, 67, 103, 9});
  CHECK(ml::crop_frames(117, 160) == 43);
  CHECK(ml::crop_frames(117, 300) == 100);
  CHECK(ml::crop_frames(117, 100) == 0);
  ml::NumpyRandom rng(0);
  for (int i = 0; i < 20; ++i) {
    for (const Index start : ml::random_crop_starts(102, rng)) CHECK(ml::crop_frames(start, 102) == 100);
  }
  CHECK(ml::random_crop_starts(30, rng) == Points(5, 0));
}

TEST_CASE("mtt_semantics: places of the right text, scores from 0 to 1") {
  const std::vector<double> texts{1, 0, 0, 1, -1, 0, 0, -1}, latents{2, 0.1, 1, 0.5, -1, -2};
  const ml::Rows t(texts, 2), z(latents, 2);
  const auto s = ml::mtt_semantics(z, Points{0, 1, 0}, t, t);  // 1st, 2nd and 3rd place
  CHECK(s.r1 == Approx(1.0 / 3));
  CHECK(s.r3 == 1);
  CHECK(s.m2t == s.m2m);
  const auto own = ml::detail::own_semantics(t, t);
  CHECK(own.r1 == 1);
  CHECK(own.m2t == Approx(1));
  CHECK_ERROR(ml::mtt_semantics(z, Points{0, 1}, t, t), "[motionlang.shape.204]");
  CHECK_ERROR(ml::mtt_semantics(z, Points{0, 1, 4}, t, t), "[motionlang.shape.203]");
  CHECK_ERROR(ml::mtt_semantics(z.slice(0, 0), Points{}, t, t), "[motionlang.numeric.302]");
}

TEST_CASE("mtt_scores: crops go to the encoder as the timeline has them") {
  const std::vector<ml::MttMotion<double>> motions{{timeline({{0, 60}, {60, 151}}), {0, 1}, going(150, 0.3)},
                                                   {timeline({{0, 80}, {20, 121}}), {1, 0}, going(120, 0.2)}};
  const std::span<const ml::MttMotion<double>> all = motions;
  const ml::MttReference<double> reference{{60, 0.3, 90, -5}, {60, 0.3, 80, -9}, {going(20, 0.1), going(30, 0.1)}, 2};
  Points lengths;
  auto encode = [&](const ml::Rows<double>& rows) {
    lengths.push_back(rows.size());
    return one_number(rows);
  };
  const auto s = ml::mtt_scores(all, reference, encode);
  // Two intervals and five crops; of a motion of 120 rows, the crops at 117 and 103 are short.
  CHECK(lengths == Points{60, 90, 100, 33, 83, 47, 100, 80, 100, 73, 3, 53, 17, 100});
  // As coded the way of the root counts, and of the cuts 60; 20, 80 only the 20 of the slower motion does.
  CHECK(s.transition == Approx(0.2));
  CHECK(ml::mtt_scores(all, reference, encode, {.flavour = ml::MttFlavour::as_written}).transition == Approx(0));
  lengths.clear();
  ml::mtt_scores(all, reference, encode, {.one_text = true});
  CHECK(lengths[0] == 150);
  CHECK(lengths[1] == 150);
  CHECK(ml::mtt_ground_truth(reference).transition == Approx(0));
  CHECK(ml::mtt_ground_truth(reference).r1 == 1);

  CHECK_ERROR(ml::mtt_scores(all.first(0), reference, encode), "[motionlang.numeric.302]");
  auto late = motions;
  late[0].timeline.intervals[1].start = 155;
  CHECK_ERROR(ml::mtt_scores(std::span<const ml::MttMotion<double>>(late), reference, encode),
              "[motionlang.shape.203]");
}

TEST_CASE("mtt_scores: without recorded motions M2M and FID are not numbers, and the others the same") {
  const std::vector<ml::MttMotion<double>> motions{
      {timeline({{0, 60}, {60, 151}, {20, 80}}), {0, 1, 1}, going(150, 0.3)}};
  const std::span<const ml::MttMotion<double>> all = motions;
  const ml::MttReference<double> recorded{{60, 0.3, 90, -5}, {60, 0.3, 80, -9}, {going(20, 0.1), going(30, 0.1)}, 2};
  ml::MttReference<double> none = recorded;
  none.motion_latents.clear(), none.features.clear();
  const auto with = ml::mtt_scores(all, recorded, one_number), without = ml::mtt_scores(all, none, one_number);
  CHECK((std::isnan(without.m2m) && std::isnan(without.fid)));
  CHECK((!std::isnan(with.m2m) && !std::isnan(with.fid)));
  CHECK((with.r1 == without.r1 && with.r3 == without.r3 && with.m2t == without.m2t));
  CHECK(with.transition == without.transition);
  const std::vector<ml::MttMotion<double>> no_points{{timeline({{0, 60}, {60, 151}}), {0, 1}, going(150, 0.3)}};
  const std::span<const ml::MttMotion<double>> few = no_points;
  CHECK(std::isnan(ml::mtt_scores(few, none, one_number).transition));  // as coded the last one is lost
  CHECK_FALSE(std::isnan(ml::mtt_scores(few, none, one_number, {.flavour = ml::MttFlavour::as_written}).transition));
}

TEST_CASE("mtt_features: of all joints that the skeleton has, Z up or Y up") {
  const auto& skeleton = ml::humanml3d_chains();
  const auto rest = ml::chain_offsets<double>(skeleton, std::span<const double>(skeleton.lengths));
  Joints y_up, z_up;  // stands, then goes ahead, turning its left arm (16, 18, 20)
  for (int t = 0; t < 5; ++t) {
    Joints pose(22);
    for (const auto& bone : skeleton.bones()) {
      const bool arm = bone.joint == 18 || bone.joint == 20;
      const auto lengthwise = ml::Vec3<double>{0.1 * t, -1, 0.05 * t};
      pose[bone.joint] =
          pose[bone.parent] + (arm ? (skeleton.lengths[bone.joint] / norm(lengthwise)) * lengthwise : rest[bone.joint]);
    }
    for (const auto& p : pose) {
      y_up.push_back({p.x, p.y + 1, p.z + 0.1 * t});
      z_up.push_back({p.x, -p.z - 0.1 * t, p.y + 1});
    }
    z_up.insert(z_up.end(), 2, {});  // hands, which HumanML3D does not have
  }
  const auto features = ml::mtt_features(skeleton, lists::view(y_up), 22, false);
  CHECK(features.size() == 4 * 263);
  CHECK(lists::largest_difference(features, ml::mtt_features(skeleton, lists::view(z_up), 24)) < 1e-12);
  CHECK(features[2] == Approx(0.1));  // ahead

  const Joints half(30);
  CHECK_ERROR(ml::mtt_features(ml::humanml3d_chains(), lists::view(half), 24), "[motionlang.shape.205]");
  CHECK_ERROR(ml::mtt_features(ml::humanml3d_chains(), lists::view(half), 15), "[motionlang.shape.205]");
}
