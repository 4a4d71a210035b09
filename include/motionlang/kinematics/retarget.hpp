// SPDX-License-Identifier: MIT
/// Retargeting: the same movement on another skeleton, here one with SMPL's joint names.
///
///     G_t(f) = G_s(f) C_s^-1
/// G_s, G_t: world rotations of a source joint s and of the target joint t that follows it; C_s: the world rotation
/// that s has when the source stands in the rest pose of the target (a T-pose, facing +Z). A source in that pose so
/// gives the target's rest pose, whatever its local axes, and chains may have different numbers of joints. Bones keep
/// the target's lengths; the path is scaled by the ratio of the legs.
#pragma once

#include <algorithm>  // nth_element
#include <array>      // limbs
#include <numbers>    // pi

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>
#include <motionlang/kinematics/standard.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// What a map did with the joints of both skeletons.
struct RetargetReport {
  std::string table;
  std::vector<std::string> unmapped;    // joints of the target that stay at rest
  std::vector<std::string> unused;      // joints of the source that nothing follows
  double leg_ratio = 1, arm_ratio = 1;  // target / source, 0 without arms; the path is scaled by leg_ratio
};
inline std::string to_string(const RetargetReport& r) {
  auto list = [](const std::vector<std::string>& names) {
    std::string out;
    for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
    return out.empty() ? std::string("none") : out;
  };
  auto rounded = [](double x) { return std::round(x * 1000) / 1000; };
  return concat_text(r.table, ": legs x ", rounded(r.leg_ratio), ", arms x ", rounded(r.arm_ratio),
                     "; target joints at rest: ", list(r.unmapped), "; source joints not used: ", list(r.unused));
}

namespace detail {

/// The limb joints whose bones are turned to the target's direction in the rest pose, with the joint where each ends.
struct LimbBone {
  std::string_view joint, end;
};
inline constexpr std::array<LimbBone, 4> leg_bones{{{"left_hip", "left_knee"},
                                                    {"left_knee", "left_ankle"},
                                                    {"right_hip", "right_knee"},
                                                    {"right_knee", "right_ankle"}}};
inline constexpr std::array<LimbBone, 4> arm_bones{{{"left_shoulder", "left_elbow"},
                                                    {"left_elbow", "left_wrist"},
                                                    {"right_shoulder", "right_elbow"},
                                                    {"right_elbow", "right_wrist"}}};
inline constexpr std::array<LimbBone, 2> hand_bones{{{"left_wrist", "left_hand"}, {"right_wrist", "right_hand"}}};

inline const LimbBone* find_limb_bone(std::string_view joint) {
  for (const std::span<const LimbBone> bones : {std::span<const LimbBone>(leg_bones), {arm_bones}, {hand_bones}}) {
    for (const LimbBone& bone : bones) {
      if (bone.joint == joint) return &bone;
    }
  }
  return nullptr;
}

inline Vec3<double> local_axis(std::string_view signed_letter) {
  const double sign = signed_letter[0] == '-' ? -1 : 1;
  const char c = signed_letter[1];
  return {c == 'x' ? sign : 0, c == 'y' ? sign : 0, c == 'z' ? sign : 0};
}
/// World rotation of a joint in a T-pose, from "+x+y": its local axes that point left and up.
inline Quaternion<double> axes_rotation(const MappedJoint& joint) {
  const std::string_view axes = joint.axes;
  if (axes.size() != 4 || axes[0] >= 'x' || axes[2] >= 'x' || axes.find_first_not_of("+-xyz") != axes.npos ||
      axes[1] == axes[3] || axes[1] < 'x' || axes[3] < 'x') {
    raise<config_error>(103, "SkeletonTable: '", axes, "' of '", joint.source, "' does not name two axes");
  }
  const Vec3<double> left = local_axis(axes.substr(0, 2)), up = local_axis(axes.substr(2, 2));
  const auto frame = to_quaternion(Matrix3<double>::from_rows(left, up, cross(left, up)));
  return to_quaternion(AxisAngle<double>{(std::numbers::pi / 180) * joint.turn}) * frame;
}

}  // namespace detail

/// How one skeleton follows another; made once, used for every clip.
class SkeletonMap {
 public:
  /// Throws config_error 103 with the name of a joint that the table needs and a skeleton lacks (or, for axes that are
  /// none), 101 if the legs of a skeleton have no length.
  SkeletonMap(const Skeleton& source, const Skeleton& target, const SkeletonTable& table)
      : source_(source), target_(target) {
    const std::string missing = table.missing(source);
    if (!missing.empty()) raise<config_error>(103, "SkeletonMap: ", table.name, " needs a joint '", missing, "'");
    report_.table = table.name;
    rest_pose(table);
    connect(table);
    measure();
  }
  /// With the built-in table that fits the source.
  explicit SkeletonMap(const Skeleton& source, const Skeleton& target = smpl24_skeleton())
      : SkeletonMap(source, target, detect_skeleton_table(source)) {}

