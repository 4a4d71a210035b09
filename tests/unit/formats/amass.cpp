// AMASS files: round trip, both spellings and layouts, the turn to Z up, and files that must be refused.
#include <doctest/doctest.h>

#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include <motionlang/features/amass_sequence.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/amass_sequence.hpp>
#include <motionlang/geometry/so3.hpp>

#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

ml::NpyArray matrix(ml::Index rows, ml::Index columns, double value = 0) {
  const std::vector<double> values(static_cast<std::size_t>(rows * columns), value);
  return ml::NpyArray::of(std::span<const double>(values), {rows, columns});
}

}  // namespace

TEST_CASE("a motion comes back") {
  const TemporaryFolder folder;
  for (const int frames : {1, 40}) {
    const ml::Motion motion = synthetic::walk({.frames = frames, .fps = 30, .turn = 1.0});
    ml::write_amass(folder / "clip.npz", motion, {.gender = "female", .betas = {1, 2}}, {0.0, -0.22, 0.03});
    const ml::AmassClip clip = ml::read_amass(folder / "clip.npz", {0.0, -0.22, 0.03});
    CHECK(clip.motion.name == "clip");
    CHECK(clip.motion.fps == 30);
    CHECK(clip.motion.skeleton == ml::smpl24_skeleton());
    CHECK(clip.body.gender == "female");
    CHECK(clip.body.betas == std::vector<double>{1, 2});
    CHECK(synthetic::largest_distance(motion, clip.motion) < 1e-12);
  }
}

TEST_CASE("the file is Z up, with zero fingers and the pelvis offset taken off") {
  const TemporaryFolder folder;
  ml::Motion motion{ml::humanml3d22_skeleton(), 20, {{1, 2, 3}}, {}, ""};
  motion.local.assign(22, ml::Quaternion<double>::identity());
  ml::write_amass(folder / "a.npz", motion, {}, {0.25, 0.5, 0});
  const auto npz = ml::NpzArchive::open(folder / "a.npz");
  CHECK(npz.read("trans").to<double>() == std::vector<double>{0.75, -3.5, 2});
  const auto poses = npz.read("poses");
  CHECK(poses.shape == std::vector<ml::Index>{1, 156});
  std::vector<double> expected(156, 0.0);
  expected[0] = std::numbers::pi / 2;  // upright in a Z up world: the root is turned by +90 degrees about x
  const auto values = poses.to<double>();
  for (std::size_t i = 0; i < 156; ++i) CHECK(values[i] == doctest::Approx(expected[i]));
  CHECK(npz.read("betas").to<double>() == std::vector<double>(16, 0.0));
  CHECK(npz.read("gender").text() == "neutral");
  CHECK(npz.read("mocap_framerate").value<double>() == 20);
  CHECK(npz.read("mocap_frame_rate").value<double>() == 20);
}

TEST_CASE("layouts of SMPL, SMPL-H and SMPL-X; optional arrays") {
  const TemporaryFolder folder;
  for (const ml::Index columns : {66, 72, 156, 165}) {
    ml::write_npz(folder / "x.npz", std::vector<ml::NamedArray>{{"poses", matrix(3, columns)},
                                                                {"trans", matrix(3, 3, 2)},
                                                                {"mocap_frame_rate", ml::NpyArray::scalar(120.0)}});
    const auto clip = ml::read_amass(folder / "x.npz");
    CHECK(clip.motion.frames() == 3);
    CHECK(clip.motion.fps == 120);
    CHECK(clip.body.gender == "neutral");
    CHECK(clip.motion.root_at(2) == ml::Vec3{2.0, 2.0, -2.0});
    CHECK(ml::distance(clip.motion.rotations(0)[0], ml::AxisAngle<double>{{-std::numbers::pi / 2, 0, 0}}) < 1e-12);
  }
}

