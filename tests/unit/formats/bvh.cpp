// BVH: what the channels mean, tolerant reading, strict writing, smooth curves, refused files.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/bvh_text.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/metrics/inspect_motion.hpp>

#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;

namespace {

/// The file of the format's description (exchange-formats, 10.1).
const std::string two_joints = R"(HIERARCHY
ROOT hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT chest
  {
    OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 2 5 0
    }
  }
}
MOTION
Frames: 1
Frame Time: 0.0333333
1 2 3 30 20 -40 -15 50 70
)";

std::string with(std::string text, std::string_view what, std::string_view instead) {
  const auto at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), instead);
}

void check_equal(const ml::Vec3<double>& a, const ml::Vec3<double>& b, double tolerance = 1e-6) {
  CHECK(ml::norm(a - b) < tolerance);
}

/// Joint positions do not depend on the order of the joints.
void check_same_positions(const ml::Motion& a, const ml::Motion& b, double tolerance) {
  REQUIRE(a.frames() == b.frames());
  REQUIRE(a.skeleton.size() == b.skeleton.size());
  const auto p = a.positions(), q = b.positions();
  const auto joints = static_cast<std::size_t>(a.skeleton.size());
  double worst = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto other = static_cast<std::size_t>(b.skeleton[a.skeleton.names[i % joints]]);
    worst = std::max(worst, ml::norm(p[i] - q[i / joints * joints + other]));
  }
  CHECK(worst < tolerance);
}

}  // namespace

TEST_CASE("BVH: rotations apply in the order of the channels, the first outermost") {
  const ml::Bvh file = ml::parse_bvh(two_joints);
  const ml::Motion motion = ml::to_motion(file, {.scale = 1});
  REQUIRE(motion.frames() == 1);
  CHECK(motion.fps == 30);
  ml::JointTransforms<double> world;
  motion.world(0, world);
  check_equal(world.position[0], {1, 2, 3});
  check_equal(world.position[1], {-3.698463, 10.137977, 6.420201}, 2e-6);
  CHECK(world.rotation[0](0, 0) == Approx(0.773337).epsilon(1e-6));
  CHECK(world.rotation[0](2, 1) == Approx(0.34202).epsilon(1e-6));
  check_equal(world.position[1] + world.rotation[1] * file.nodes[2].offset, {-5.401035, 12.573535, 10.911227}, 2e-6);
}

TEST_CASE("BVH: a scale turns units into metres") {
  const ml::Motion motion = ml::to_motion(ml::parse_bvh(two_joints));  // centimetres
  check_equal(motion.root_at(0), {0.01, 0.02, 0.03});
  check_equal(motion.skeleton.offset(1), {0, 0.1, 0});
  CHECK_THROWS_WITH_AS(ml::to_motion(ml::parse_bvh(two_joints), {.scale = 0}), Contains("[motionlang.config.101]"),
                       ml::config_error);
}

TEST_CASE("BVH: the torture file is read like the plain one") {
  const std::string torture =
      "\xEF\xBB\xBFhierarchy\r\nroot the hips\r\n{ offset 0 0 0 channels 6 xposition YPOSITION Zposition\r"
      "zrotation XROTATION yrotation\r\njoint chest{ OFFSET 0 1e1 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
      "end site EndName\n{\n OFFSET 2 +5 0\n}}}\nmotion\nFRAMES : 2\nframe time:3.33333e-2\n"
      "1 2 3 30 20\r\n-40 -15 50 70 1 2\n\n3 30 20 -40 -15 50 70\n\n  \r\n";
  const ml::Bvh file = ml::parse_bvh(torture);
  REQUIRE(file.nodes.size() == 3);
  CHECK(file.nodes[0].name == "the_hips");
  CHECK(file.nodes[2].name == "site_EndName");
  CHECK(file.nodes[2].end_site);
  CHECK(file.frames == 2);
  const ml::Bvh plain = ml::parse_bvh(two_joints);
  for (ml::Index f = 0; f < 2; ++f) {
    CHECK(std::equal(file.frame(f).begin(), file.frame(f).end(), plain.frame(0).begin()));
  }
  CHECK(file.nodes[2].offset == plain.nodes[2].offset);
}

