// The named feature vectors: sizes, and joints and clips that come back.
#include <doctest/doctest.h>

#include <set>

#include <motionlang/features/describe_features.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

bool is_guo(const ml::MotionFeatures& f) { return f.name == "guoh3d" || f.name == "kit"; }

/// Distances between joints of one frame, which no turn or shift of the world changes.
std::vector<double> spans(std::span<const ml::Vec3<double>> joints, std::size_t frame, std::size_t count) {
  std::vector<double> out;
  for (std::size_t j = 0; j < count; ++j) out.push_back(ml::norm(joints[frame * count + j] - joints[frame * count]));
  return out;
}

}  // namespace

TEST_CASE("every feature vector gives the poses back") {
  for (const ml::MotionFeatures& f : ml::all_motion_features) {
    CAPTURE(f.name);
    const auto motion = synthetic::walk({.frames = 40, .fps = f.fps, .turn = 0.3});
    const auto rows = f.from_motion(motion);
    REQUIRE(std::ssize(rows) % f.width == 0);
    const auto frames = std::ssize(rows) / f.width;
    CHECK(frames == (is_guo(f) ? 39 : 40));
    const auto joints = f.joints_of(rows);
    REQUIRE(std::ssize(joints) == frames * f.joints);
    const auto n = static_cast<std::size_t>(f.joints);
    const auto truth =
        n == 21 ? ml::retarget(motion, ml::kit21_skeleton()).positions() : ml::detail::first_joints(motion, n);
    for (const std::size_t frame : {std::size_t{0}, std::size_t{20}, std::size_t{37}}) {
      const auto a = spans(joints, frame, n), b = spans(truth, frame, n);
      for (std::size_t j = 0; j < n; ++j) {
        if (f.name != "guoh3d")  // its bones are those of another body
          CHECK(a[j] == doctest::Approx(b[j]).epsilon(1e-6));
        else
          CHECK(a[j] == doctest::Approx(b[j]).epsilon(0.25));
      }
    }
    // the way over the ground, whatever the units of the body
    auto way = [n](std::span<const ml::Vec3<double>> p) {
      const auto d = p[37 * n] - p[0];
      return std::hypot(d.x, d.z);
    };
    CHECK(way(joints) == doctest::Approx(way(truth)).epsilon(f.name == "guoh3d" ? 0.2 : 1e-6));
    CHECK(joints[0].y == doctest::Approx(truth[0].y).epsilon(0.2));  // upright
    const auto left = [n](std::span<const ml::Vec3<double>> p) {     // of the right hip, seen from behind
      const auto across = p[n == 21 ? 11 : 1] - p[n == 21 ? 16 : 2], up = p[n == 21 ? 4 : 15] - p[0],
                 ahead = p[37 * n] - p[0];
      return ml::dot(ml::cross(up, ahead), across);
    };
    CHECK(left(truth) > 0);
    CHECK(left(joints) > 0);  // not reflected
    CHECK(ml::motion_of_rows(f, rows).skeleton.names == f.skeleton().names);
  }
}

TEST_CASE("ACTOR's rows of any representation give the clip back") {
  const auto motion = synthetic::walk({.frames = 20, .turn = 0.3});
  for (const auto form :
       {ml::PoseRepresentation::rotvec, ml::PoseRepresentation::rotmat, ml::PoseRepresentation::rot6d}) {
    const ml::ActorFeatureOptions options{.rotations = form};
    const auto rows = ml::actor_rows_of_motion(motion, options);
    CHECK(std::ssize(rows) == 20 * 25 * ml::size(form));
    const auto back = ml::motion_of_actor(ml::actor_inverse(std::span<const double>(rows), 24, options), 20);
    for (std::size_t i = 0; i < motion.local.size(); ++i) CHECK(ml::distance(back.local[i], motion.local[i]) < 1e-6);
    const auto way = back.root[19] - back.root[0], walked = motion.root[19] - motion.root[0];
    CHECK(ml::norm(way - walked) < 1e-9);
  }
  CHECK(std::ssize(ml::actor_rows_of_motion(motion, {.translation = false, .global = false})) == 20 * 23 * 6);
  CHECK_ERROR(ml::actor_rows_of_motion(ml::Motion{ml::kit21_skeleton(), 20, {}, {}}), "[motionlang.config.103]");
}

