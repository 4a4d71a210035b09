// ASF and AMC: units, axes, degrees of freedom, hierarchy, refused files.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include <motionlang/core/rng.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/formats/amc.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/geometry/degree.hpp>
#include <motionlang/geometry/euler.hpp>
#include <motionlang/geometry/so3.hpp>

#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;

namespace {

/// A leg whose foot is listed before its shin, with a bone axis that is not a multiple of a quarter turn.
const std::string leg = R"(# a comment
:version 1.10
:name test
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
  free text: begin end root
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name foot
    direction 0 0 1
    length 1
    axis 0 0 0 XYZ
    dof rx rz
    limits (-45.0 90.0)
           (-70.0 20.0)
  end
  begin
    id 2
    name hip
    direction 2 0 0
    length 3
    axis 0 0 0 XYZ
  end
  begin
    name shin
    direction 0 -1 0
    length 4
    axis 0 0 90 XYZ
    dof rx
  end
:hierarchy
  begin
    root hip
    hip shin
    shin foot
  end
:skin ignored
)";
const std::string frames = R"(#!OML:ASF somewhere
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 0 0 0
shin 0
foot 0 0
2
root 1 2 3 0 90 0
shin 90
foot 0 0
)";
const std::string others = " root 0 0 0 0 0 0 foot 0 0\n";  // than the shin
constexpr double unit = 0.0254 / 0.45;

std::string with(std::string text, std::string_view what, std::string_view instead) {
  const auto at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), instead);
}
void check_equal(const ml::Vec3<double>& a, const ml::Vec3<double>& b) { CHECK(ml::norm(a - b) < 1e-9); }

}  // namespace

TEST_CASE("ASF: bones become joints at their starts, parents first, in metres") {
  const ml::Skeleton s = ml::to_skeleton(ml::parse_asf(leg));
  CHECK(s.names == std::vector<std::string>{"root", "hip", "shin", "foot"});
  CHECK(s.parents == std::vector<int>{-1, 0, 1, 2});
  check_equal(s.offset(1), {0, 0, 0});
  check_equal(s.offset(2), {3 * unit, 0, 0});  // the direction need not have length 1
  check_equal(s.offset(3), {0, -4 * unit, 0});
}

TEST_CASE("AMC: angles are meant in the axes of the bone") {
  const ml::AsfSkeleton asf = ml::parse_asf(leg);
  const ml::Motion motion = ml::parse_amc(frames, asf);
  CHECK(motion.fps == 120);
  REQUIRE(motion.frames() == 2);
  const auto p = motion.positions();
  check_equal(p[0], {unit, 2 * unit, 3 * unit});
  check_equal(p[3], {4 * unit, -2 * unit, 3 * unit});
  // Frame 2: the root turns by 90 degrees about y (x -> -z). The shin's x axis is the world's y axis before that, so
  // its rotation by 90 degrees about "x" leaves the bone, which points along -y, where it is; the foot's z goes to x.
  check_equal(p[6], {unit, 2 * unit, 0});
  check_equal(p[7], {unit, -2 * unit, 0});
  ml::JointTransforms<double> world;
  motion.world(1, world);
  check_equal(world.rotation[3] * ml::Vec3{0.0, 0.0, 1.0}, {0, 0, -1});
}

TEST_CASE("AMC: the axis named first is turned about first") {
  const auto asf = ml::parse_asf(with(leg, "dof rx\n", "dof rx ry rz\n"));
  const auto motion = ml::parse_amc("1\nshin 30 20 -40" + others,
                                    ml::parse_asf(with(leg, "0 0 90 XYZ\n    dof rx\n", "0 0 0 XYZ\ndof rx ry rz\n")));
  const auto m = to_matrix(motion.local[2]);
  constexpr double d = std::numbers::pi / 180;
  const auto wanted = ml::axis_rotation(2, -40 * d) * ml::axis_rotation(1, 20 * d) * ml::axis_rotation(0, 30 * d);
  for (std::size_t i = 0; i < 9; ++i) CHECK(m.m[i] == Approx(wanted.m[i]));
  const std::string frame = "\rshin 9 8 7" + others;
  CHECK(ml::parse_amc("\xEF\xBB\xBF  7" + frame + "\r  8" + frame + "\r\n\t9" + frame, asf).frames() == 3);
  CHECK(ml::parse_amc("1", asf).frames() == 1);  // bones that no frame names are at rest
}

