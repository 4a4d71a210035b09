// Retargeting: rest poses, local axes, chains of other lengths, scale, floor, tables.
#include <doctest/doctest.h>

#include <cctype>
#include <map>

#include <motionlang/core/rng.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/kinematics/skeleton.hpp>
#include <motionlang/kinematics/skeleton_table.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>

#include "../../support/rigs.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;

namespace {

/// One frame in which every joint has the given world rotation.
ml::Motion posed(const ml::Skeleton& skeleton, const std::vector<ml::Quaternion<double>>& world) {
  ml::Motion motion{skeleton, 30, {skeleton.offset(0)}, {}, "posed"};
  for (int j = 0; j < skeleton.size(); ++j) {
    const int p = skeleton.parent(j);
    const auto up = p < 0 ? ml::Quaternion<double>::identity() : world[static_cast<std::size_t>(p)];
    motion.local.push_back(inverse(up) * world[static_cast<std::size_t>(j)]);
  }
  return motion;
}

/// Angle in degrees between the bones of two clips in frame 0.
double bone_angle(const ml::Motion& a, const ml::Motion& b, const char* from, const char* to) {
  const auto p = a.positions(), q = b.positions();
  auto bone = [&](const ml::Motion& m, const auto& x) {
    return ml::normalized(x[static_cast<std::size_t>(m.skeleton[to])] - x[static_cast<std::size_t>(m.skeleton[from])]);
  };
  return std::acos(std::min(1.0, dot(bone(a, p), bone(b, q)))) * 180 / std::numbers::pi;
}

ml::Skeleton smpl_with(const std::vector<std::pair<std::string, ml::Vec3<double>>>& offsets) {
  ml::Skeleton s = ml::smpl24_skeleton();
  for (const auto& [name, offset] : offsets) s.offsets[static_cast<std::size_t>(s[name])] = offset;
  return s;
}

/// Legs apart and arms 30 degrees down in the zero pose, as in CMU's skeletons.
ml::Skeleton spread() {
  const double c = std::sqrt(0.75), s = 0.5;
  return smpl_with({{"left_knee", {0.41 * s, -0.41 * c, 0}},
                    {"right_knee", {-0.41 * s, -0.41 * c, 0}},
                    {"left_ankle", {0.41 * s, -0.41 * c, 0}},
                    {"right_ankle", {-0.41 * s, -0.41 * c, 0}},
                    {"left_elbow", {0.27 * c, -0.27 * s, 0}},
                    {"right_elbow", {-0.27 * c, -0.27 * s, 0}}});
}

}  // namespace

TEST_CASE("a skeleton follows itself") {
  const auto walk = synthetic::walk({.frames = 30, .turn = 1});
  const auto same = ml::retarget(walk, ml::SkeletonMap(walk.skeleton), {.floor = false});
  const auto p = walk.positions(), q = same.positions();
  for (std::size_t i = 0; i < p.size(); ++i) CHECK(ml::norm(p[i] - q[i]) < 1e-9);
}

TEST_CASE(
    "on its own skeleton a motion stays as it is; on another, joints that no table knows follow those of their names") {
  const auto with_fingers = [](ml::Skeleton s, const std::string& first, const std::string& last) {
    for (const std::string& name : {first, last}) {
      s.parents.push_back(name == last ? s.size() - 1 : s["right_hand"]);
      s.names.push_back(name);
      s.offsets.push_back({-0.04, 0, 0});
    }
    return s;
  };
  const auto bend = ml::from_axis_angle(ml::Vec3<double>{0, 0, 1}, 0.7);
  const auto walk = synthetic::walk({.frames = 5});
  ml::Motion moving{with_fingers(walk.skeleton, "right_index1", "right_feeler"), walk.fps, walk.root, {}, "moving"};
  for (ml::Index f = 0; f < walk.frames(); ++f) {
    const auto body = walk.rotations(f);
    moving.local.insert(moving.local.end(), body.begin(), body.end());
    moving.local.insert(moving.local.end(), {bend, bend});
  }
  const auto same = ml::retarget(moving, moving.skeleton, {.floor = false});
  CHECK((same.skeleton == moving.skeleton && same.local == moving.local));
  CHECK(ml::norm(same.root_at(4) - moving.root_at(4)) == 0);

  const ml::Skeleton other = with_fingers(spread(), "index_01_r", "right_tip");
  const ml::SkeletonMap map(moving.skeleton, other);
  CHECK(map.report().unmapped == std::vector<std::string>{"right_tip"});
  CHECK(map.report().unused == std::vector<std::string>{"right_feeler"});
  const auto on_other = ml::retarget(moving, map);
  const auto first = static_cast<std::size_t>(other["index_01_r"]);
  CHECK(ml::distance(on_other.rotations(3)[first], ml::Quaternion<double>::identity()) == Approx(0.7));
  CHECK(ml::distance(on_other.rotations(3)[first + 1], ml::Quaternion<double>::identity()) < 1e-9);
}