TEST_CASE("files and skeletons that are refused") {
  const TemporaryFolder folder;
  auto refused = [&](std::vector<ml::NamedArray> arrays, const char* id) {
    ml::write_npz(folder / "bad.npz", arrays);
    CHECK_THROWS_WITH_AS(ml::read_amass(folder / "bad.npz"), doctest::Contains(id), ml::error);
  };
  const ml::NamedArray fps{"mocap_framerate", ml::NpyArray::scalar(60.0)};
  refused({{"trans", matrix(3, 3)}, fps}, "406");
  refused({{"poses", matrix(3, 156)}, {"trans", matrix(3, 3)}}, "406");
  refused({{"poses", matrix(3, 65)}, {"trans", matrix(3, 3)}, fps}, "407");
  refused({{"poses", matrix(3, 156)}, {"trans", matrix(2, 3)}, fps}, "407");
  refused({{"poses", ml::NpyArray::scalar(1.0)}, {"trans", matrix(2, 3)}, fps}, "407");
  refused({{"poses", ml::NpyArray::text("none")}, {"trans", matrix(2, 3)}, fps}, "407");
  refused({{"poses", matrix(3, 156)}, {"trans", matrix(3, 3)}, {"mocap_framerate", ml::NpyArray::scalar(0.0)}}, "403");
  refused({{"poses", matrix(3, 156)}, {"trans", matrix(3, 3, std::nan(""))}, fps}, "301");
  refused({{"poses", matrix(3, 156)}, {"trans", matrix(3, 3)}, {"betas", matrix(1, 10, std::nan(""))}, fps},
          "bad.npz: number 0 of 'betas' is nan");

  ml::Motion kit{ml::kit21_skeleton(), 20, {{0, 0, 0}}, {}, ""};
  kit.local.assign(21, ml::Quaternion<double>::identity());
  CHECK_THROWS_WITH_AS(ml::write_amass(folder / "kit.npz", kit), doctest::Contains("106"), ml::config_error);
  CHECK_FALSE(std::filesystem::exists(folder / "kit.npz"));
  CHECK_THROWS_WITH_AS(ml::write_amass(folder / "kit.npz", synthetic::walk({.frames = 2}), {.betas = {0, INFINITY}}),
                       doctest::Contains("[motionlang.numeric.301] "), ml::numeric_error);
  CHECK_FALSE(std::filesystem::exists(folder / "kit.npz"));
}