TEST_CASE("AMC: radians, in the skeleton or in the motion; other units; other rates") {
  const std::string half_pi = "1\nshin 1.5707963267948966" + others;
  const auto by_degrees = ml::parse_amc("1\nshin 90" + others, ml::parse_asf(leg));
  const auto asf = ml::parse_asf(with(with(leg, "angle deg", "angle rad"), "0 0 90 XYZ", "0 0 1.5707963267948966 XYZ"));
  CHECK(ml::distance(ml::parse_amc(half_pi, asf).local[2], by_degrees.local[2]) < 1e-12);
  CHECK(ml::distance(ml::parse_amc(":radians\n" + half_pi, ml::parse_asf(leg)).local[2], by_degrees.local[2]) < 1e-12);
  CHECK(ml::distance(ml::parse_amc(":Degrees\n1 shin 90" + others, asf).local[2], by_degrees.local[2]) < 1e-12);
  const auto inches = ml::parse_asf(with(leg, "length 0.45", "length 1"));
  CHECK(ml::to_skeleton(inches).offset(2).x == Approx(3 * 0.0254));
  CHECK(ml::parse_amc(frames, inches, {.fps = 60}).fps == 60);
}

TEST_CASE("ASF: position and orientation of the root") {
  const auto text = with(with(leg, "position 0 0 0", "position 0 1 0"), "orientation 0 0 0", "orientation 0 90 0");
  const auto motion = ml::parse_amc("1\nroot 0 0 0 90 0 0 shin 0 foot 0 0", ml::parse_asf(text));
  check_equal(motion.root_at(0), {0, unit, 0});
  check_equal(rotate(motion.local[0], ml::Vec3{1.0, 0.0, 0.0}), {0, -1, 0});  // about -z, the x of the turned axes
}

TEST_CASE("AMC: a bone that is translated begins where it does in the mean; a note says what is left out") {
  // The shin's x is the world's y, and its y the world's -x.
  const auto asf = ml::parse_asf(with(leg, "dof rx\n", "dof tx ty rx\n"));
  std::vector<std::string> notes;
  const auto still = ml::parse_amc("1\nshin 2 1 0" + others + "2\nshin 2 1 0" + others, asf, {}, "m.amc", &notes);
  check_equal(still.skeleton.offset(2), {2 * unit, 2 * unit, 0});
  CHECK(notes.empty());
  const auto moving = ml::parse_amc("1\nshin 1 0 0" + others + "2\nshin 3 0 0" + others, asf, {}, "m.amc", &notes);
  check_equal(moving.skeleton.offset(2), {3 * unit, 2 * unit, 0});
  check_equal(moving.positions()[2], {3 * unit, 2 * unit, 0});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].starts_with("left out: how 'shin' is moved (tx, ty, tz) across 0.11"));
}

TEST_CASE("AMC: lengths that a bone has in a frame are left out, and a note says so") {
  const auto asf = ml::parse_asf(with(leg, "dof rx\n", "dof rx l\n"));
  std::vector<std::string> notes;
  const auto motion = ml::parse_amc("1\nshin 0 7" + others + "2\nshin 0 8.5" + others, asf, {}, "m.amc", &notes);
  CHECK(motion.frames() == 2);
  check_equal(motion.skeleton.offset(3), {0, -4 * unit, 0});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0] == "left out: the lengths (l) of 'shin', from 7 to 8.5: it keeps that of the skeleton");
  const TemporaryFolder folder;
  ml::write_file(folder / "leg.asf", with(leg, "dof rx\n", "dof rx l\n"));
  ml::write_file(folder / "leg.amc", "1\nshin 0 7" + others);
  std::string lines;
  ml::read_motion(folder / "leg.amc", {}, &lines);
  CHECK_MESSAGE(lines.find("leg.amc: left out: the lengths (l) of 'shin', from 7 to 7") != lines.npos, lines);
}

