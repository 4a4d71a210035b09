// The body of a skeleton, and the film strip: poses, labels, tracks, and what must not get into an SVG file.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include <motionlang/core/rng.hpp>
#include <motionlang/formats/figure.hpp>
#include <motionlang/kinematics/joint_sides.hpp>
#include <motionlang/view/detail/film_strip_drawing.hpp>
#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/detail/stroke_font.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/track.hpp>

#include "../../support/markup.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

ml::Motion standing(const ml::Skeleton& skeleton, int frames = 1) {
  ml::Motion motion{skeleton, 20, {}, {}, "standing"};
  motion.root.assign(static_cast<std::size_t>(frames), skeleton.offset(0));
  motion.local.assign(motion.root.size() * skeleton.parents.size(), ml::Quaternion<double>::identity());
  return motion;
}

ml::Skeleton chain(int joints) {
  std::vector<ml::Joint> list{{"j0", "", {0, 1, 0}}};
  for (int j = 1; j < joints; ++j) list.push_back({"j" + std::to_string(j), "j" + std::to_string(j - 1), {0, 0.01, 0}});
  return ml::Skeleton::from_joints(list);
}

/// No NaN or infinity, nothing loaded from elsewhere.
void check_sound(const std::string& svg) {
  CHECK(is_well_formed(svg));
  CHECK(svg.find("nan") == std::string::npos);
  CHECK(svg.find("inf") == std::string::npos);
  CHECK(occurrences(svg, "http") == 1);  // the name space
  CHECK(svg.find("href") == std::string::npos);
}

const ml::RoundCone* cone_to(const ml::Figure& figure, const ml::Skeleton& s, const char* joint) {
  const int j = s[joint];
  for (const auto& c : figure.cones) {
    if (c.joint == s.parent(j) && c.to == s.offset(j) && c.from == ml::Vec3{0.0, 0.0, 0.0}) return &c;
  }
  return nullptr;
}

}  // namespace

TEST_CASE("the body of SMPL: sides, a trunk thicker than limbs, a head") {
  const auto& s = ml::smpl24_skeleton();
  const ml::Figure figure = ml::make_figure(s);
  REQUIRE(cone_to(figure, s, "left_knee"));
  REQUIRE(cone_to(figure, s, "spine2"));
  CHECK(cone_to(figure, s, "left_knee")->side == ml::Side::left);
  CHECK(cone_to(figure, s, "right_wrist")->side == ml::Side::right);
  CHECK(cone_to(figure, s, "spine2")->side == ml::Side::middle);
  CHECK(cone_to(figure, s, "left_hip")->side == ml::Side::middle);
  CHECK(cone_to(figure, s, "spine2")->radius_to > cone_to(figure, s, "left_knee")->radius_from);
  CHECK(cone_to(figure, s, "left_knee")->radius_from > cone_to(figure, s, "left_ankle")->radius_to);
  CHECK(figure.cones.back().joint == s["head"]);
  CHECK(figure.size == doctest::Approx(1.6).epsilon(0.05));
  // mirrored bones have mirrored bodies
  CHECK(cone_to(figure, s, "left_elbow")->radius_to == cone_to(figure, s, "right_elbow")->radius_to);
}

TEST_CASE("the body does not depend on names or scale") {
  ml::Skeleton s = ml::smpl24_skeleton();
  for (std::size_t j = 0; j < s.names.size(); ++j) s.names[j] = "bone" + std::to_string(j);
  for (auto& o : s.offsets) o = 0.5 * o;
  const ml::Figure a = ml::make_figure(ml::smpl24_skeleton()), b = ml::make_figure(s);
  REQUIRE(a.cones.size() == b.cones.size());
  for (std::size_t i = 0; i < a.cones.size(); ++i) {
    CHECK(a.cones[i].joint == b.cones[i].joint);
    CHECK(a.cones[i].side == b.cones[i].side);
    CHECK(0.5 * a.cones[i].radius_to == doctest::Approx(b.cones[i].radius_to));
  }
}