  const Skeleton& source() const { return source_; }
  const Skeleton& target() const { return target_; }
  const RetargetReport& report() const { return report_; }

  /// One frame: world transforms of the source to root position and local rotations of the target.
  void apply(const JointTransforms<double>& from, Vec3<double>& root, std::span<Quaternion<double>> local) const {
    std::vector<Quaternion<double>> world(links_.size());
    for (std::size_t t = 0; t < links_.size(); ++t) {
      const Link& link = links_[t];
      const int parent = target_.parents[t];
      const auto up = parent < 0 ? Quaternion<double>::identity() : world[static_cast<std::size_t>(parent)];
      world[t] = link.source < 0 ? up : turned(from, link.source, link.undo);
      if (link.second >= 0) world[t] = slerp(world[t], turned(from, link.second, link.undo_second), link.share);
      local[t] = inverse(up) * world[t];
    }
    const Vec3<double> middle = 0.5 * (position(from, left_hip_) + position(from, right_hip_));
    root = report_.leg_ratio * middle - rotate(world[0], hips_);
  }

 private:
  struct Link {
    int source = -1, second = -1;
    Quaternion<double> undo{1, 0, 0, 0}, undo_second{1, 0, 0, 0};  // C_s^-1
    double share = 0;
  };

  static Quaternion<double> turned(const JointTransforms<double>& from, int joint, const Quaternion<double>& undo) {
    return to_quaternion(from.rotation[static_cast<std::size_t>(joint)]) * undo;
  }
  static const Vec3<double>& position(const JointTransforms<double>& from, int joint) {
    return from.position[static_cast<std::size_t>(joint)];
  }

  /// World rotations (before the bones are turned) and positions of the source in its T-pose.
  void rest_pose(const SkeletonTable& table) {
    const auto joints = static_cast<std::size_t>(source_.size());
    rest_rotation_.assign(joints, Quaternion<double>::identity());
    rest_position_.assign(joints, {});
    std::vector<bool> given(joints, false);
    for (const MappedJoint& m : table.joints) {
      const int s = source_.find(m.source);
      if (s < 0) continue;
      rest_rotation_[static_cast<std::size_t>(s)] = detail::axes_rotation(m);
      given[static_cast<std::size_t>(s)] = true;
    }
    for (std::size_t s = 1; s < joints; ++s) {
      const auto parent = static_cast<std::size_t>(source_.parents[s]);
      if (!given[s]) rest_rotation_[s] = rest_rotation_[parent];
      rest_position_[s] = rest_position_[parent] + rotate(rest_rotation_[parent], source_.offsets[s]);
    }
  }

  void connect(const SkeletonTable& table) {
    links_.resize(static_cast<std::size_t>(target_.size()));
    std::vector<bool> used(static_cast<std::size_t>(source_.size()), false);
    for (std::size_t t = 0; t < links_.size(); ++t) {
      const MappedJoint* row = table.find(target_.names[t]);
      if (row == nullptr || source_.find(row->source) < 0) {
        report_.unmapped.push_back(target_.names[t]);
        continue;
      }
      links_[t] = {.source = source_.find(row->source), .share = row->share};
      used[static_cast<std::size_t>(links_[t].source)] = true;
      if (row->second.empty()) continue;
      links_[t].second = source_.find(row->second);
      used[static_cast<std::size_t>(links_[t].second)] = true;
    }
    std::vector<Quaternion<double>> turn(
        links_.size(), Quaternion<double>::identity());  // of the bones, from the T-pose of the source to the target's
    for (std::size_t t = 0; t < links_.size(); ++t) {
      if (table.straighten) turn[t] = bone_turn(static_cast<int>(t), turn);
      Link& link = links_[t];
      if (link.source >= 0) link.undo = inverse(turn[t] * rest_rotation_[static_cast<std::size_t>(link.source)]);
      if (link.second >= 0) link.undo_second = inverse(turn[t] * rest_rotation_[static_cast<std::size_t>(link.second)]);
    }
    for (std::size_t s = 0; s < used.size(); ++s) {
      if (!used[s]) report_.unused.push_back(source_.names[s]);
    }
  }