TEST_CASE("bones take the directions of the source's bones, whatever the zero pose") {
  // The source stands like the target's rest pose: its limbs have to turn for that.
  const ml::SkeletonMap map(spread());
  const auto down = ml::Vec3{0.0, -1.0, 0.0}, left = ml::Vec3{1.0, 0.0, 0.0};
  std::vector<ml::Quaternion<double>> world(24, ml::Quaternion<double>::identity());
  for (const char* side : {"left", "right"}) {
    const auto joint = [&](const char* name) {
      return static_cast<std::size_t>(map.source()[side + std::string(name)]);
    };
    const auto leg = ml::rotation_between(map.source().offset(map.source()[side + std::string("_knee")]), down);
    const auto arm = ml::rotation_between(map.source().offset(map.source()[side + std::string("_elbow")]),
                                          side[0] == 'l' ? left : -left);
    for (const char* name : {"_hip", "_knee", "_ankle", "_foot"}) world[joint(name)] = leg;
    world[joint("_shoulder")] = arm;
  }
  const auto rest = ml::retarget(posed(map.source(), world), map);
  for (const auto& q : rest.local) CHECK(ml::distance(q, ml::Quaternion<double>::identity()) < 1e-6);

  // And in any other pose, bone by bone.
  ml::Philox rng{.seed = 5};
  for (auto& q : world) {
    std::vector<double> n(4);
    rng.normal(std::span<double>(n));
    q = ml::normalized(ml::Quaternion{n[0], n[1], n[2], n[3]});
  }
  const auto source = posed(map.source(), world);
  const auto target = ml::retarget(source, map);
  for (const auto& [from, to] : {std::pair{"left_hip", "left_knee"}, std::pair{"left_knee", "left_ankle"},
                                 std::pair{"right_shoulder", "right_elbow"}, std::pair{"right_elbow", "right_wrist"},
                                 std::pair{"left_wrist", "left_hand"}, std::pair{"pelvis", "spine1"}}) {
    CHECK(bone_angle(source, target, from, to) < 1e-4);
  }
}

TEST_CASE("soles stay level: feet roll with their shins and keep their pitch") {
  // Shins lean back by 10 degrees in the zero pose, in which the feet stand flat.
  const double s = std::sin(0.17), c = std::cos(0.17);
  const auto source =
      smpl_with({{"left_ankle", {0, -0.41 * c, -0.41 * s}}, {"right_ankle", {0, -0.41 * c, -0.41 * s}}});
  const auto flat =
      ml::retarget(posed(source, std::vector<ml::Quaternion<double>>(24, ml::Quaternion<double>::identity())),
                   ml::SkeletonMap(source));
  ml::JointTransforms<double> world;
  flat.world(0, world);
  CHECK(ml::distance(world.rotation[7], ml::Matrix3<double>::identity()) < 1e-9);
  const auto p = flat.positions();
  CHECK(p[7].z - p[4].z == Approx(-0.41 * s));  // the shin leans as in the source
}

TEST_CASE("arbitrary local axes: Bandai-Namco's skeleton in its T-pose") {
  const ml::SkeletonTable& table = ml::skeleton_table("Bandai-Namco");
  std::vector<ml::Joint> joints;
  std::vector<ml::Quaternion<double>> world;
  const ml::Skeleton& smpl = ml::smpl24_skeleton();
  // Its joints, in SMPL's places, with the axes that the table states.
  std::map<std::string, std::string> source_of;
  for (const auto& m : table.joints) {
    if (source_of.contains(m.target) || m.target == "spine1") continue;
    source_of[m.target] = m.source;
  }
  for (int j = 0; j < smpl.size(); ++j) {
    if (!source_of.contains(smpl.name(j))) continue;
    int p = smpl.parent(j);
    ml::Vec3<double> offset = smpl.offset(j);
    while (p >= 0 && !source_of.contains(smpl.name(p))) offset = offset + smpl.offset(p), p = smpl.parent(p);
    const auto frame = ml::detail::axes_rotation(*table.find(smpl.name(j)));
    const std::string parent = p < 0 ? "" : source_of[smpl.name(p)];
    if (p >= 0) offset = rotate(inverse(ml::detail::axes_rotation(*table.find(smpl.name(p)))), offset);
    joints.push_back({source_of[smpl.name(j)], parent, 100.0 * offset});
    world.push_back(frame);
  }
  const auto source = ml::Skeleton::from_joints(joints);
  CHECK(ml::detect_skeleton_table(source).name == "Bandai-Namco");
  const ml::SkeletonMap map(source);
  CHECK(map.report().leg_ratio == Approx(0.01));
  const auto rest = ml::retarget(posed(source, world), map);
  // Toes and ankles are pitched by design: our made-up foot is not as steep as Bandai-Namco's.
  for (std::size_t j = 0; j < 24; ++j) CHECK(ml::distance(rest.local[j], ml::Quaternion<double>::identity()) < 1e-9);
  CHECK(rest.root_at(0).y == Approx(0.95));
}