TEST_CASE("every feature vector has a layout, and a raised arm changes no other part's positions and rotations") {
  for (const ml::MotionFeatures& f : ml::all_motion_features) {
    CAPTURE(f.name);
    const auto layout = f.layout();
    CHECK(layout.size == f.width);
    layout.validate();
    auto motion = synthetic::walk({.frames = 8, .fps = f.fps});
    const auto before = f.from_motion(motion);
    const auto elbow = static_cast<std::size_t>(motion.skeleton["left_elbow"]);
    for (ml::Index t = 0; t < motion.frames(); ++t) {
      auto& bent = motion.rotations(t)[elbow];
      bent = ml::from_axis_angle(ml::Vec3<double>{0, 1, 0}, -0.5) * bent;
    }
    const auto after = f.from_motion(motion);
    REQUIRE(after.size() == before.size());
    std::set<ml::BodyPart> changed;
    for (int p = 0; p < ml::body_part_count; ++p) {
      const auto part = static_cast<ml::BodyPart>(p);
      for (const ml::Index i : layout.indices(part)) {
        for (std::size_t at = static_cast<std::size_t>(i); at < after.size(); at += static_cast<std::size_t>(f.width)) {
          if (std::abs(after[at] - before[at]) > 1e-6) changed.insert(part);
        }
      }
    }
    // the heading of rifke64 is that of knees and elbows: all parts turn
    if (f.name == "rifke64")
      CHECK(changed.contains(ml::BodyPart::left_arm));
    else
      CHECK(changed == std::set{ml::BodyPart::left_arm});
  }
}

TEST_CASE("MMM's joints are in KIT's units, from a clip on KIT's joints as well") {
  const auto motion = synthetic::walk({.frames = 20, .fps = 12.5});
  for (const char* name : {"kit", "rifke64"}) {
    CAPTURE(name);
    const auto& f = ml::motion_features(name);
    const auto rows = f.from_motion(motion);
    const double height = rows[f.name == "kit" ? 3 : 0] / 640;  // of the root above the floor
    CHECK(height > 0.8);
    CHECK(height < 1);
    CHECK(lists::largest_difference(rows, f.from_motion(ml::retarget(motion, ml::kit21_skeleton()))) < 1e-9);
    CHECK_ERROR(f.from_motion(synthetic::walk({.frames = 20}, ml::humanml3d22_skeleton())), "[motionlang.config.103]");
  }
}

TEST_CASE("smplvelp as published turns by what is not a heading") {
  auto motion = synthetic::walk({.frames = 10, .fps = 12.5});
  const auto tilt = ml::from_axis_angle(ml::normalized(ml::Vec3<double>{1, 1, 0}), 1.0);
  for (ml::Index f = 0; f < motion.frames(); ++f) motion.rotations(f)[0] = tilt * motion.rotations(f)[0];
  auto turned = motion;
  const auto turn = ml::from_axis_angle(ml::Vec3<double>{0, 1, 0}, 0.7);
  for (ml::Index f = 0; f < motion.frames(); ++f) {
    turned.rotations(f)[0] = turn * turned.rotations(f)[0];
    turned.root[static_cast<std::size_t>(f)] = ml::rotate(turn, turned.root[static_cast<std::size_t>(f)]);
  }
  const auto &exact = ml::motion_features("smplvelp"), &published = ml::motion_features("smplvelp-published");
  CHECK(lists::largest_difference(exact.from_motion(motion), exact.from_motion(turned)) < 1e-9);
  CHECK(lists::largest_difference(published.from_motion(motion), published.from_motion(turned)) > 0.01);
}

TEST_CASE("clips come back where the rows have rotations") {
  for (const char* name : {"smplvelp", "smplrifke", "actor"}) {
    CAPTURE(name);
    const auto& f = ml::motion_features(name);
    const auto motion = synthetic::walk({.frames = 30, .fps = f.fps});
    const auto rows = f.from_motion(motion);
    REQUIRE((f.to_motion != nullptr));
    const auto back = f.to_motion(rows, f.fps);
    CHECK(back.fps == f.fps);
    CHECK(back.frames() == 30);
    const auto again = f.from_motion(back);
    REQUIRE(again.size() == rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) CHECK(again[i] == doctest::Approx(rows[i]).epsilon(1e-4).scale(0.1));
  }
  CHECK((ml::motion_features("guoh3d").to_motion == nullptr));
}

TEST_CASE("every number of every feature vector has one meaning, and the body part of its joint") {
  for (const ml::MotionFeatures& f : ml::all_motion_features) {
    CAPTURE(f.name);
    const auto layout = f.layout();
    CHECK(layout.size == f.width);
    std::vector<ml::BodyPart> part_of(static_cast<std::size_t>(f.width));
    for (const std::string_view name : ml::body_part_names) {
      const auto part = *ml::parse_body_part(name);
      for (const ml::Index i : layout.indices(part)) part_of[static_cast<std::size_t>(i)] = part;
    }
    const bool mmm = f.skeleton().size() == 21;
    ml::Index end = 0;
    for (const ml::FeatureRange& r : f.ranges) {
      CAPTURE(r.meaning);
      CHECK(r.numbers.begin == end);
      REQUIRE(r.numbers.size() > 0);
      end = r.numbers.end;
      REQUIRE(end <= f.width);
      CHECK(!r.meaning.empty());
      CHECK(!r.unit.empty());
      const ml::Index joints = r.joints.size(), each = joints == 0 ? r.numbers.size() : r.numbers.size() / joints;
      if (joints > 0) {
        REQUIRE(each * joints == r.numbers.size());
        REQUIRE(r.joints.end <= f.skeleton().size());
      }
      for (ml::Index i = r.numbers.begin; i < r.numbers.end; ++i) {
        const auto joint = static_cast<std::size_t>(r.joints.begin + (i - r.numbers.begin) / each);
        const auto of_joint = mmm ? ml::kit_part_of_joint[joint] : ml::smpl_part_of_joint[joint];
        CHECK(part_of[static_cast<std::size_t>(i)] == (joints == 0 ? ml::BodyPart::legs : of_joint));
      }
    }
    CHECK(end == f.width);
  }
}

