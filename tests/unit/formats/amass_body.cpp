// AMASS sequences on bodies: what the model itself makes of their numbers, and what a body does not have.
#include <motionlang/backend/reference.hpp>
#include <motionlang/formats/amass_body.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/geometry/so3.hpp>

#include "../../support/check_error.hpp"
#include "../../support/octahedra_body.hpp"
#include "../../support/synthetic_body.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::ReferenceBackend<double>;
using Names = std::vector<std::string>;

namespace {

constexpr Index frames = 2;

ml::Body<B> body_of(ml::BodyKind kind) {
  const TemporaryFolder folder;
  ml::write_npz(folder / "body.npz", octahedra::arrays(kind));
  return ml::read_body<B>(folder / "body.npz", {.betas = 1});
}
ml::AmassSequence sequence_of(Index columns) {
  return {.frames = frames,
          .columns = columns,
          .poses = synthetic::wave(2, static_cast<int>(frames * columns)),
          .trans = {1, 2, 3, -0.5, 0, 0.9},
          .betas = {0.7},
          .gender = "female",
          .fps = 120};
}

}  // namespace

TEST_CASE("the vertices are those of the model, turned to Y up") {
  for (const ml::BodyKind kind : {ml::BodyKind::smpl, ml::BodyKind::smplh, ml::BodyKind::smplx}) {
    CAPTURE(to_string(kind));
    const auto body = body_of(kind);
    const Index joints = body.model.joints();
    const auto sequence = sequence_of(3 * joints);
    const auto clip = ml::amass_on_body(sequence, "clip", body);
    CHECK(clip.motion.name == "clip");
    CHECK(clip.motion.fps == 120);
    CHECK(clip.betas == std::vector<double>{0.7});
    CHECK(clip.left_out.empty());
    const auto expected = body.model(ml::Tensor<B, 2>::full({frames, 1}, 0.7),
                                     ml::rotation_rows(ml::Tensor<B, 3>::from(sequence.poses, {frames, joints, 3})),
                                     ml::Tensor<B, 2>::from(sequence.trans, {frames, 3}));
    // as it is written: put on the body once more, of the shape that it has already
    const auto again = ml::motion_on_body(body, clip.motion, std::span<const double>(clip.betas));
    const auto posed = ml::pose_body(body.model, again, std::span<const double>(clip.betas));
    const auto a = expected.vertices.span(), b = posed.vertices.span();
    REQUIRE(a.size() == b.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); i += 3)
      worst = std::max(worst,
                       norm(ml::z_up_to_y_up({a[i], a[i + 1], a[i + 2]}) - ml::Vec3<double>{b[i], b[i + 1], b[i + 2]}));
    CHECK(worst < 1e-9);
  }
}

TEST_CASE("parts are found by their joints, and what a body does not have is reported") {
  const auto smplh = sequence_of(156), smplx = sequence_of(165);
  const auto on_x = ml::amass_on_body(smplh, "h", body_of(ml::BodyKind::smplx));
  CHECK(on_x.parts == Names{"left hand", "right hand"});
  CHECK(on_x.left_out.empty());
  CHECK(on_x.betas == std::vector<double>{0});  // SMPL-X has shapes of its own
  CHECK(ml::distance(on_x.motion.rotations(1)[25], ml::detail::amass_rotation(smplh, 1, 22)) < 1e-12);
  CHECK(ml::distance(on_x.motion.rotations(1)[54], ml::detail::amass_rotation(smplh, 1, 51)) < 1e-12);
  CHECK(on_x.motion.rotations(1)[22] == ml::Quaternion<double>::identity());  // the jaw
  const auto on_h = ml::amass_on_body(smplx, "x", body_of(ml::BodyKind::smplh));
  CHECK(on_h.parts == Names{"left hand", "right hand"});
  CHECK(on_h.left_out == Names{"jaw and eyes"});
  CHECK(on_h.betas == std::vector<double>{0});
  CHECK(ml::distance(on_h.motion.rotations(0)[37], ml::detail::amass_rotation(smplx, 0, 40)) < 1e-12);
  const auto on_smpl = ml::amass_on_body(smplh, "h", body_of(ml::BodyKind::smpl));
  CHECK(on_smpl.parts.empty());
  CHECK(on_smpl.betas == std::vector<double>{0.7});
  CHECK(on_smpl.left_out == Names{"left hand", "right hand"});
  CHECK(ml::amass_on_body(sequence_of(72), "s", body_of(ml::BodyKind::smplh)).left_out == Names{"hands"});
  CHECK(ml::amass_on_body(sequence_of(66), "b", body_of(ml::BodyKind::smplh)).left_out.empty());
  CHECK(ml::amass_on_body(sequence_of(69), "o", body_of(ml::BodyKind::smplh)).left_out ==
        Names{"joints after the 22nd"});
}

TEST_CASE("a hand of zeros is none: it keeps the mean pose of the body's") {
  auto body = body_of(ml::BodyKind::smplh);
  const auto mean = synthetic::wave(3, 45);
  body.left_hand = body.right_hand =
      ml::HandPoses<B>{ml::Tensor<B, 2>::zeros({1, 45}), ml::Tensor<B, 1>::from(mean, {45})};
  auto sequence = sequence_of(156);
  for (Index f = 0; f < frames; ++f) std::fill_n(sequence.poses.begin() + f * 156 + 66, 45, 0.0);
  const auto clip = ml::amass_on_body(sequence, "a", body);
  CHECK(clip.parts == Names{"right hand"});
  CHECK(ml::distance(clip.motion.rotations(1)[23], ml::AxisAngle<double>{{mean[3], mean[4], mean[5]}}) < 1e-12);
  CHECK(ml::distance(clip.motion.rotations(1)[38], ml::detail::amass_rotation(sequence, 1, 38)) < 1e-12);
}

TEST_CASE("betas: as many as both have; what is refused") {
  const auto body = body_of(ml::BodyKind::smplh);
  auto sequence = sequence_of(156);
  sequence.betas = {0.3, 5, 6};
  CHECK(ml::amass_on_body(sequence, "a", body).betas == std::vector<double>{0.3});
  sequence.betas.clear();
  CHECK(ml::amass_on_body(sequence, "a", body).betas == std::vector<double>{0});
  sequence.poses[155] = std::nan("");
  CHECK_ERROR(ml::amass_on_body(sequence, "a", body), "'right_thumb3' in frame 0 is not finite");
  ml::Body<B> other;
  other.model = synthetic::body<B>();
  CHECK_ERROR(ml::amass_on_body(sequence, "a", other),
              "[motionlang.config.106] amass_on_body: a body of 4 joints is not one of SMPL");
}