namespace {

/// LaFAN1's joints and its zero pose (Harvey et al. 2020): all bones lie along x.
ml::Skeleton lafan1() {
  std::vector<ml::Joint> joints{{"Hips", "", {0, 92, 0}},           {"Spine", "Hips", {6.9, -2.6, 0}},
                                {"Spine1", "Spine", {12.59, 0, 0}}, {"Spine2", "Spine1", {12.34, 0, 0}},
                                {"Neck", "Spine2", {25.83, 0, 0}},  {"Head", "Neck", {11.77, 0, 0}}};
  for (const auto& [side, z] : {std::pair<std::string, double>{"Left", 1}, {"Right", -1}}) {
    joints.push_back({side + "UpLeg", "Hips", {0.1, 1.86, 10.55 * z}});
    joints.push_back({side + "Leg", side + "UpLeg", {43.5, 0, 0}});
    joints.push_back({side + "Foot", side + "Leg", {42.37, 0, 0}});
    joints.push_back({side + "Toe", side + "Foot", {17.3, 0, 0}});
    joints.push_back({side + "Shoulder", "Spine2", {19.75, -1.48, 6 * z}});
    joints.push_back({side + "Arm", side + "Shoulder", {11.28, 0, 0}});
    joints.push_back({side + "ForeArm", side + "Arm", {33, 0, 0}});
    joints.push_back({side + "Hand", side + "ForeArm", {25.2, 0, 0}});
  }
  return ml::Skeleton::from_joints(joints);
}

/// With other names: `from` becomes `to` wherever it stands.
ml::Skeleton renamed(ml::Skeleton s, const std::string& from, const std::string& to) {
  for (std::string& name : s.names) {
    if (const auto at = name.find(from); at != name.npos) name.replace(at, from.size(), to);
  }
  return s;
}

}  // namespace

TEST_CASE("LaFAN1 has Mixamo's names and lies in its zero pose: the pose in which it would stand tells which it is") {
  const ml::Skeleton source = lafan1();
  CHECK(ml::detect_skeleton_table(source).name == "LaFAN1");
  CHECK(ml::detect_skeleton_table(renamed(source, "Toe", "ToeBase")).name == "LaFAN1");
  const auto mixamo = rigs::skeleton_of(ml::skeleton_table("Mixamo"));
  CHECK(ml::detect_skeleton_table(mixamo).name == "Mixamo");
  CHECK(ml::detect_skeleton_table(renamed(mixamo, "ToeBase", "Toe")).name == "Mixamo");

  // Standing with arms to the sides: x along the bone, y to the front, of feet up.
  const auto frame = [](const ml::Vec3<double>& x, const ml::Vec3<double>& y) {
    return ml::to_quaternion(transpose(ml::Matrix3<double>::from_rows(x, y, cross(x, y))));
  };
  const ml::Vec3<double> left{1, 0, 0}, up{0, 1, 0}, front{0, 0, 1};
  const auto pitch = synthetic::about_x(std::atan2(0.06, 0.14));  // of a foot like SMPL's
  std::vector<ml::Quaternion<double>> world;
  for (const std::string& name : source.names) {
    const bool leg = name.ends_with("Leg"), foot = name.ends_with("Foot"), toe = name.ends_with("Toe"),
               trunk = name == "Hips" || name.starts_with("Spine") || name == "Neck" || name == "Head";
    world.push_back(trunk  ? frame(up, front)
                    : leg  ? frame(-up, front)
                    : foot ? pitch * frame(front, up)
                    : toe  ? frame(front, up)
                           : frame(name.starts_with("Left") ? left : -left, front));
  }
  const ml::Motion standing = posed(source, world);
  const ml::Motion rest = ml::retarget(standing, ml::SkeletonMap(source));
  for (std::size_t j = 0; j < 24; ++j) CHECK(ml::distance(rest.local[j], ml::Quaternion<double>::identity()) < 0.004);
  // and from there to a character
  const ml::Motion on_mixamo = ml::retarget(standing, mixamo);
  for (const auto& q : on_mixamo.local) CHECK(ml::distance(q, ml::Quaternion<double>::identity()) < 0.004);
}