TEST_CASE("sides in names") {
  for (const char* name :
       {"left_hip", "LeftArm", "mixamorig:LeftLeg", "thigh_l", "upper_arm.L", "lHand", "LHipJoint", "LK"}) {
    CHECK_MESSAGE(ml::detail::side_of_name(name) == ml::Side::left, name);
  }
  for (const char* name : {"right_hip", "RThumb", "Shoulder_R", "rShin", "hand-r"}) {
    CHECK_MESSAGE(ml::detail::side_of_name(name) == ml::Side::right, name);
  }
  for (const char* name : {"pelvis", "LowerBack", "root", "r", "", "neck", "Head"}) {
    CHECK_MESSAGE(ml::detail::side_of_name(name) == ml::Side::middle, name);
  }
}

TEST_CASE("a root on the floor has no trunk above it") {
  std::vector<ml::Joint> joints{{"root", "", {0, 0, 0}}, {"hips", "root", {0, 0.95, 0}}};
  const auto& smpl = ml::smpl24_skeleton();
  for (int j = 1; j < smpl.size(); ++j) {
    const std::string parent = smpl.parent(j) == 0 ? "hips" : smpl.name(smpl.parent(j));
    joints.push_back({smpl.name(j), parent, smpl.offset(j)});
  }
  const ml::Figure figure = ml::make_figure(ml::Skeleton::from_joints(joints));
  for (const auto& c : figure.cones) CHECK(c.joint != 0);
}

TEST_CASE("feet that are ends of bones are drawn like those with joints of toes") {
  const auto& smpl = ml::smpl24_skeleton();
  std::vector<ml::Joint> joints;
  std::vector<ml::Vec3<double>> ends;
  for (int j = 0; j < smpl.size(); ++j) {
    const std::string& name = smpl.name(j);
    if (name == "left_foot" || name == "right_foot") continue;
    joints.push_back({name, j == 0 ? "" : smpl.name(smpl.parent(j)), smpl.offset(j)});
    const bool ankle = name == "left_ankle" || name == "right_ankle";
    ends.push_back(ankle ? smpl.offset(smpl[name == "left_ankle" ? "left_foot" : "right_foot"]) : ml::Vec3<double>{});
  }
  ml::Skeleton s = ml::Skeleton::from_joints(joints);
  CHECK(ml::make_figure(s).cones.size() == ml::make_figure(smpl).cones.size() - 4);
  s.ends = ends;
  const ml::Figure figure = ml::make_figure(s);
  CHECK(figure.cones.size() == ml::make_figure(smpl).cones.size());
  for (const char* name : {"left_ankle", "right_ankle"}) {
    const auto last = std::find_if(figure.cones.rbegin(), figure.cones.rend(),
                                   [&](const ml::RoundCone& c) { return c.joint == s[name]; });
    REQUIRE(last != figure.cones.rend());
    CHECK(last->to.z > 0.1);    // the sole goes ahead
    CHECK(last->from.z < 0.0);  // from the heel
    CHECK(last->side == ml::detail::side_of_name(name));
  }
}

