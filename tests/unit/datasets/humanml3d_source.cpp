// Raw AMASS to the joints that HumanML3D begins with: which frames, which axes, whose body.
#include <doctest/doctest.h>

#include <numbers>

#include <motionlang/backend/reference.hpp>
#include <motionlang/datasets/humanml3d_source.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using Frames = std::vector<ml::Index>;
using B = ml::ReferenceBackend<double>;

namespace {

ml::HumanMl3dSource row(std::string path, ml::Index start, ml::Index end) {
  return {std::move(path), start, end, "000000.npy"};
}

/// J joints a frame, joint j of frame f at (f, j, 7).
auto grid(std::size_t joints) {
  return [joints](std::span<const ml::Index> frames) {
    std::vector<ml::Vec3<double>> out;
    for (const ml::Index f : frames) {
      for (std::size_t j = 0; j < joints; ++j) out.push_back({static_cast<double>(f), static_cast<double>(j), 7});
    }
    return out;
  };
}

}  // namespace

TEST_CASE("humanml3d source: frames are picked, leads dropped, and then the index counts") {
  CHECK(ml::humanml3d_source_frames(row("KIT/3/a_poses.npy", 0, -1), 9, 100, {.keep_last_frame = true}) ==
        Frames{0, 5});
  CHECK(ml::humanml3d_source_frames(row("KIT/3/a_poses.npy", 1, 3), 30, 120) == Frames{6, 12});
  CHECK(ml::humanml3d_source_frames(row("KIT/3/a_poses.npy", 1, 99), 30, 120) == Frames{6, 12, 18, 24});  // a slice
  CHECK(ml::humanml3d_source_frames(row("KIT/3/a_poses.npy", 7, 99), 30, 120).empty());
  CHECK(ml::humanml3d_source_frames(row("a", 0, 99), 30, 59).size() == 15);  // every second: 29.5 per second, not 20
  CHECK(ml::humanml3d_source_frames(row("a", 0, -1), 4, 20) == Frames{0, 1, 2});  // as published: [0:-1]
  CHECK(ml::humanml3d_source_frames(row("a", 0, -1), 4, 20, {.keep_last_frame = true}) == Frames{0, 1, 2, 3});
  CHECK(ml::humanml3d_source_frames(row("a", 0, -1), 0, 20).empty());

  const std::pair<const char*, ml::Index> leads[] = {{"Eyes_Japan_Dataset", 60}, {"MPI_HDM05", 60},
                                                     {"TotalCapture", 20},       {"MPI_Limits", 20},
                                                     {"Transitions_mocap", 10},  {"CMU", 0}};
  for (const auto& [data_set, lead] : leads) {
    const std::string path = "./pose_data/" + std::string(data_set) + "/s/a_poses.npy";
    CHECK(ml::humanml3d_lead(path) == lead);
    CHECK(ml::humanml3d_source_frames(row(path, 1, 3), 200, 40) == Frames{2 * lead + 2, 2 * lead + 4});
    CHECK(ml::humanml3d_source_frames(row(path, 0, -1), 2 * lead, 40).empty());
  }
}

TEST_CASE("humanml3d source: joints turn upright, HumanAct12 stays") {
  const auto joints = ml::humanml3d_source_joints<double>(row("CMU/a.npy", 1, 3), 9, 40, grid(52));
  REQUIRE(joints.size() == 2 * 22);
  CHECK(joints[0] == ml::Vec3<double>{-2, 7, 0});         // (x, y, z) -> (-x, z, y), frame 2
  CHECK(joints[22 + 21] == ml::Vec3<double>{-4, 7, 21});  // the 22nd joint of frame 4, no finger
  const auto act = ml::humanml3d_source_joints<double>(row("pose_data/humanact12/a.npy", 1, 2), 3, 20, grid(24));
  REQUIRE(act.size() == 3 * 22);  // the index is not applied
  CHECK(act[22] == ml::Vec3<double>{1, 0, 7});
  CHECK(ml::humanml3d_uses_male_body("male"));
  CHECK_FALSE(ml::humanml3d_uses_male_body("neutral"));
}

TEST_CASE("humanml3d source: what is refused") {
  CHECK_ERROR(ml::humanml3d_source_frames(row("a", 0, -1), 9, 15), "[motionlang.config.101] every_nth_frame");
  CHECK_ERROR(ml::humanml3d_source_frames(row("a", -1, 5), 9, 20),
              "[motionlang.config.101] humanml3d_source_frames: '000000.npy' from frame -1 to 5");
  CHECK_ERROR(ml::humanml3d_source_frames(row("a", 0, -2), 9, 20), "[motionlang.config.101]");
  CHECK_ERROR(ml::humanml3d_source_joints<double>(row("a", 0, -1), 3, 20, grid(21)),
              "[motionlang.shape.205] humanml3d_source_joints: 42 joints for 2 frames");
  CHECK(ml::humanml3d_source_joints<double>(row("a", 5, -1), 2, 20, grid(21)).empty());
}

TEST_CASE("posed_joints: a body model poses the frames of a sequence that are asked for") {
  // Two joints, the second 1 above the first; one vertex at each; the shape coefficient stretches the bone.
  ml::BodyModel<B> body;
  body.v_template = ml::Tensor<B, 2>::from({0, 0, 0, 0, 1, 0}, {2, 3});
  body.shapedirs = ml::Tensor<B, 2>::from({0, 0, 0, 0, 1, 0}, {6, 1});
  body.posedirs = ml::Tensor<B, 2>::zeros({6, 9});
  body.J_regressor = body.weights = ml::Tensor<B, 2>::from({1, 0, 0, 1}, {2, 2});
  body.parents = {-1, 0};

  ml::AmassSequence sequence{.frames = 3, .columns = 6};
  const double quarter = std::numbers::pi / 2;
  sequence.poses = {0, 0, 0, 0, 0, 0, /**/ 9, 9, 9, 9, 9, 9, /**/ 0, 0, quarter, 1, 2, 3};
  sequence.trans = {1, 2, 3, 9, 9, 9, 4, 5, 6};
  sequence.betas = {0.5, 9, 9};
  const std::vector<ml::Index> frames{2, 0};
  const auto joints = ml::posed_joints(body, sequence, frames);
  const ml::Vec3<double> want[] = {{4, 5, 6}, {4 - 1.5, 5, 6}, {1, 2, 3}, {1, 2 + 1.5, 3}};
  REQUIRE(joints.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK(ml::norm(joints[i] - want[i]) < 1e-12);

  const std::vector<ml::Index> beyond{3};
  CHECK_ERROR(ml::posed_joints(body, sequence, beyond), "[motionlang.shape.203] posed_joints: frame 3 of 3");
  sequence.betas.clear();
  CHECK_ERROR(ml::posed_joints(body, sequence, frames),
              "[motionlang.shape.205] posed_joints: 6 pose values and 0 shape");
}