TEST_CASE("AMC: random degrees of freedom, against what they mean") {
  ml::Philox draw{.seed = 4};
  const auto number = [&](double size) { return size * (2 * draw.uniform() - 1); };
  for (int i = 0; i < 50; ++i) {
    const double angle = number(180);
    const auto text =
        with(with(leg, "axis 0 0 90 XYZ\n    dof rx\n", "axis 0 0 " + std::to_string(angle) + " XYZ\n dof tx ty tz\n"),
             "direction 0 -1 0", "direction 0 -1 0");
    const auto asf = ml::parse_asf(text);
    ml::Vec3<double> sum{};
    std::string amc;
    for (int f = 1; f <= 5; ++f) {
      const ml::Vec3<double> t{number(3), number(3), number(3)};
      sum = sum + t;
      amc += std::to_string(f) + "\nshin " + std::to_string(t.x) + " " + std::to_string(t.y) + " " +
             std::to_string(t.z) + others;
    }
    std::vector<std::string> notes;
    const auto motion = ml::parse_amc(amc, asf, {}, "m.amc", &notes);
    const ml::Vec3<double> mean = 0.2 * sum;
    const double c = std::cos(angle * ml::degree), s = std::sin(angle * ml::degree);
    const ml::Vec3<double> wanted{3 + c * mean.x - s * mean.y, s * mean.x + c * mean.y, mean.z};
    CHECK(ml::norm(motion.skeleton.offset(2) - unit * wanted) < 1e-6);
    CHECK(notes.size() == 1);
  }
}

TEST_CASE("ASF: CRLF, comments, capitals, files") {
  std::string crlf;
  for (const char c : with(leg, "  begin\n    id 1", "# bones\n  BEGIN # first\n    id 1")) {
    if (c == '\n') crlf += '\r';
    crlf += c;
  }
  const TemporaryFolder folder;
  ml::write_file(folder / "leg.asf", crlf);
  ml::write_file(folder / "leg.amc", frames);
  const auto motion = ml::read_amc(folder / "leg.amc", ml::read_asf(folder / "leg.asf"));
  CHECK(motion.frames() == 2);
  CHECK_THROWS_WITH_AS(ml::read_asf(folder / "none.asf"), Contains("[motionlang.io.401]"), ml::io_error);
}

TEST_CASE("ASF: malformed skeletons are refused where they are wrong") {
  auto refuses = [](const std::string& text, const char* message) {
    CHECK_THROWS_WITH_AS(ml::parse_asf(text, "s.asf"), Contains(message), ml::io_error);
  };
  refuses(with(leg, "length 0.45", "length 0"), "[motionlang.io.403] s.asf:6:10: the unit of length is 0");
  refuses(with(leg, "name hip", "name"), "[motionlang.io.403]");
  refuses(with(leg, "    name hip\n", ""), "a bone without a name");
  refuses(with(leg, "name hip", "name shin"), "two bones are called 'shin'");
  refuses(with(leg, "0 0 90 XYZ", "0 0 90 XXZ"), "'XXZ' is not an order of axes");
  refuses(with(leg, "0 0 90 XYZ", "0 0 90"), "'dof' is not an order of axes");
  refuses(with(leg, "dof rx rz", "dof rx qz"), "'qz' is not a degree of freedom");
  refuses(with(leg, "shin foot", "shin toe"), "no bone is called 'toe'");
  refuses(with(leg, "shin foot", "shin foot hip"), "the bone 'hip' has two parents");
  refuses(with(leg, "shin foot", "shin foot root"), "the bone 'root' has two parents");
  refuses(with(leg, "    shin foot\n", ""), "the hierarchy does not lead to the bone 'foot'");
  refuses(with(leg, "    root hip\n", ""), "the hierarchy does not lead to the bone");
  refuses(leg.substr(0, 250), "[motionlang.io.402]");
  refuses(with(leg, "    dof rx\n  end\n", "    dof rx\n"), "the bone 'shin' has no 'end'");
  std::string many = ":bonedata";
  for (int i = 0; i < 4200; ++i) many += " begin name b" + std::to_string(i) + " end\n";
  refuses(many, "[motionlang.io.405]");
  CHECK(ml::to_skeleton(ml::parse_asf("")).size() == 1);
}