TEST_CASE("joint positions") {
  const TemporaryFolder folder;
  const ml::Motion motion = synthetic::walk({.frames = 5});
  ml::write_joints_npy(folder / "joints.npy", motion);
  const auto array = ml::read_npy(folder / "joints.npy");
  CHECK(array.type() == "<f4");
  CHECK(array.shape == std::vector<ml::Index>{5, 24, 3});
  CHECK(array.to<float>()[2] == static_cast<float>(motion.root_at(0).y));  // Z up
  const auto back = ml::read_joints_npy(folder / "joints.npy");
  const auto expected = motion.positions();
  REQUIRE(back.positions.size() == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(ml::norm(back.positions[i] - expected[i]) < 1e-6);
  ml::Motion far_away = motion;
  far_away.root[3].x = 1e300;
  CHECK_THROWS_WITH_AS(ml::write_joints_npy(folder / "far.npy", far_away),
                       doctest::Contains("[motionlang.numeric.301] write_joints_npy: joint 0 of frame 3 is at (1e+300"),
                       ml::numeric_error);
  CHECK_FALSE(std::filesystem::exists(folder / "far.npy"));
  ml::write_npy(folder / "flat.npy", matrix(3, 3));
  CHECK_THROWS_WITH_AS(ml::read_joints_npy(folder / "flat.npy"), doctest::Contains("407"), ml::io_error);
}

TEST_CASE("sequences for a body model: every number of the file, in its own world") {
  const TemporaryFolder folder;
  std::vector<double> poses(2 * 156);
  std::iota(poses.begin(), poses.end(), 0.5);
  const std::vector<double> trans{1, 2, 3, 4, 5, 6}, betas{0.1, 0.2};
  const std::string male = "male";
  const ml::NpyArray list_of_one{
      'S', 4, {1}, {std::as_bytes(std::span(male)).begin(), std::as_bytes(std::span(male)).end()}};
  std::vector<ml::NamedArray> arrays{{"poses", ml::NpyArray::of(std::span<const double>(poses), {2, 156})},
                                     {"trans", ml::NpyArray::of(std::span<const double>(trans), {2, 3})},
                                     {"betas", ml::NpyArray::of(std::span<const double>(betas), {2})},
                                     {"gender", list_of_one},  // SSM_synced
                                     {"mocap_framerate", ml::NpyArray::scalar(59.0)}};
  ml::write_npz(folder / "a.npz", arrays);
  const ml::AmassSequence sequence = ml::read_amass_sequence(folder / "a.npz");
  CHECK(sequence.frames == 2);
  CHECK(sequence.columns == 156);
  CHECK(sequence.poses == poses);
  CHECK(sequence.trans == trans);
  CHECK(sequence.betas == betas);
  CHECK(sequence.gender == "male");
  CHECK(sequence.fps == 59);

  ml::write_npz(folder / "shape.npz", std::span(arrays).subspan(2, 2));  // lies beside the sequences
  CHECK(ml::amass_poses(ml::NpzArchive::open(folder / "shape.npz")).empty());
  CHECK_THROWS_WITH_AS(ml::read_amass_sequence(folder / "shape.npz"),
                       doctest::Contains("shape.npz: no array 'poses' in the archive"), ml::io_error);
  arrays[0].array = matrix(2, 157);
  ml::write_npz(folder / "b.npz", arrays);
  CHECK_THROWS_WITH_AS(ml::read_amass_sequence(folder / "b.npz"), doctest::Contains("poses (2, 157)"), ml::io_error);
}

TEST_CASE("a gender that was saved as an object of Python") {
  const TemporaryFolder folder;
  const std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (), }\n";
  const std::string_view version("\1\0", 2), behind("\0", 1);
  const auto file_with = [&](const std::string& element) {
    const std::string npy =
        ml::concat_text("\x93NUMPY", version, static_cast<char>(header.size()), behind, header,
                        "cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(I0\ntS'b'\ntR(I1\n(t"
                        "cnumpy\ndtype\n(S'O8'\nI0\nI1\ntRI00\n(",
                        element, "ltb.");
    const std::vector<ml::NamedArray> arrays{{"poses.npy", matrix(2, 156)},
                                             {"trans.npy", matrix(2, 3)},
                                             {"mocap_framerate.npy", ml::NpyArray::scalar(59.0)}};
    ml::ZipWriter zip;
    for (const ml::NamedArray& a : arrays) zip.add(a.name, ml::npy_bytes(a.array));
    zip.add("gender.npy", std::as_bytes(std::span(npy)));
    ml::write_file(folder / "a.npz", zip.finish());
    return folder / "a.npz";
  };
  CHECK(ml::read_amass_sequence(file_with("S'female'\n")).gender == "female");
  CHECK_THROWS_WITH_AS(ml::read_amass_sequence(file_with("I3\n")), doctest::Contains("a text expected, found"),
                       ml::io_error);
}