TEST_CASE("BVH: any channels, in any number and order") {
  const auto motion = ml::to_motion(
      ml::parse_bvh(
          "HIERARCHY ROOT r { OFFSET 0 0 0 CHANNELS 1 Yposition JOINT other { OFFSET 0 1 0 } JOINT a { OFFSET 1 "
          "0 0 CHANNELS 2 Yrotation Zposition JOINT b { OFFSET 1 0 0 JOINT c { OFFSET 1 0 0 CHANNELS 0 } } } } "
          "MOTION Frames: 2 Frame Time: 0.05 4 90 7 5 90 9"),
      {.scale = 1});
  REQUIRE(motion.skeleton.names == std::vector<std::string>{"r", "other", "a", "b", "c"});
  check_equal(motion.root_at(1), {0, 5, 0});
  check_equal(motion.skeleton.offset(2), {1, 0, 8});  // the channel replaces z, by its mean
  check_equal(motion.positions()[4], {1, 4, 8 - 2});  // b and c go along -z after a quarter turn about y
}

TEST_CASE("BVH: positions replace the OFFSET, also that of the root") {
  const auto text = with(with(two_joints, "OFFSET 0 0 0", "OFFSET 5 5 5"), "3 Zrotation Xrotation Yrotation\n    End",
                         "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n    End");
  const auto motion = ml::to_motion(ml::parse_bvh(with(text, "-15 50 70", "0 20 0 -15 50 70")), {.scale = 1});
  check_equal(motion.root_at(0), {1, 2, 3});
  check_equal(motion.skeleton.offset(1), {0, 20, 0});
}

TEST_CASE("BVH: a root that only carries a moving one is joined with it") {
  const std::string text =
      "HIERARCHY ROOT Reference { OFFSET 0 0 0 CHANNELS 4 Xposition Yposition Zposition Yrotation JOINT Hips { OFFSET "
      "0 1 "
      "0 CHANNELS 4 Xposition Yposition Zposition Yrotation JOINT leg { OFFSET 0 0 2 CHANNELS 1 Xrotation } } } MOTION "
      "Frames: 2 Frame Time: 0.05\n10 0 0 90 0 1 0 0 5\n10 0 0 90 0 1 3 90 5\n";
  const auto motion = ml::to_motion(ml::parse_bvh(text), {.scale = 1});
  REQUIRE(motion.skeleton.names == std::vector<std::string>{"Hips", "leg"});
  check_equal(motion.root_at(0), {10, 1, 0});
  check_equal(motion.root_at(1), {13, 1, 0});  // z of the carrier, turned by 90 degrees about y
  const auto p = motion.positions();
  check_equal(p[3], {13, 1, -2});
}

TEST_CASE("BVH: joints below the root that move away from the joint before are reported") {
  const std::string text =
      "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xposition JOINT still { OFFSET 0 1 0 CHANNELS 1 Yposition JOINT arm "
      "{ OFFSET 0 1 0 CHANNELS 1 Yposition } } JOINT leg { OFFSET 0 1 0 CHANNELS 1 Xrotation } } MOTION Frames: 2 "
      "Frame Time: 0.05\n0 3 1 0\n5 3 1.5 90\n";
  const ml::Bvh file = ml::parse_bvh(text);
  CHECK(ml::stretched_joints(file) == std::vector<std::string>{"arm"});
  CHECK(ml::to_motion(file, {.scale = 1}).skeleton.offset(2).y == 1.25);
  CHECK(ml::stretched_joints(ml::parse_bvh(with(text, "3 1.5", "3 1"))).empty());
  CHECK_THROWS_WITH_AS(ml::stretched_joints(file, {.root = 1}), Contains("root 1 was asked for"), ml::config_error);
}

TEST_CASE("BVH: of several roots one is chosen") {
  const std::string text =
      "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xposition End Site { OFFSET 0 1 0 } } ROOT b { OFFSET 0 0 0 CHANNELS "
      "1 "
      "Yposition JOINT b1 { OFFSET 1 2 3 } } MOTION Frames: 1 Frame Time: 0.05 3 4";
  const ml::Bvh file = ml::parse_bvh(text, "two.bvh");
  CHECK(ml::to_motion(file).skeleton.names == std::vector<std::string>{"a"});
  const auto second = ml::to_motion(file, {.scale = 1, .root = 1});
  CHECK(second.skeleton.names == std::vector<std::string>{"b", "b1"});
  check_equal(second.root_at(0), {0, 4, 0});
  CHECK_THROWS_WITH_AS(ml::to_motion(file, {.root = 2}), Contains("the file has 2"), ml::config_error);
  CHECK(ml::bvh_roots(file) == 2);
  CHECK(ml::parse_bvh(ml::format_bvh(file)).values == file.values);
}