TEST_CASE("a film strip of a walk with texts") {
  const TemporaryFolder folder;
  const ml::Motion motion = synthetic::walk({.frames = 120, .turn = 0.3});
  const std::vector<ml::Track> tracks{{"walking in a circle", 0, 6, {"legs"}},
                                      {"<b>bold & \"quoted\"</b> \xFF", 2, 5, {"left arm", "right arm"}},
                                      {"beyond both ends", -3, 99}};
  ml::write_film_strip(folder / "walk.svg", motion, tracks, {.poses = 7, .title = "a & b"});
  const std::string svg = ml::read_file(folder / "walk.svg");
  check_sound(svg);
  CHECK(occurrences(svg, "class=\"pose\"") == 7);
  CHECK(occurrences(svg, " s</text>") == 7);
  CHECK(svg.find("walking in a circle<tspan opacity=\".75\"> · legs") != std::string::npos);
  CHECK(svg.find("<title>a &amp; b</title>") != std::string::npos);
  CHECK(svg.find("&lt;b&gt;bold &amp; &quot;quoted&quot;&lt;/b&gt; \uFFFD") != std::string::npos);
  CHECK(svg.size() < 100'000);
  CHECK(svg == ml::film_strip_svg(motion, tracks, {.poses = 7, .title = "a & b"}));
}

TEST_CASE("as many poses as the motion needs, in rows of twelve") {
  const auto poses = [](const ml::Motion& m) { return occurrences(ml::film_strip_svg(m), "class=\"pose\""); };
  CHECK(poses(standing(ml::smpl24_skeleton(), 100)) == 3);  // nothing moves
  const int second = poses(synthetic::walk({.frames = 20})), four = poses(synthetic::walk({.frames = 80}));
  CHECK((second >= 3 && second < 8));
  CHECK((four > second && four <= 12));
  CHECK(poses(synthetic::walk({.frames = 4000})) == 48);  // at most four rows
  // Two rows: each has its floor, its own times and the texts of its time.
  const ml::Motion walk = synthetic::walk({.frames = 201});
  const std::vector<ml::Track> tracks{{"first", 0, 2}, {"all along", 0, 10}, {"second", 8, 10}};
  const std::string svg = ml::film_strip_svg(walk, tracks, {.poses = 20, .title = "long"});
  check_sound(svg);
  CHECK(occurrences(svg, "class=\"pose\"") == 20);
  CHECK(occurrences(svg, "url(#floor)") == 2);
  CHECK(occurrences(svg, ">first</text>") == 1);
  CHECK(occurrences(svg, ">second</text>") == 1);
  CHECK(occurrences(svg, ">all along</text>") == 2);
  CHECK(occurrences(svg, ">long</text>") == 1);
  CHECK(svg.find(">first</text>") < svg.find(">5.25 s</text>"));  // the second row begins at frame 105
  CHECK(svg.find(">5.25 s</text>") < svg.find(">second</text>"));
  const auto height = [](const std::string& s) { return std::stod(s.substr(s.find(" height=\"") + 9)); };
  CHECK(height(svg) > 1.4 * height(ml::film_strip_svg(walk, tracks, {.poses = 10})));
  // A narrow picture has fewer poses in a row.
  CHECK(occurrences(ml::film_strip_svg(walk, {}, {.width = 400}), "url(#floor)") >
        occurrences(ml::film_strip_svg(walk), "url(#floor)"));
}

TEST_CASE("one frame, one joint, many joints, all skeletons") {
  check_sound(ml::film_strip_svg(synthetic::walk({.frames = 1})));
  CHECK(occurrences(ml::film_strip_svg(synthetic::walk({.frames = 3}), {}, {.poses = 12}), "class=\"pose\"") == 3);
  check_sound(ml::film_strip_svg(standing(ml::Skeleton::from_joints({{"only", "", {0, 1, 0}}}), 5)));
  check_sound(ml::film_strip_svg(standing(ml::Skeleton::from_joints({{"a", "", {}}, {"b", "a", {}}}), 5)));
  check_sound(ml::film_strip_svg(standing(chain(300), 2)));
  check_sound(ml::film_strip_svg(standing(ml::kit21_skeleton(), 9)));
  check_sound(ml::film_strip_svg(standing(ml::humanml3d22_skeleton(), 9)));
}

TEST_CASE("a film strip in pixels shows what the SVG does") {
  const ml::Motion motion = synthetic::walk({.frames = 120, .turn = 0.3});
  const std::vector<ml::Track> tracks{{"walking", 0, 6, {"legs"}}, {"\u00E9t\u00E9 \xFF", 2, 5}};
  const ml::FilmStripOptions options{.poses = 6, .width = 600, .resolution = 1.5};
  const ml::Picture picture = ml::film_strip_picture(motion, tracks, options);
  CHECK(picture.width == 900);
  CHECK(picture.rgb.size() == static_cast<std::size_t>(3 * picture.width * picture.height));
  const std::string svg = ml::film_strip_svg(motion, tracks, options);
  const double height = std::stod(svg.substr(svg.find(" height=\"") + 9));
  CHECK(picture.height == static_cast<ml::Index>(std::ceil(1.5 * height)));
  // every pose has pixels of both sides' own colours, in its own cell
  const auto count = [&](int r, int g, int b, double from, double to) {
    int n = 0;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
      const double x = static_cast<double>((i / 3) % 900) / 900;
      n += x >= from && x < to && picture.rgb[i] == r && picture.rgb[i + 1] == g && picture.rgb[i + 2] == b;
    }
    return n;
  };
  for (int cell = 0; cell < 6; ++cell) {
    CAPTURE(cell);
    CHECK(count(98, 108, 122, cell / 6.0, (cell + 1) / 6.0) > 100);
  }
  CHECK(count(230, 97, 44, 0, 1) > 300);
  CHECK(count(38, 118, 186, 0, 1) > 300);
  CHECK(count(0x2b, 0x6c, 0xb0, 0, 1) > 5000);  // the bar of the first text
  CHECK(count(255, 255, 255, 0, 1) > 100000);
  CHECK_THROWS_WITH_AS(ml::film_strip_picture(motion, {}, {.resolution = 0}), doctest::Contains("101"),
                       ml::config_error);
  CHECK_THROWS_WITH_AS(ml::film_strip_picture(motion, {}, {.resolution = 99}), doctest::Contains("101"),
                       ml::config_error);
  CHECK(ml::film_strip_picture(standing(chain(300), 2), {}, {.width = 100, .resolution = 1}).width == 100);
}