TEST_CASE("parameters of smplx: its names, betas for each frame, and a rate that the file does not say") {
  const TemporaryFolder folder;
  const auto array = [](ml::Index columns, double first) {
    std::vector<double> v(static_cast<std::size_t>(2 * columns));
    std::iota(v.begin(), v.end(), first);
    return ml::NpyArray::of(std::span<const double>(v), {2, columns});
  };
  const auto read = [&](const std::vector<ml::NamedArray>& arrays, double fps = 0) {
    ml::write_npz(folder / "a.npz", arrays);
    return ml::read_amass_sequence(folder / "a.npz", fps);
  };
  std::vector<ml::NamedArray> arrays{{"global_orient", array(3, 100)},
                                     {"body_pose", array(63, 200)},
                                     {"transl", array(3, 400)},
                                     {"betas", array(10, 500)},
                                     {"gender", ml::NpyArray::text("female")}};
  const ml::AmassSequence s = read(arrays, 25);
  CHECK(ml::amass_poses(ml::NpzArchive::open(folder / "a.npz")) == "global_orient");
  REQUIRE((s.frames == 2 && s.columns == 66 && s.poses.size() == 2 * 66));
  CHECK((s.poses[2] == 102 && s.poses[3] == 200 && s.poses[66] == 103 && s.poses[69] == 263 && s.poses.back() == 325));
  CHECK(s.trans == std::vector<double>{400, 401, 402, 403, 404, 405});
  CHECK((s.betas.size() == 10 && s.betas.back() == 509));
  CHECK((s.gender == "female" && s.fps == 25));
  CHECK(ml::read_amass(folder / "a.npz", {}, 25).motion.fps == 25);
  CHECK_THROWS_WITH_AS(
      read(arrays),
      doctest::Contains("a.npz: no frame rate 'mocap_frame_rate', 'mocap_framerate' or 'fps'; set `rate`"),
      ml::io_error);
  CHECK_THROWS_WITH_AS(read(arrays, -1), doctest::Contains("a.npz: frame rate -1"), ml::io_error);

  for (const char* name : {"mocap_frame_rate", "mocap_framerate", "fps"}) {
    auto with_rate = arrays;
    with_rate.push_back({name, ml::NpyArray::scalar(60.0)});
    CHECK(read(with_rate).fps == 60);
    CHECK(read(with_rate, 60).fps == 60);
    CHECK_THROWS_WITH_AS(read(with_rate, 25), doctest::Contains("a.npz: has 60 frames per second, `rate` says 25"),
                         ml::config_error);
  }
  auto hands = arrays;
  for (const char* name : {"right_hand_pose", "left_hand_pose"}) hands.push_back({name, array(45, name[0])});
  CHECK(read(hands, 25).columns == 156);
  CHECK(read(hands, 25).poses[66] == 'l');
  for (const char* name : {"jaw_pose", "leye_pose", "reye_pose"}) hands.push_back({name, array(3, name[0])});
  CHECK(read(hands, 25).columns == 165);
  CHECK((read(hands, 25).poses[66] == 'j' && read(hands, 25).poses[75] == 'l'));
  for (const std::size_t i : {5U, 6U}) hands[i].array = array(12, 0);  // coefficients
  CHECK(read(hands, 25).columns == 75);
  arrays[1].array = array(69, 0);
  CHECK(read(arrays, 25).columns == 72);
  arrays.erase(arrays.begin() + 2);
  CHECK_THROWS_WITH_AS(read(arrays, 25), doctest::Contains("no array 'transl'"), ml::io_error);
}

TEST_CASE("poses in parts are those of one array") {
  const TemporaryFolder folder;
  std::vector<double> root(2 * 3, 1), body(2 * 63, 2), hands(2 * 90, 3);
  const auto array = [](const std::vector<double>& v) {
    return ml::NpyArray::of(std::span<const double>(v), {2, std::ssize(v) / 2});
  };
  std::vector<ml::NamedArray> arrays{{"root_orient", array(root)},
                                     {"pose_body", array(body)},
                                     {"pose_hand", array(hands)},
                                     {"trans", matrix(2, 3)},
                                     {"mocap_frame_rate", ml::NpyArray::scalar(120.0)}};
  ml::write_npz(folder / "a.npz", arrays);
  CHECK(ml::amass_poses(ml::NpzArchive::open(folder / "a.npz")) == "root_orient");
  const ml::AmassSequence s = ml::read_amass_sequence(folder / "a.npz");
  REQUIRE((s.frames == 2 && s.columns == 156 && s.poses.size() == 2 * 156));
  CHECK((s.poses[156] == 1 && s.poses[156 + 3] == 2 && s.poses[156 + 65] == 2 && s.poses[156 + 66] == 3 &&
         s.poses.back() == 3));
  arrays[2].array = matrix(3, 90);
  ml::write_npz(folder / "b.npz", arrays);
  CHECK_THROWS_WITH_AS(ml::read_amass_sequence(folder / "b.npz"),
                       doctest::Contains("parts of the poses have 2 and 3 rows"), ml::io_error);
  arrays = {
      {"root_orient", {'f', 8, {0, INT64_MAX}, {}}}, {"pose_body", {'f', 8, {0, 63}, {}}}, {"trans", matrix(0, 3)}};
  ml::write_npz(folder / "c.npz", arrays);
  CHECK_THROWS_WITH_AS(ml::read_amass_sequence(folder / "c.npz"),
                       doctest::Contains("c.npz: 'root_orient' has 9223372036854775807 columns, at most 4096"),
                       ml::io_error);
}