TEST_CASE("BVH: joints of one name are distinguished") {
  const auto motion = ml::to_motion(ml::parse_bvh(
      "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xposition JOINT a { OFFSET 1 0 0 } JOINT a { OFFSET 2 0 "
      "0 } } MOTION Frames: 0 Frame Time: 0.05"));
  CHECK(motion.skeleton.names == std::vector<std::string>{"a", "a_2", "a_3"});
  CHECK(motion.frames() == 0);
}

TEST_CASE("BVH: what was read is written back, number by number") {
  const ml::Bvh file = ml::parse_bvh(two_joints);
  const std::string text = ml::format_bvh(file);
  const ml::Bvh again = ml::parse_bvh(text);
  CHECK(again.values == file.values);
  CHECK(again.nodes.size() == file.nodes.size());
  for (std::size_t n = 0; n < file.nodes.size(); ++n) {
    CHECK(again.nodes[n].name == file.nodes[n].name);
    CHECK(again.nodes[n].parent == file.nodes[n].parent);
    CHECK(again.nodes[n].channels == file.nodes[n].channels);
  }
  CHECK(ml::format_bvh(again) == text);
}

TEST_CASE("BVH: written for the strictest reader") {
  const ml::Motion walk = synthetic::walk({.frames = 3});
  const std::string text = ml::format_bvh(ml::to_bvh(walk));
  CHECK(text.starts_with(
      "HIERARCHY\nROOT pelvis\n{\n\tOFFSET 0.000000 0.000000 0.000000\n\tCHANNELS 6 Xposition Yposition Zposition "
      "Zrotation Xrotation Yrotation\n\tJOINT left_hip\n\t{\n\t\tOFFSET 9.000000 -6.000000 0.000000\n\t\tCHANNELS 3 "
      "Zrotation Xrotation Yrotation\n"));
  CHECK(text.find("MOTION\nFrames: 3\nFrame Time: 0.050000\n") != text.npos);
  CHECK(text.find_first_of("eE", text.find("Frame Time: ") + 12) == text.npos);
  CHECK(text.find('\r') == text.npos);
  CHECK(text.find("-0.000000") == text.npos);
  CHECK(text.back() == '\n');
  CHECK(text[text.size() - 2] != '\n');
  CHECK(std::count(text.begin() + static_cast<std::ptrdiff_t>(text.find("Frame Time")), text.end(), '\n') == 4);
  int leaves = 0, ends = 0;
  const auto nodes = ml::to_bvh(walk).nodes;
  for (const auto& node : nodes) {
    ends += node.end_site ? 1 : 0;
    if (node.end_site)
      CHECK(ml::norm(node.offset) ==
            Approx(std::min(10.0, ml::norm(nodes[static_cast<std::size_t>(node.parent)].offset))));
  }
  for (int j = 0; j < walk.skeleton.size(); ++j) leaves += walk.skeleton.children(j).empty() ? 1 : 0;
  CHECK(ends == leaves);
}

TEST_CASE("BVH: frame times keep the rate") {
  for (const double fps : {12.0, 20.0, 24.0, 29.97, 30.0, 60.0, 120.0}) {
    ml::Motion walk = synthetic::walk({.frames = 2});
    walk.fps = fps;
    CHECK(ml::to_motion(ml::parse_bvh(ml::format_bvh(ml::to_bvh(walk)))).fps == Approx(fps).epsilon(1e-7));
  }
  CHECK(ml::to_motion(ml::parse_bvh(with(two_joints, "0.0333333", "0.0166667"))).fps == 60);
  CHECK(ml::to_motion(ml::parse_bvh(with(two_joints, "0.0333333", "0.041667"))).fps == 24);
}