TEST_CASE("letters of the picture's font") {
  for (char c = '!'; c <= '~'; ++c) {
    const ml::detail::StrokedText letter = ml::detail::stroke_text(std::string(1, c));
    CAPTURE(c);
    CHECK(!letter.strokes.empty());
    for (const auto& stroke : letter.strokes) {
      CHECK(!stroke.empty());
      for (const auto& p : stroke) CHECK((p.x <= 8 && p.y <= 14));
    }
  }
  CHECK(ml::detail::stroke_text("il").width < ml::detail::stroke_text("mw").width);
  CHECK(ml::detail::stroke_text(" ").strokes.empty());
  CHECK(ml::detail::stroke_text("\u4E2D").strokes.size() == 1);  // a box
}

TEST_CASE("what cannot be drawn is an error") {
  ml::Motion motion = synthetic::walk({.frames = 2});
  CHECK_THROWS_WITH_AS(ml::film_strip_svg(motion, {}, {.width = 10}), doctest::Contains("101"), ml::config_error);
  const std::vector<ml::Track> never{{"walk", std::nan(""), 1}};
  CHECK_THROWS_WITH_AS(ml::film_strip_svg(motion, never), doctest::Contains("film strip: track 'walk'"),
                       ml::config_error);
  CHECK_THROWS_WITH_AS(ml::film_strip_svg(motion, {}, {.width = INFINITY}), doctest::Contains("film strip: width inf"),
                       ml::config_error);
  ml::Motion far = motion;
  far.root[1].x = 1e39;
  CHECK_THROWS_WITH_AS(
      ml::film_strip_svg(far),
      doctest::Contains(
          "[motionlang.numeric.301] Motion 'walk': joint 'pelvis' of frame 1 or one of its children is at "
          "(1e+39, "),
      ml::numeric_error);
  far = motion;
  far.skeleton.offsets[4].y = -1e200;
  CHECK_THROWS_WITH_AS(ml::film_strip_svg(far), doctest::Contains("[motionlang.numeric.301] "), ml::numeric_error);
  far = motion;
  far.fps = 1e-309;
  CHECK_THROWS_WITH_AS(ml::film_strip_svg(far), doctest::Contains("frame rate 1e-309"), ml::config_error);
  motion.root[1].x = std::nan("");
  CHECK_THROWS_WITH_AS(ml::film_strip_svg(motion), doctest::Contains("301"), ml::numeric_error);
  motion.root.pop_back();
  CHECK_THROWS_WITH_AS(ml::film_strip_svg(motion), doctest::Contains("205"), ml::shape_error);
  CHECK_THROWS_WITH_AS(ml::film_strip_svg(standing(ml::smpl24_skeleton(), 0)), doctest::Contains("101"),
                       ml::config_error);
}