  /// The rotation that brings a joint of the source from its T-pose to the target's rest pose. Limbs are turned along,
  /// joint by joint; feet only roll with their shins, so that soles stay level; the trunk is taken as it stands.
  Quaternion<double> bone_turn(int t, const std::vector<Quaternion<double>>& turn) const {
    const auto up =
        target_.parent(t) < 0 ? Quaternion<double>::identity() : turn[static_cast<std::size_t>(target_.parent(t))];
    const std::string& name = target_.name(t);
    if (const detail::LimbBone* limb = detail::find_limb_bone(name)) {
      const Vec3<double> bone = source_bone(*limb), wanted = target_bone(*limb);
      if (norm(bone) < 1e-9 || norm(wanted) < 1e-9) return up;
      return rotation_between(rotate(up, bone), wanted) * up;
    }
    if (name == "left_ankle" || name == "right_ankle") {
      const detail::LimbBone shin{name == "left_ankle" ? "left_knee" : "right_knee", name};
      const Vec3<double> bone = source_bone(shin), wanted = target_bone(shin);
      const double roll = std::atan2(wanted.x, -wanted.y) - std::atan2(bone.x, -bone.y);
      return from_axis_angle(Vec3<double>{0, 0, 1}, roll);
    }
    if (name == "left_foot" || name == "right_foot" || name == "left_hand" || name == "right_hand") return up;
    return Quaternion<double>::identity();
  }
  /// The bone of a limb in the T-pose of the source; zero if a joint is not mapped.
  Vec3<double> source_bone(const detail::LimbBone& limb) const {
    const int a = source_of(limb.joint), b = source_of(limb.end);
    if (a < 0 || b < 0) return {};
    return rest_position_[static_cast<std::size_t>(b)] - rest_position_[static_cast<std::size_t>(a)];
  }
  Vec3<double> target_bone(const detail::LimbBone& limb) const {
    const int end = target_.find(limb.end);
    return end < 0 ? Vec3<double>{} : target_.offset(end);
  }
  int source_of(std::string_view target_joint) const {
    const int t = target_.find(target_joint);
    return t < 0 ? -1 : links_[static_cast<std::size_t>(t)].source;
  }

  /// Lengths of legs and arms, and where the hips are.
  void measure() {
    hips_ = 0.5 * (target_.offset(target_["left_hip"]) + target_.offset(target_["right_hip"]));
    left_hip_ = source_of("left_hip");
    right_hip_ = source_of("right_hip");
    if (left_hip_ < 0 || right_hip_ < 0)
      raise<config_error>(103, "SkeletonMap: ", report_.table, " has no 'left_hip' or no 'right_hip'");
    auto ratio = [&](std::span<const detail::LimbBone> bones) {  // over the bones that both skeletons have
      double here = 0, there = 0;
      for (const detail::LimbBone& bone : bones) {
        const double length = norm(source_bone(bone));
        here += length > 0 ? norm(target_bone(bone)) : 0;
        there += length;
      }
      return there > 0 ? here / there : 0;
    };
    report_.leg_ratio = ratio(detail::leg_bones);
    report_.arm_ratio = ratio(detail::arm_bones);
    if (!(report_.leg_ratio > 0) || !std::isfinite(report_.leg_ratio)) {
      raise<config_error>(101, "SkeletonMap: legs of no length (target / source = ", report_.leg_ratio, ")");
    }
  }

  Skeleton source_, target_;
  RetargetReport report_;
  std::vector<Quaternion<double>> rest_rotation_;  // of the source
  std::vector<Vec3<double>> rest_position_;
  std::vector<Link> links_;  // of the target's joints
  int left_hip_ = -1, right_hip_ = -1;
  Vec3<double> hips_{};  // middle of the target's hips, seen from its root
};

/// Moves a clip up or down so that its feet stand on y = 0 as they do in the rest pose: the lowest joint of a frame, in
/// all but the lowest 5 % of the frames, is not below the lowest joint at rest. Returns by how much it was moved.
inline double place_on_floor(Motion& motion) {
  if (motion.frames() == 0) return 0;
  auto lowest = [](std::span<const Vec3<double>> joints) {
    return std::min_element(joints.begin(), joints.end(), [](auto& a, auto& b) { return a.y < b.y; })->y;
  };
  const auto rest = motion.skeleton.rest_positions(), positions = motion.positions();
  std::vector<double> heights;
  for (std::size_t at = 0; at < positions.size(); at += rest.size()) {
    heights.push_back(lowest(std::span(positions).subspan(at, rest.size())));
  }
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 20);
  std::nth_element(heights.begin(), low, heights.end());
  const double shift = lowest(rest) - *low;
  for (Vec3<double>& r : motion.root) r.y += shift;
  return shift;
}

struct RetargetOptions {
  bool floor = true;  // place_on_floor
};

/// The clip on the target of the map. Throws config_error 106 if its skeleton is not the source of the map.
inline Motion retarget(const Motion& motion, const SkeletonMap& map, const RetargetOptions& options = {}) {
  if (motion.skeleton.names != map.source().names || motion.skeleton.parents != map.source().parents) {
    raise<config_error>(106, "retarget: '", motion.name, "' has another skeleton than the map was made for");
  }
  Motion out{map.target(), motion.fps, {}, {}, motion.name};
  out.root.resize(motion.root.size());
  out.local.resize(motion.root.size() * static_cast<std::size_t>(out.skeleton.size()));
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    motion.world(f, world);
    map.apply(world, out.root[static_cast<std::size_t>(f)], out.rotations(f));
  }
  if (options.floor) place_on_floor(out);
  return out;
}
/// With the built-in table that fits the clip. Throws config_error 103 with the joint that is missing.
inline Motion retarget(const Motion& motion, const Skeleton& target = smpl24_skeleton(),
                       const RetargetOptions& options = {}) {
  return retarget(motion, SkeletonMap(motion.skeleton, target), options);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