TEST_CASE("a skeleton that does not stand by its table is refused, as source and as target") {
  ml::Skeleton lying = smpl_with({{"spine1", {0, 0.01, -0.11}}, {"spine2", {0, 0, -0.13}}, {"neck", {0, 0, -0.22}}});
  const auto& smpl = ml::smpl24_skeleton();
  const char* message =
      "[motionlang.config.103] SkeletonMap: a skeleton of 24 joints (root 'pelvis') does not stand as SMPL: the head "
      "is from "
      "the pelvis in direction (0, 0.36, -0.93) at rest, not up (0, 1, 0); a file can name the joints "
      "and their axes: read_skeleton_table, option `joints`";
  CHECK_THROWS_WITH_AS(ml::SkeletonMap{lying}, Contains(message), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::SkeletonMap(smpl, lying), Contains(message), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::SkeletonMap{smpl_with({{"left_hip", {0, 0.06, 0}}, {"right_hip", {0, -0.06, 0}}})},
                       Contains("the left hip is from the right one in direction (0, 1, 0) at rest"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::SkeletonMap{smpl_with({{"left_hip", {-0.09, -0.06, 0}}, {"right_hip", {0.09, -0.06, 0}}})},
                       Contains("the left toes are from the ankle in direction (0, -0.39, -0.92) at rest"),
                       ml::config_error);
}

TEST_CASE("Xsens and 100STYLE: there and back") {
  ml::Skeleton xsens = renamed(rigs::skeleton_of(ml::skeleton_table("Xsens"), 0, 100), "Chest2", "Chest3");
  const auto at = static_cast<std::ptrdiff_t>(xsens["Chest3"]);  // Chest2 comes before it, half of the way
  const int before = static_cast<int>(at);
  for (int& parent : xsens.parents) parent += parent >= before ? 1 : 0;
  xsens.offsets[static_cast<std::size_t>(at)] = 0.5 * xsens.offsets[static_cast<std::size_t>(at)];
  xsens.names.insert(xsens.names.begin() + at, "Chest2");
  xsens.offsets.insert(xsens.offsets.begin() + at, xsens.offsets[static_cast<std::size_t>(at)]);
  xsens.parents.insert(xsens.parents.begin() + at, xsens.parents[static_cast<std::size_t>(at)]);
  xsens.parents[static_cast<std::size_t>(at) + 1] = before;
  xsens.validate();
  CHECK(ml::detect_skeleton_table(xsens).name == "Xsens");
  const auto walk = synthetic::walk({.frames = 10, .turn = 0.5});
  const auto again = ml::retarget(ml::retarget(walk, xsens, {.floor = false}), walk.skeleton, {.floor = false});
  CHECK(synthetic::largest_distance(walk, again) < 0.011);
}

TEST_CASE("Noitom and Rokoko: there and back") {
  for (const char* name : {"Noitom", "Rokoko"}) {
    ml::Skeleton suit = rigs::skeleton_of(ml::skeleton_table(name), 0, 100);
    // the second joint of the row of spine2, at its end
    const ml::MappedJoint& row = *ml::skeleton_table(name).find("spine2");
    const int at = suit[row.source];
    for (int& parent : suit.parents) parent += parent >= at ? 1 : 0;
    const auto place = static_cast<std::ptrdiff_t>(at);
    suit.parents.insert(suit.parents.begin() + place + 1, at);
    suit.names.insert(suit.names.begin() + place + 1, row.second);
    suit.offsets.insert(suit.offsets.begin() + place + 1, ml::Vec3<double>{});
    suit.validate();
    CHECK(ml::detect_skeleton_table(suit).name == name);
    CHECK(ml::detect_skeleton_table(renamed(suit, "Toe", "Tip")).name == name);  // Axis Neuron writes no toes
    const auto walk = synthetic::walk({.frames = 10, .turn = 0.5});
    const auto again = ml::retarget(ml::retarget(walk, suit, {.floor = false}), walk.skeleton, {.floor = false});
    CHECK(synthetic::largest_distance(walk, again) < 0.011);
  }
}

TEST_CASE("SOMA: standing by the axes of its T-pose, and LeftLeg is the thigh") {
  const ml::SkeletonTable& table = ml::skeleton_table("SOMA");
  std::vector<ml::Joint> joints;
  const ml::Skeleton rig = rigs::skeleton_of(table);
  // World rotations of the T-pose as SOMA's authors give them, and offsets that lead to the same places.
  std::vector<ml::Quaternion<double>> world;
  for (int j = 0; j < rig.size(); ++j) {
    const ml::MappedJoint* row = nullptr;
    for (const ml::MappedJoint& r : table.joints) row = r.source == rig.name(j) ? &r : row;
    const int p = rig.parent(j);
    world.push_back(row != nullptr ? ml::detail::axes_rotation(*row)
                    : p < 0        ? ml::Quaternion<double>::identity()
                                   : world[static_cast<std::size_t>(p)]);
    const auto up = p < 0 ? ml::Quaternion<double>::identity() : world[static_cast<std::size_t>(p)];
    joints.push_back({rig.name(j), p < 0 ? "" : rig.name(p), rotate(inverse(up), rig.offset(j))});
  }
  const auto x_of = [&](const char* joint) {
    return rotate(world[static_cast<std::size_t>(rig[joint])], ml::Vec3<double>{1, 0, 0});
  };
  CHECK(ml::norm(x_of("Hips") - ml::Vec3<double>{0, 1, 0}) < 1e-9);
  CHECK(ml::norm(x_of("RightArm") - ml::Vec3<double>{1, 0, 0}) < 1e-9);
  CHECK(x_of("LeftLeg").y < -0.99);
  CHECK(x_of("RightShin").y > 0.99);
  CHECK(x_of("LeftFoot").z > 0.9);
  CHECK(x_of("LeftFoot").y < -0.3);
  const ml::Skeleton soma = ml::Skeleton::from_joints(joints);
  CHECK(ml::detect_skeleton_table(soma).name == "SOMA");
  const ml::Motion rest = ml::retarget(posed(soma, world), ml::SkeletonMap(soma));
  for (std::size_t j = 0; j < 24; ++j) CHECK(ml::distance(rest.local[j], ml::Quaternion<double>::identity()) < 0.01);
}

TEST_CASE("names are compared without regard to capital letters where no joint has just this name") {
  ml::Skeleton unity = rigs::skeleton_of(ml::skeleton_table("VRM"));
  for (std::string& name : unity.names) name[0] = static_cast<char>(std::toupper(name[0]));
  CHECK(ml::detect_skeleton_table(unity).name == "VRM");
  const auto two = ml::Skeleton::from_joints({{"Hips", "", {}}, {"rig:hips", "Hips", {}}, {"HEAD", "Hips", {}}});
  CHECK(ml::find_joint(two, "hips") == 1);
  CHECK(ml::find_joint(two, "head") == 2);
  CHECK(ml::find_joint(two, "hip") == -1);
}

TEST_CASE("what most names begin with, up to a separator, is left out where no joint has the name without it") {
  const auto prefix = [](const std::vector<std::string>& names) {
    std::vector<int> parents(names.size(), 0);
    parents.front() = -1;
    return ml::common_name_prefix(
        ml::Skeleton::from_arrays(names, parents, std::vector<ml::Vec3<double>>(names.size())));
  };
  CHECK(prefix({"Sword", "A_Hips", "A_Spine", "A_Head"}) == "A_");
  CHECK(prefix({"Sword", "Shield", "A_Hips", "A_Spine", "A_Head"}).empty());
  CHECK(prefix({"Bip01", "Bip01 Pelvis", "Bip01 L Thigh", "Bip01 R Thigh"}) == "Bip01 ");
  CHECK(prefix({"A_B_Hips", "A_B_Spine", "A_Head", "A_C"}) == "A_");
  CHECK(prefix({"LeftArm", "LeftHand", "LeftLeg", "LeftFoot"}).empty());
  CHECK(prefix({"A_", "A_x", "A_xy"}).empty());
  CHECK(prefix({"same_x", "same_xa", "same_xb", "same_xc"}) == "same_");
  const auto robot = ml::Skeleton::from_joints({{"Robot_Hips", "", {}},
                                                {"Robot_Head", "Robot_Hips", {}},
                                                {"Head", "Robot_Hips", {}},
                                                {"Robot_Toe", "Head", {}},
                                                {"Robot_L_Hand", "Head", {}},
                                                {"Robot_R_Hand", "Head", {}}});
  CHECK(ml::find_joint(robot, "hips") == 0);
  CHECK(ml::find_joint(robot, "Head") == 2);
  CHECK(ml::find_joint(robot, "L Hand") == 4);
  CHECK(ml::find_joint(robot, "Hand") == -1);

  for (const char* numbers : {"_0", ".00"}) {  // of Sketchfab and of Blender
    ml::Skeleton mixamo = rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:");
    const int spine = mixamo.find("mixamorig:Spine2");
    for (std::size_t j = 0; j < mixamo.names.size(); ++j) mixamo.names[j] += numbers + std::to_string(j);
    CHECK(ml::detect_skeleton_table(mixamo).name == "Mixamo");
    CHECK(ml::find_joint(mixamo, "Spine2") == spine);
    CHECK(ml::find_joint(mixamo, "Spine9") == -1);
  }
}

TEST_CASE("a mirror image follows and leads by what its sides are, not by their names") {
  const auto walk = synthetic::walk({.frames = 12, .turn = 0.5});
  const auto& smpl = ml::smpl24_skeleton();
  ml::Motion mirrored = walk;  // x -> -x; names stay
  for (auto* places : {&mirrored.skeleton.offsets, &mirrored.root}) {
    for (auto& p : *places) p.x = -p.x;
  }
  for (auto& q : mirrored.local) q = {q.w, q.x, -q.y, -q.z};
  const ml::SkeletonMap map(mirrored.skeleton);
  CHECK(map.report().table == "SMPL, mirrored");
  const auto seen = ml::retarget(mirrored, map, {.floor = false});
  const auto p = mirrored.positions(), q = seen.positions();
  for (std::size_t f = 0; f < 12; ++f) {
    for (int j = 0; j < 24; ++j) {
      std::string name = smpl.name(j);
      if (name.starts_with("left_"))
        name = "right_" + name.substr(5);
      else if (name.starts_with("right_"))
        name = "left_" + name.substr(6);
      CHECK(norm(q[f * 24 + static_cast<std::size_t>(j)] - p[f * 24 + static_cast<std::size_t>(smpl[name])]) < 1e-6);
    }
  }
  const auto back = ml::retarget(seen, mirrored.skeleton, {.floor = false});
  CHECK(synthetic::largest_distance(mirrored, back) < 1e-6);
  CHECK(!ml::detail::mirrored_table(ml::skeleton_table("LaFAN1")));  // axes of its own
}

TEST_CASE("the path is scaled by the legs and the feet stand on the floor") {
  auto walk = synthetic::walk({.frames = 60});
  for (auto& offset : walk.skeleton.offsets) offset = 2.0 * offset;
  for (auto& r : walk.root) r = 2.0 * r + ml::Vec3{0.0, 7.0, 0.0};
  const ml::SkeletonMap map(walk.skeleton);
  CHECK(map.report().leg_ratio == Approx(0.5));
  CHECK(map.report().arm_ratio == Approx(0.5));
  const auto small = ml::retarget(walk, map);
  const auto wanted = synthetic::walk({.frames = 60});
  const auto travelled = [](const ml::Motion& m) { return m.root.back() - m.root.front(); };
  CHECK(ml::norm(travelled(small) - travelled(wanted)) < 1e-9);
  double lowest = 1;
  for (const auto& p : small.positions()) lowest = std::min(lowest, p.y);
  CHECK(lowest == Approx(0.01).epsilon(0.5));  // the toes at rest
}

TEST_CASE("place_on_floor ignores single low frames and leaves empty clips alone") {
  auto walk = synthetic::walk({.frames = 60});
  const double before = walk.root_at(10).y;
  walk.root[30].y -= 5;
  const double shift = ml::place_on_floor(walk);
  CHECK(std::abs(shift) < 0.05);
  CHECK(walk.root_at(10).y == Approx(before + shift));
  ml::Motion empty = walk;
  empty.root.clear(), empty.local.clear();
  CHECK(ml::place_on_floor(empty) == 0);
}

TEST_CASE(
    "place_on_floor: a rest pose below the floor tells nothing of it, as where the root of a BVH file has OFFSET 0") {
  const auto lowest = [](const ml::Motion& m) {
    double y = 1;
    for (const auto& p : m.positions()) y = std::min(y, p.y);
    return y;
  };
  auto walk = synthetic::walk({.frames = 60});
  walk.skeleton.offsets[0] = {};
  const double floor = lowest(walk), shift = ml::place_on_floor(walk);
  CHECK(std::abs(shift + floor) < 0.01);  // the lowest frames are not counted
  CHECK(std::abs(lowest(walk)) < 0.01);
  const auto followed = ml::retarget(synthetic::walk({.frames = 60}), walk.skeleton);
  CHECK(std::abs(lowest(followed)) < 0.01);
}

TEST_CASE("chains of other lengths: shares of two joints") {
  // One long spine joint drives three: the middle one gets half of what it turns.
  const ml::SkeletonTable table{"two spines",
                                {{"pelvis", "pelvis"},
                                 {"spine1", "pelvis", "+x+y", {}, "spine1", 0.5},
                                 {"spine2", "spine1"},
                                 {"left_hip", "left_hip"},
                                 {"right_hip", "right_hip"},
                                 {"left_knee", "left_knee"},
                                 {"right_knee", "right_knee"},
                                 {"left_ankle", "left_ankle"},
                                 {"right_ankle", "right_ankle"}}};
  auto pose = synthetic::walk({.frames = 1});
  std::fill(pose.local.begin(), pose.local.end(), ml::Quaternion<double>::identity());
  pose.local[3] = synthetic::about_x(0.8);
  const ml::SkeletonMap map(pose.skeleton, ml::smpl24_skeleton(), table);
  const auto bent = ml::retarget(pose, map);
  CHECK(ml::distance(bent.local[3], synthetic::about_x(0.4)) < 1e-9);
  CHECK(ml::distance(bent.local[6], synthetic::about_x(0.4)) < 1e-9);
  CHECK(ml::distance(bent.local[9], ml::Quaternion<double>::identity()) < 1e-9);  // not mapped: at rest
  CHECK(std::count(map.report().unmapped.begin(), map.report().unmapped.end(), "spine3") == 1);
  CHECK(std::count(map.report().unused.begin(), map.report().unused.end(), "head") == 1);
  CHECK(to_string(map.report()).starts_with("two spines -> SMPL: 9 of 24 joints follow, legs x 1, arms x 0\n"));
  CHECK(map.report().mapped[3] == std::pair<std::string, std::string>{"spine1", "pelvis + spine1"});
}

TEST_CASE("tables are recognised by the names of joints") {
  for (const ml::SkeletonTable& table : ml::skeleton_tables()) {
    CAPTURE(table.name);
    std::vector<std::string> names;
    std::vector<int> parents;
    for (const auto& m : table.joints) {
      CHECK_NOTHROW(ml::detail::axes_rotation(m));
      CHECK(ml::smpl24_skeleton().find(m.target) >= 0);
      for (const std::string& name : {m.source, m.second}) {
        if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) continue;
        parents.push_back(names.empty() ? -1 : 0);
        names.push_back(name);
      }
    }
    const std::vector<ml::Vec3<double>> offsets(names.size());
    const auto skeleton = ml::Skeleton::from_arrays(names, parents, offsets);
    CHECK(ml::detect_skeleton_table(skeleton).name == table.name);
  }
  CHECK(ml::detect_skeleton_table(ml::humanml3d22_skeleton()).name == "SMPL");
}