TEST_CASE("BVH: a motion survives file, order and unit") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 40, .turn = 2});
  for (const char* order : {"ZXY", "ZYX", "XYZ", "YXZ", "XZY", "YZX"}) {
    ml::write_bvh(folder / "walk.bvh", walk, {.scale = 1000, .order = order});
    check_same_positions(walk, ml::read_bvh_motion(folder / "walk.bvh", {.scale = 0.001}), 1e-6);
  }
  CHECK_THROWS_WITH_AS(ml::read_bvh(folder / "none.bvh"), Contains("[motionlang.io.401]"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::to_bvh(walk, {.order = "ZXZ"}), Contains("[motionlang.config.101]"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::to_bvh(walk, {.order = "ZXW"}), Contains("[motionlang.config.103]"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::to_bvh(walk, {.scale = -1}), Contains("[motionlang.config.101]"), ml::config_error);
}

TEST_CASE("BVH: curves of angles do not jump, not even through gimbal lock") {
  // Two turns about y, a somersault (the middle axis x passes +-90 degrees), and a tumble about a skew axis.
  const auto skew = ml::normalized(ml::Vec3{1.0, 2.0, -0.5});
  for (const auto& axis : {ml::Vec3{0.0, 1.0, 0.0}, ml::Vec3{1.0, 0.0, 0.0}, skew}) {
    ml::Motion motion{ml::Skeleton::from_joints({{"r", "", {0, 1, 0}}, {"a", "r", {0, 1, 0}}}), 60, {}, {}, ""};
    for (int f = 0; f <= 240; ++f) {
      motion.root.push_back({0, 1, 0});
      motion.local.push_back(ml::from_axis_angle(axis, f * std::numbers::pi / 60));
      motion.local.push_back(ml::Quaternion<double>::identity());
    }
    const ml::Bvh file = ml::to_bvh(motion);
    for (ml::Index f = 1; f < file.frames; ++f) {
      for (std::size_t c = 3; c < 9; ++c) CHECK(std::abs(file.frame(f)[c] - file.frame(f - 1)[c]) < 25);
    }
    check_same_positions(motion, ml::to_motion(file), 1e-9);
  }
}

TEST_CASE("BVH: the twin of a triple continues the curve") {
  constexpr double degree = std::numbers::pi / 180;
  const auto order = ml::EulerOrder::parse("ZXY");
  const auto near = [&](double a, double b, double c) {
    return ml::EulerAngles<double>{a * degree, b * degree, c * degree, order};
  };
  const auto same = ml::detail::continue_curve(near(-150, 80, -160), near(28, 98, 21));  // (210, 80, 200) less 360
  CHECK(same.a / degree == Approx(30));
  CHECK(same.b / degree == Approx(100));
  CHECK(same.c / degree == Approx(20));
  const auto turns = ml::detail::continue_curve(near(-179, 0, 0), near(541, 0, 0));
  CHECK(turns.a / degree == Approx(541));
}

TEST_CASE("BVH: names that the format can hold") {
  auto motion = synthetic::walk({.frames = 1});
  motion.skeleton.names[1] = "mixamorig:Left Hip";
  motion.skeleton.names[2] = "mixamorig:Left_Hip";
  motion.skeleton.names[3] = "";
  const auto back = ml::to_motion(ml::to_bvh(motion));
  CHECK(back.skeleton.find("mixamorig:Left_Hip") >= 0);
  CHECK(back.skeleton.find("mixamorig:Left_Hip_2") >= 0);
  CHECK(back.skeleton.find("joint") >= 0);
}

TEST_CASE("BVH: where bones end is kept, mirrored and scaled with the clip; a channel stands once") {
  auto motion = ml::to_motion(ml::parse_bvh(two_joints));
  REQUIRE(motion.skeleton.ends.size() == 2);
  check_equal(motion.skeleton.ends[1], {0.02, 0.05, 0});
  check_equal(ml::to_bvh(motion).nodes[2].offset, {2, 5, 0});
  const std::vector<int> itself{0, 1};
  ml::Cure tripled;
  tripled.scale = 3;
  check_equal(ml::to_bvh(ml::mirror(motion, itself)).nodes[2].offset, {-2, 5, 0});
  check_equal(ml::to_bvh(ml::mended(motion, tripled)).nodes[2].offset, {6, 15, 0});
  motion.skeleton.ends.clear();
  check_equal(ml::to_bvh(motion).nodes[2].offset, {0, 10, 0});
  check_equal(ml::to_bvh(motion, {.end_length = 0.5}).nodes[2].offset, {0, 10, 0});  // not longer than the bone before
  motion.skeleton.ends.resize(1);
  CHECK_THROWS_WITH_AS(motion.validate(), doctest::Contains("1 ends of 2 joints"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::parse_bvh(with(two_joints, "Zrotation Xrotation Yrotation\n  JOINT",
                                          "Zrotation Xrotation Xrotation\n  JOINT")),
                       doctest::Contains("joint 'hips' has a channel twice"), ml::io_error);
}

TEST_CASE("BVH: a single joint, and a bone of no length, get an end") {
  ml::Motion point{ml::Skeleton::from_joints({{"r", "", {0, 1, 0}}}), 20, {{0, 1, 0}}, {{1, 0, 0, 0}}, ""};
  const ml::Bvh file = ml::to_bvh(point, {.end_length = 0.2});
  REQUIRE(file.nodes.size() == 2);
  check_equal(file.nodes[1].offset, {0, 20, 0});
}

TEST_CASE("BVH: what no reader takes is not written") {
  const ml::Bvh good = ml::to_bvh(synthetic::walk({.frames = 2}));
  const auto refuses = [&](auto change, const char* message) {
    ml::Bvh bad = good;
    change(bad);
    CHECK_THROWS_WITH_AS(ml::format_bvh(bad), Contains(message), ml::numeric_error);
  };
  refuses([](ml::Bvh& b) { b.frame_time = 0; },
          "[motionlang.numeric.302] BVH: motion 'walk': the frame time is 0 s, expected 1e-09");
  refuses([](ml::Bvh& b) { b.frame_time = 1e-10; }, "the frame time is 1e-10 s");
  refuses([](ml::Bvh& b) { b.frame_time = INFINITY; },
          "[motionlang.numeric.301] BVH: motion 'walk': the frame time is inf");
  refuses([](ml::Bvh& b) { b.nodes[2].offset.y = std::nan(""); }, "a number of the offset of 'left_knee' is nan");
  refuses([](ml::Bvh& b) { b.values[static_cast<std::size_t>(b.channels() + 4)] = -INFINITY; },
          "number 4 of frame 1 is -inf");
  auto fast = synthetic::walk({.frames = 2});
  fast.fps = 1e12;
  CHECK_THROWS_WITH_AS(ml::format_bvh(ml::to_bvh(fast)), Contains("[motionlang.numeric.302]"), ml::numeric_error);
  CHECK_THROWS_WITH_AS(ml::format_bvh(ml::to_bvh(synthetic::walk({.frames = 2}), {.scale = INFINITY})),
                       Contains("[motionlang.numeric.301]"), ml::numeric_error);
}

TEST_CASE("BVH: thousands of joints of one name take no time") {
  std::string text = "HIERARCHY ROOT b { OFFSET 0 0 0 CHANNELS 1 Xposition ";
  for (int i = 0; i < 4000; ++i) text += "JOINT b { OFFSET 0 0 0 }";
  const auto motion = ml::to_motion(ml::parse_bvh(text + "} MOTION Frames: 1 Frame Time: 1 1"));
  CHECK(motion.skeleton.names.back() == "b_4001");
}

TEST_CASE("BVH: malformed files are refused where they are wrong") {
  auto refuses = [](const std::string& text, const std::string& message) {
    CHECK_THROWS_WITH_AS(ml::parse_bvh(text, "f.bvh"), Contains(message.c_str()), ml::io_error);
  };
  refuses("", "[motionlang.io.402] f.bvh:1:1: the text ends where hierarchy should be");
  refuses("HIERARCHY", "[motionlang.io.402]");
  std::string word = "a", shown;  // a long word is cut between two characters
  for (int i = 1; i < 30; ++i) {
    if (i == 20) shown = word;
    word += "\xC3\xA4";
  }
  refuses(word, "found '" + shown + "...'");
  refuses("HELLO", "[motionlang.io.403] f.bvh:1:1: expected 'hierarchy', found 'HELLO'");
  refuses("\x1B[31m\xFFw\xC3\xA4lk\x7F", "found '[31m?w\xC3\xA4lk?'");
  refuses(
      "HIERARCHY ROOT hi\xC2\x9B"
      "31mps { BAD",
      "'BAD' does not belong in 'hi?31mps'");
  refuses(two_joints.substr(0, 150), "[motionlang.io.402]");
  refuses(with(two_joints, "ROOT hips", "ROOT"), "a joint without a name");
  refuses(with(two_joints, "ROOT hips\n{", "ROOT hips\n}"), "expected '{', found '}'");
  refuses(with(two_joints, "OFFSET 0 10 0", ""), "'chest' has no OFFSET");
  refuses(with(two_joints, "OFFSET 0 10 0", "OFFSET 0 ten 0"), "[motionlang.io.403] f.bvh:8:14: expected an offset");
  refuses(with(two_joints, "Zposition", "Wposition"), "f.bvh:5:34: 'Wposition' is not a channel");
  refuses(with(two_joints, "Zposition", "Zscale"), "'Zscale' is not a channel");
  refuses(with(two_joints, "CHANNELS 3", "CHANNELS -3"), "the number of channels");
  refuses(with(two_joints, "OFFSET 2 5 0", "CHANNELS 3"), "'CHANNELS' does not belong in 'Site'");
  refuses(with(two_joints, "MOTION", "NOTION"), "[motionlang.io.403]");
  refuses(with(two_joints, "Frames: 1", "Frames: 1.5"), "the number of frames");
  refuses(with(two_joints, "1 2 3 30", "1 2 3\n1 2 3 30"), "'-15' follows the 1 declared frame of 9 channels");
  refuses(two_joints.substr(0, two_joints.size() - 4), "too short for the 1 declared frame of 9 channels: it has 7");
  CHECK(ml::parse_bvh(with(two_joints, "Frames: 1", "Frames: 1000000000000000000")).frames == 1);
  refuses(with(two_joints, "Frame Time: 0.0333333", "Frame Time: 0"), "the frame time is 0");
  refuses(with(two_joints, "Frame Time: 0.0333333", "Frame Time: nan"), "the frame time");
  refuses(with(two_joints, "-15 50 70", "-15 50 inf"), "f.bvh:19:24: expected a value of the motion, found 'inf'");
  refuses(with(two_joints, "-15 50 70", "-15 50 1e999"), "[motionlang.io.403]");
  refuses(with(two_joints, "-15 50 70", "-15 50 70 80"), "'80' follows the 1 declared frame of 9 channels");
  refuses("HIERARCHY ROOT a { OFFSET 0 0 0 } MOTION Frames: 3 Frame Time: 1", "3 frames, but no channels");
  std::string many = "HIERARCHY ROOT a { OFFSET 0 0 0 ";
  for (int i = 0; i < 5000; ++i) many += "JOINT b { OFFSET 0 0 0 }";
  refuses(many, "[motionlang.io.405]");
  std::string deep = "HIERARCHY ROOT a { OFFSET 0 0 0 ";
  for (int i = 0; i < 4000; ++i) deep += "JOINT b { OFFSET 0 0 0 ";
  refuses(deep, "[motionlang.io.402]");
}

TEST_CASE("BVH: a small file cannot ask for much memory, nor for numbers that overflow") {
  std::string text = "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xposition ";
  for (int i = 0; i < 4000; ++i) text += "JOINT b { OFFSET 0 0 0 }";
  text += "} MOTION Frames: 20000 Frame Time: 1 ";
  for (int i = 0; i < 20000; ++i) text += "1 ";
  const ml::Bvh file = ml::parse_bvh(text);
  CHECK_THROWS_WITH_AS(ml::to_motion(file), Contains("[motionlang.io.405]"), ml::io_error);
  CHECK_THROWS_WITH_AS(ml::to_motion(ml::parse_bvh(with(two_joints, "1 2 3 30", "1e308 2 3 30")), {.scale = 1e10}),
                       Contains("[motionlang.numeric.301]"), ml::numeric_error);
  CHECK(ml::parse_bvh(with(two_joints, "1 2 3 30", "1e-999 2 3 30")).values[0] == 0);
  ml::Bvh fast = ml::parse_bvh(two_joints);
  fast.frame_time = 1e-310;  // its inverse is infinite
  CHECK_THROWS_WITH_AS(ml::to_motion(fast), Contains("[motionlang.config.101]"), ml::config_error);
}

TEST_CASE("BVH: every way to write a number gives the double nearest to it") {
  auto value = [](const std::string& number) {
    return ml::parse_bvh("HIERARCHY ROOT r { OFFSET 0 0 0 CHANNELS 1 Yposition } MOTION Frames: 1 Frame Time: 1 " +
                         number)
        .values.at(0);
  };
  for (const char* number : {"0.1", "-0.1", "179.999999", "5.", ".5", "-.5", "007", "123456789012345",
                             "1234567890.12345", "0.000000000000001", "1234567890123456", "0.12345678901234567890",
                             "1e-3", "-2.5E+2", "9007199254740993", "72057594037927945.5"}) {
    CAPTURE(number);
    CHECK(value(number) == std::strtod(number, nullptr));
  }
  CHECK(std::signbit(value("-0")));
  for (const char* number : {"-", ".", "1.2.3", "..1", "--1", "1-", "1,5.", "0x10", "nano", "inf", "1e999"}) {
    CAPTURE(number);
    CHECK_THROWS_WITH_AS(value(number), Contains("[motionlang.io.403] BVH text:1:"), ml::io_error);
  }
}