TEST_CASE("AMC: malformed motions are refused where they are wrong") {
  const auto asf = ml::parse_asf(leg);
  auto refuses = [&](const std::string& text, const char* message) {
    CHECK_THROWS_WITH_AS(ml::parse_amc(text, asf, {}, "m.amc"), Contains(message), ml::io_error);
  };
  refuses("1\nelbow 3", "[motionlang.io.403] m.amc:2:1: the skeleton has no bone 'elbow'");
  refuses("shin 3", "numbers of 'shin' before the first frame");
  refuses("1\nshin x", "expected a value of the motion, found 'x'");
  refuses("1\nroot 1 2 3", "[motionlang.io.402]");
  refuses("", "no frame");
  refuses("#!OML\n:DEGREES\n", "[motionlang.io.402]");
  refuses("1\nshin nan", "[motionlang.io.403]");
  refuses("1\n shin 90 7\n2\n", "[motionlang.io.403] m.amc:2:10: '7' is one value too many");
  refuses("1 2\nshin 90", "[motionlang.io.403] m.amc:1:3: '2' is one value too many");
  refuses("\xEF\xBB\xBFshin 90", "m.amc:1:1: numbers of 'shin' before the first frame");
  refuses("1 shin 0" + others + "1 shin 0" + others, "[motionlang.io.403] m.amc:2:1: frame 1 after frame 1");
  refuses("4 shin 0" + others + "6 shin 0" + others, "[motionlang.io.403] m.amc:2:1: frame 6 after frame 4");
  refuses("99999999999999999999", "[motionlang.io.403] m.amc:1:1: frame 99999999999999999999, a number too large");
  refuses("1 shin 0" + others + "shin 0", "[motionlang.io.403] m.amc:2:1: frame 1 has numbers of 'shin' twice");
  refuses("1 shin 0" + others + "2" + others + "3",
          "m.amc:3:1: frame 2, which ends here, has no numbers of 'shin', unlike those before it");
  refuses("1" + others + "2" + others + "shin 0", "m.amc:3:1: frame 2 has numbers of 'shin', unlike those before it");
  CHECK_THROWS_WITH_AS(ml::parse_amc("1 shin 0" + others, asf, {.fps = 0}), Contains("[motionlang.config.101]"),
                       ml::config_error);
  CHECK_THROWS_WITH_AS(
      ml::parse_amc("1 root 1e308 0 0 0 0 0 shin 0 foot 0 0", ml::parse_asf(with(leg, "0.45", "1e-9"))),
      Contains("[motionlang.numeric.301]"), ml::numeric_error);
}

TEST_CASE("AMC: a small file cannot ask for much memory") {
  std::string text = ":bonedata";
  for (int i = 0; i < 4000; ++i) text += " begin name b" + std::to_string(i) + " end\n";
  text += ":hierarchy begin root";
  for (int i = 0; i < 4000; ++i) text += " b" + std::to_string(i);
  auto asf = ml::parse_asf(text + "\nend");
  std::string many;
  for (int i = 0; i < 12600; ++i) many += std::to_string(i) + "\n";
  CHECK_THROWS_WITH_AS(ml::parse_amc(many, asf), Contains("[motionlang.io.405]"), ml::io_error);
}