TEST_CASE("MMM: there and back, limbs and trunk keep their directions") {
  CHECK(ml::detect_skeleton_table(ml::kit21_skeleton()).name == "MMM");
  const ml::Motion walk = synthetic::walk({.frames = 40, .turn = 0.4});
  const ml::Motion mmm = ml::retarget(walk, ml::kit21_skeleton());
  const ml::Motion again = ml::retarget(mmm);
  for (const auto& bone : {std::pair("left_hip", "left_knee"),
                           {"right_knee", "right_ankle"},
                           {"left_shoulder", "left_elbow"},
                           {"right_elbow", "right_wrist"},
                           {"neck", "head"},
                           {"left_ankle", "left_foot"}}) {
    CAPTURE(bone.first);
    CHECK(bone_angle(walk, again, bone.first, bone.second) < 0.5);
  }
  // as its reader makes clips: from positions alone
  const ml::Motion fitted = ml::retarget(ml::motion_from_joints(ml::kit21_skeleton(), mmm.positions(), 20));
  CHECK(bone_angle(walk, fitted, "left_hip", "left_knee") < 1);
  CHECK(bone_angle(walk, fitted, "right_elbow", "right_wrist") < 1);
}

TEST_CASE("a missing joint is reported") {
  ml::Skeleton s = ml::smpl24_skeleton();
  s.names[static_cast<std::size_t>(s["left_knee"])] = "kneecap";
  CHECK_THROWS_WITH_AS(ml::detect_skeleton_table(s), Contains("SMPL, needs a joint 'left_knee'"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::SkeletonMap(s, ml::smpl24_skeleton(), ml::skeleton_table("CMU Daz")),
                       Contains("[motionlang.config.103] SkeletonMap: CMU Daz needs a joint 'hip'"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::skeleton_table("CMU Max"), Contains("[motionlang.config.103]"), ml::config_error);
  ml::Skeleton nameless = ml::kit21_skeleton();
  for (std::string& name : nameless.names) name += "?";
  CHECK_THROWS_WITH_AS(ml::SkeletonMap(ml::smpl24_skeleton(), nameless),
                       Contains("no table fits a skeleton of 21 joints (root 'root?')"), ml::config_error);
  ml::SkeletonTable no_hips{"no hips", {{"pelvis", "pelvis"}}};
  CHECK_THROWS_WITH_AS(ml::SkeletonMap(ml::smpl24_skeleton(), ml::smpl24_skeleton(), no_hips),
                       Contains("no hips has no 'left_hip'"), ml::config_error);
  ml::Skeleton flat = ml::smpl24_skeleton();
  for (auto& offset : flat.offsets) offset = {};
  CHECK_THROWS_WITH_AS(ml::SkeletonMap{flat}, Contains("[motionlang.config.101]"), ml::config_error);
  const ml::SkeletonMap map(ml::smpl24_skeleton());
  CHECK_THROWS_WITH_AS(ml::retarget(synthetic::walk({.frames = 2}, ml::humanml3d22_skeleton()), map),
                       Contains("[motionlang.config.106]"), ml::config_error);
  for (const char* axes : {"", "+x+x", "+x-x", "x+y+", "+a+b", "+x+y+z"}) {
    CHECK_THROWS_WITH_AS(ml::detail::axes_rotation({"pelvis", "hips", axes}), Contains("does not name two axes"),
                         ml::config_error);
  }
}

TEST_CASE("to every rig and back: A-poses, figures that face elsewhere, other units, prefixes") {
  const auto walk = synthetic::walk({.frames = 25, .turn = 0.5});
  const rigs::Turns a_pose{{"left_shoulder", synthetic::about_z(-0.8)}, {"right_shoulder", synthetic::about_z(0.8)},
                           {"left_hip", synthetic::about_z(0.1)},       {"right_hip", synthetic::about_z(-0.1)},
                           {"left_ankle", synthetic::about_z(0)},       {"right_ankle", synthetic::about_z(0)}};
  struct Rig {
    const char* table;
    double facing, unit;
    rigs::Turns turns;
    const char* prefix;
  };
  const double half = std::numbers::pi;
  for (const Rig& rig :
       {Rig{"Mixamo", 0, 100, {}, "mixamorig:"}, Rig{"Mixamo", 0, 1, a_pose, "mixamorig4:"},
        Rig{"Mixamo", half / 2, 1, {}, "mixamorig"}, Rig{"Mixamo", 0, 1, {}, ""}, Rig{"Quaternius", 0, 1, a_pose, ""},
        Rig{"Unreal 4", -half / 2, 100, a_pose, ""}, Rig{"Unreal 5", 0, 1, a_pose, ""}, Rig{"VRM", half, 1, {}, ""},
        Rig{"VRM without upper chest", 0, 1, a_pose, "hero:"}, Rig{"VRoid", half, 1, a_pose, ""},
        Rig{"KayKit", 0, 0.5, {}, ""}, Rig{"SMPL add-on", 0, 1, a_pose, ""}, Rig{"Mixamo", 0, 1, {}, "Character1_"},
        Rig{"Biped", 0, 1, a_pose, "Bip01 "}, Rig{"Biped", 0, 100, {}, "ValveBiped.Bip01_"},
        Rig{"Biped with two links in the spine", 0, 1, {}, "Bip001_"}}) {
    CAPTURE(rig.table);
    CAPTURE(rig.prefix);
    const ml::Skeleton skeleton =
        rigs::skeleton_of(ml::skeleton_table(rig.table), rig.facing, rig.unit, rig.turns, rig.prefix);
    CHECK(ml::detect_skeleton_table(skeleton).name == rig.table);
    const ml::SkeletonMap there(walk.skeleton, skeleton), back(skeleton);
    CHECK(there.report().leg_ratio == Approx(rig.unit));
    CHECK(back.report().leg_ratio == Approx(1 / rig.unit));
    const auto& rest = there.report().unmapped;
    CHECK(std::count(rest.begin(), rest.end(), "left_thumb") == 1);
    CHECK(std::count(rest.begin(), rest.end(), "root_on_floor") == 1);

    // Limbs on the rig stand like the limbs of the source: bone by bone in the same directions.
    const auto on_rig = ml::retarget(walk, there, {.floor = false});
    const ml::SkeletonTable& table = ml::skeleton_table(rig.table);
    const auto p = walk.positions(), q = on_rig.positions();
    for (std::size_t f = 0; f < 25; f += 6) {
      for (const auto& [from, to] : {std::pair{"left_hip", "left_knee"}, std::pair{"right_knee", "right_ankle"},
                                     std::pair{"left_shoulder", "left_elbow"}, std::pair{"right_elbow", "right_wrist"},
                                     std::pair{"left_ankle", "left_foot"}, std::pair{"left_hip", "right_hip"}}) {
        auto at = [&](const char* role) {
          return q[f * on_rig.skeleton.parents.size() +
                   static_cast<std::size_t>(ml::find_joint(skeleton, table.find(role)->source))];
        };
        auto of = [&](const char* role) { return p[f * 24 + static_cast<std::size_t>(walk.skeleton[role])]; };
        CHECK(norm(normalized(at(to) - at(from)) - normalized(of(to) - of(from))) < 1e-6);
      }
    }
    // And back: what the rig's spine and collars cannot tell is less than a centimetre.
    const auto again = ml::retarget(on_rig, back, {.floor = false});
    CHECK(synthetic::largest_distance(walk, again) < 0.011);
  }
}

TEST_CASE("from a known rig to another, and to skeletons with axes of their own") {
  const auto walk = synthetic::walk({.frames = 10});
  const auto mixamo = rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 100, {}),
             vrm = rigs::skeleton_of(ml::skeleton_table("VRM"), std::numbers::pi, 1, {});
  const auto direct = ml::retarget(walk, vrm), by_way = ml::retarget(ml::retarget(walk, mixamo), vrm);
  CHECK(synthetic::largest_distance(direct, by_way) < 1e-6);

  // Daz: no rest rotation, T-pose by decree. There and back is what was there.
  const auto& daz = ml::skeleton_table("CMU Daz");
  std::vector<ml::Joint> joints;
  for (const auto& [joint, parent, smpl, start] : {std::array<const char*, 4>{"hip", "", "pelvis", ""},
                                                   {"abdomen", "hip", "spine1", "pelvis"},
                                                   {"chest", "abdomen", "spine3", "spine1"},
                                                   {"neck", "chest", "neck", "spine3"},
                                                   {"head", "neck", "head", "neck"},
                                                   {"lThigh", "hip", "left_hip", "pelvis"},
                                                   {"lShin", "lThigh", "left_knee", "left_hip"},
                                                   {"lFoot", "lShin", "left_ankle", "left_knee"},
                                                   {"rThigh", "hip", "right_hip", "pelvis"},
                                                   {"rShin", "rThigh", "right_knee", "right_hip"},
                                                   {"rFoot", "rShin", "right_ankle", "right_knee"},
                                                   {"lShldr", "chest", "left_shoulder", "spine3"},
                                                   {"lForeArm", "lShldr", "left_elbow", "left_shoulder"},
                                                   {"lHand", "lForeArm", "left_wrist", "left_elbow"},
                                                   {"rShldr", "chest", "right_shoulder", "spine3"},
                                                   {"rForeArm", "rShldr", "right_elbow", "right_shoulder"},
                                                   {"rHand", "rForeArm", "right_wrist", "right_elbow"}}) {
    const auto rest = ml::smpl24_skeleton().rest_positions();
    auto place = [&](const std::string& name) {
      return name.empty() ? ml::Vec3<double>{} : rest[static_cast<std::size_t>(ml::smpl24_skeleton()[name])];
    };
    joints.push_back({joint, parent, place(smpl) - place(start)});
  }
  const auto skeleton = ml::Skeleton::from_joints(joints);
  CHECK(ml::detect_skeleton_table(skeleton).name == "CMU Daz");
  const ml::SkeletonMap there(walk.skeleton, ml::skeleton_table("SMPL"), skeleton, daz), back(skeleton);
  const auto again = ml::retarget(ml::retarget(walk, there, {.floor = false}), back, {.floor = false});
  for (const char* joint : {"pelvis", "left_hip", "right_knee", "left_shoulder", "right_elbow"}) {
    CAPTURE(joint);
    const auto j = static_cast<std::size_t>(walk.skeleton[joint]);
    ml::JointTransforms<double> a, b;
    for (ml::Index f = 0; f < 10; f += 3) {
      walk.world(f, a), again.world(f, b);
      CHECK(distance(ml::to_quaternion(a.rotation[j]), ml::to_quaternion(b.rotation[j])) < 1e-6);
    }
  }
}