TEST_CASE("numbers and texts in markup") {
  CHECK(ml::detail::fixed(1.0) == "1");
  CHECK(ml::detail::fixed(0.25, 2) == "0.25");
  CHECK(ml::detail::fixed(-0.01) == "0");
  CHECK(ml::detail::fixed(100, 0) == "100");
  CHECK(ml::detail::escape_markup("a\x01<\U0001F3C3") == "a\uFFFD&lt;\U0001F3C3");
}

TEST_CASE("pixels: many cones of a piece are painted as each pixel's nearest one says") {
  ml::Philox draw{.seed = 8};
  const auto number = [&](double low, double high) { return low + (high - low) * draw.uniform(); };
  for (const double scale : {1.0, 2.0, 0.7}) {
    for (int i = 0; i < 4; ++i) {
      std::vector<ml::detail::RoundCone2> cones(static_cast<std::size_t>(1 + 12 * draw.uniform()));
      for (auto& c : cones) {
        const ml::detail::Point2 from{number(-10, 70), number(-10, 50)};
        const double far = draw.uniform() < 0.3 ? 1 : 40;  // some circles hold the other one
        c = {from, number(0.2, 8), {from.x + number(-far, far), from.y + number(-far, far)}, number(0.2, 8)};
        if (draw.uniform() < 0.1) c.to = c.from;
      }
      ml::detail::PixelSurface surface(60, 40, scale);
      surface.piece(cones, {10, 20, 30});
      const ml::Picture picture = surface.finish();
      double worst = 0;
      // A cone is all circles between its ends: the distance to the nearest of many of them.
      for (ml::Index y = 0; y < picture.height; ++y) {
        for (ml::Index x = 0; x < picture.width; ++x) {
          const double px = (static_cast<double>(x) + 0.5) / scale, py = (static_cast<double>(y) + 0.5) / scale;
          double d = 1e9;
          for (const auto& c : cones) {
            for (int k = 0; k <= 400; ++k) {
              const double t = k / 400.0;
              d = std::min(
                  d, std::hypot(px - c.from.x - t * (c.to.x - c.from.x), py - c.from.y - t * (c.to.y - c.from.y)) -
                         (1 - t) * c.radius_from - t * c.radius_to);
            }
          }
          const auto red = static_cast<int>(picture.rgb[static_cast<std::size_t>(3 * (y * picture.width + x))]);
          const double cover = std::clamp(0.5 - d * scale, 0.0, 1.0);
          worst = std::max(worst, std::abs(red - (255 + cover * (10 - 255))));  // the edge is white on white
        }
      }
      CHECK(worst <= 6);
    }
  }
}

TEST_CASE("thousands of joints are a picture in little time") {
  ml::Philox draw{.seed = 1};
  std::vector<ml::Joint> joints{{"R", "", {0, 0, 0}}};
  for (int i = 0; i < 2000; ++i) {
    const double u = 6.28 * draw.uniform(), v = 2 * draw.uniform() - 1, w = std::sqrt(1 - v * v);
    joints.push_back({"J" + std::to_string(i), "R", {w * std::cos(u), v, w * std::sin(u)}});
  }
  const ml::Motion motion = standing(ml::Skeleton::from_joints(joints), 5);
  const auto before = std::chrono::steady_clock::now();
  const ml::Picture picture = ml::film_strip_picture(motion);
  CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(20));  // 2 s where nothing else runs
  CHECK(picture.width == 2560);
}