TEST_CASE("the tables of meanings have the ranges and units of the publications") {
  struct Published {
    std::string_view name;
    std::size_t row;
    ml::IndexRange numbers;
    std::string_view begins, unit;
  };
  const std::vector<Published> published{
      {"guoh3d", 0, {0, 1}, "half the turn", "rad/frame"},  // HumanML3D motion_representation.ipynb
      {"guoh3d", 1, {1, 3}, "velocity of the root", "m/frame"},
      {"guoh3d", 4, {67, 193}, "rotation", "1"},
      {"guoh3d", 6, {259, 263}, "left ankle, left foot", "1"},
      {"kit", 2, {3, 4}, "height of the root", "m/640"},  // there and 10
      {"kit", 5, {184, 247}, "velocity", "m/640/frame"},
      {"rifke", 1, {1, 64}, "position", "m"},  // TMR src/rifke.py
      {"rifke", 2, {64, 65}, "turn of the heading to the next frame", "rad/frame"},
      {"rifke64", 2, {61, 62}, "turn of the heading since the frame before", "rad/frame"},  // TEMOS rifke.py
      {"rifke64", 3, {62, 64}, "velocity of the root since", "m/640/frame"},
      {"smplvelp", 1, {1, 3}, "velocity", "m/frame"},  // TEMOS rots2rfeats/smplvelp.py
      {"smplvelp-published", 2, {3, 9}, "rotation in the world", "1"},
      {"smplrifke", 2, {3, 4}, "turn of the heading to the next frame", "rad/frame"},  // STMC smplrifke_feats.py
      {"smplrifke", 5, {136, 205}, "position relative to the pelvis", "m"},
      {"actor", 2, {144, 147}, "way of the root since frame 0", "m"},  // ACTOR src/datasets/dataset.py
  };
  for (const Published& p : published) {
    CAPTURE(p.name);
    CAPTURE(p.row);
    const auto ranges = ml::motion_features(p.name).ranges;
    REQUIRE(p.row < ranges.size());
    CHECK((ranges[p.row].numbers == p.numbers));
    CHECK(ranges[p.row].meaning.starts_with(p.begins));
    CHECK(ranges[p.row].unit == p.unit);
  }
}

TEST_CASE("rows and rates that are not finite are refused by every feature vector") {
  for (const ml::MotionFeatures& f : ml::all_motion_features) {
    auto rows = f.from_motion(synthetic::walk({.frames = 20}));
    CHECK_ERROR(ml::motion_of_rows(f, rows, std::numeric_limits<double>::infinity()), "[motionlang.config.101]");
    rows[static_cast<std::size_t>(2 * f.width + 4)] = std::nan("");
    CHECK_ERROR(ml::motion_of_rows(f, rows), "[motionlang.numeric.301] motion_of_rows: number 4 of frame 2");
  }
}

TEST_CASE("unknown names and other skeletons are refused") {
  CHECK_ERROR(ml::motion_features("guo"),
              "[motionlang.config.103] motion_features: 'guo' is not one of guoh3d, kit, rifke");
  ml::Motion none;
  CHECK_ERROR(ml::motion_features("guoh3d").from_motion(none), "[motionlang.config.103]");
}

TEST_CASE("features are explained: every value, each body part, the joints") {
  const ml::MotionFeatures& f = ml::motion_features("rifke");
  CHECK(ml::line_about_features(f) == "rifke: 67 numbers in a frame, 12.5 frames per second, skeleton of 24 joints\n");
  const std::string text = ml::describe_features(f);
  CHECK(text.starts_with(ml::line_about_features(f)));
  ml::Index next = 0;  // the ranges follow each other to the last value
  for (const ml::FeatureRange& r : f.ranges) {
    CHECK(r.numbers.begin == next);
    next = r.numbers.end;
    const std::string range = r.numbers.size() == 1 ? std::to_string(r.numbers.begin)
                                                    : std::to_string(r.numbers.begin) + "-" + std::to_string(next - 1);
    CHECK_MESSAGE(text.find("\n  " + range + " ") != std::string::npos, range);
  }
  CHECK(next == 67);
  CHECK(text.find("\n  left arm   ") < text.find("\njoints and their parents\n    0 pelvis"));
}
