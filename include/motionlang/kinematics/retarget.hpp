// SPDX-License-Identifier: MIT
/// Retargeting: the same movement on another skeleton, from and to every kind that skeleton_tables.hpp knows.
///
///     G_t(f) = G_s(f) C_s^-1 C_t
/// G_s, G_t: world rotations of a joint s of the source and of the joint t of the target that follows it. C_t: the
/// world rotation of t while the target stands in its T-pose, facing +Z; C_s: that of s while the source stands as the
/// target does then, its limbs along the target's limbs. A source in that pose so gives the target's T-pose, whatever
/// the local axes and the rest poses (T, A, any quarter turn), and chains may have different numbers of joints. Joints
/// that no table knows follow those of the same name, fingers those of the same finger. Bones keep the
/// target's lengths; the path is scaled by the ratio of the legs.
#pragma once

#include <algorithm>  // max, min_element
#include <array>      // limbs

#include <motionlang/core/quantile.hpp>
#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/finger_names.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// What a map did with the joints of both skeletons.
struct RetargetReport {
  std::string table, target_table;                          // the kinds of source and target
  std::vector<std::pair<std::string, std::string>> mapped;  // joint of the target, joint (or "a + b") of the source
  std::vector<std::string> unmapped;                        // joints of the target that stay at rest
  std::vector<std::string> unused;                          // joints of the source that nothing follows
  double leg_ratio = 1, arm_ratio = 1;  // target / source, 0 without arms; the path is scaled by leg_ratio
};
inline std::string to_string(const RetargetReport& r) {
  auto list = [](const std::vector<std::string>& names) {
    return names.empty() ? std::string("none") : join_text(names);
  };
  auto rounded = [](double x) { return std::round(x * 1000) / 1000; };
  std::vector<std::string> pairs;
  for (const auto& [to, from] : r.mapped) pairs.push_back(from + " -> " + to);
  return concat_text(r.table, " -> ", r.target_table, ": ", r.mapped.size(), " of ",
                     r.mapped.size() + r.unmapped.size(), " joints follow, legs x ", rounded(r.leg_ratio), ", arms x ",
                     rounded(r.arm_ratio), "\n  mapped: ", list(pairs), "\n  target joints at rest: ", list(r.unmapped),
                     "\n  source joints not used: ", list(r.unused));
}

namespace detail {

/// The limb joints whose bones are turned to the target's direction in the rest pose.
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

}  // namespace detail

/// How one skeleton follows another; made once, used for every clip.
class SkeletonMap {
 public:
  /// Throws config_error 103 with the name of a joint that the source's table needs and the source lacks (or, for axes
  /// that are none, or hips that a skeleton has not), and if a skeleton does not stand at rest by its table; 101 if the
  /// legs of a skeleton have no length.
  SkeletonMap(const Skeleton& source, const SkeletonTable& source_table, const Skeleton& target,
              const SkeletonTable& target_table)
      : source_(source), target_(target) {
    const std::string missing = source_table.missing(source);
    if (!missing.empty())
      raise<config_error>(103, "SkeletonMap: ", source_table.name, " needs a joint '", missing, "'");
    report_.table = source_table.name;
    report_.target_table = target_table.name;
    const detail::StandingSkeleton from(source, source_table), to(target, target_table);
    for (const detail::StandingSkeleton* s : {&from, &to}) {
      const std::string lies = s->lies();
      if (!lies.empty())
        raise<config_error>(103, "SkeletonMap: a skeleton of ", s->skeleton.size(), " joints (root '",
                            s->skeleton.name(0), "') does not stand as ", s->table.name, ": ", lies,
                            "; ", detail::own_table_hint);
    }
    connect(from, to);
    measure(from, to);
  }
  /// The target has SMPL's names.
  SkeletonMap(const Skeleton& source, const Skeleton& target, const SkeletonTable& source_table)
      : SkeletonMap(source, source_table, target, skeleton_table("SMPL")) {}
  /// With the built-in tables that fit.
  explicit SkeletonMap(const Skeleton& source, const Skeleton& target = smpl24_skeleton())
      : SkeletonMap(source, detect_skeleton_table(source), target, detect_skeleton_table(target)) {}

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
      world[t] = up * link.at_rest;
      if (link.source >= 0) world[t] = turned(from, link.source, link.undo);
      if (link.second >= 0) world[t] = slerp(world[t], turned(from, link.second, link.undo_second), link.share);
      local[t] = inverse(up) * world[t];
    }
    const Vec3<double> middle = 0.5 * (position(from, left_hip_) + position(from, right_hip_));
    root =
        report_.leg_ratio * middle - 0.5 * (from_root(target_left_hip_, world) + from_root(target_right_hip_, world));
  }

 private:
  struct Link {
    int source = -1, second = -1;
    Quaternion<double> undo{1, 0, 0, 0}, undo_second{1, 0, 0, 0};  // C_s^-1 C_t
    Quaternion<double> at_rest{1, 0, 0, 0};                        // of a joint that follows none, seen from its parent
    double share = 0;
  };

  static Quaternion<double> turned(const JointTransforms<double>& from, int joint, const Quaternion<double>& undo) {
    return to_quaternion(from.rotation[static_cast<std::size_t>(joint)]) * undo;
  }
  static const Vec3<double>& position(const JointTransforms<double>& from, int joint) {
    return from.position[static_cast<std::size_t>(joint)];
  }
  /// A joint of the target seen from its root.
  Vec3<double> from_root(int joint, const std::vector<Quaternion<double>>& world) const {
    Vec3<double> p{};
    for (; target_.parent(joint) >= 0; joint = target_.parent(joint)) {
      p = p + rotate(world[static_cast<std::size_t>(target_.parent(joint))], target_.offset(joint));
    }
    return p;
  }

  /// Of joints that no table knows: the joint of the same name, or the same joint of the same finger; -1.
  int namesake(const std::string& name) const {
    int s = source_.find(name);
    const std::string finger = finger_of(bare_joint_name(name));
    for (int k = 0; k < source_.size() && s < 0 && !finger.empty(); ++k) {
      if (finger_of(bare_joint_name(source_.name(k))) == finger) s = k;
    }
    return s;
  }
  void connect(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to) {
    links_.resize(static_cast<std::size_t>(target_.size()));
    std::vector<bool> used(static_cast<std::size_t>(source_.size()), false);
    // of the bones of the source, from its T-pose to the target's
    std::vector<Quaternion<double>> turn(links_.size(), Quaternion<double>::identity());
    for (std::size_t t = 0; t < links_.size(); ++t) {
      Link& link = links_[t];
      const int parent = target_.parents[t];
      const auto up = parent < 0 ? Quaternion<double>::identity() : turn[static_cast<std::size_t>(parent)];
      const std::string role = to.role(static_cast<int>(t));
      turn[t] = bone_turn(role, from, to, up);
      if (parent >= 0) link.at_rest = inverse(to.rotation[static_cast<std::size_t>(parent)]) * to.rotation[t];
      auto follow = [&](int s) {
        used[static_cast<std::size_t>(s)] = true;
        return inverse(turn[t] * from.rotation[static_cast<std::size_t>(s)]) * to.rotation[t];
      };
      const MappedJoint* row = role.empty() ? nullptr : from.table.find(role);
      link.source = row != nullptr ? find_joint(source_, row->source) : role.empty() ? namesake(target_.names[t]) : -1;
      if (link.source < 0) {
        report_.unmapped.push_back(target_.names[t]);
        continue;
      }
      link.undo = follow(link.source);
      std::string name = source_.name(link.source);
      if (row != nullptr && !row->second.empty()) {
        link.second = find_joint(source_, row->second);
        link.undo_second = follow(link.second);
        link.share = row->share;
        name += " + " + source_.name(link.second);
      }
      report_.mapped.emplace_back(target_.names[t], std::move(name));
    }
    for (std::size_t s = 0; s < used.size(); ++s) {
      if (!used[s]) report_.unused.push_back(source_.names[s]);
    }
  }

  /// The rotation that brings a joint of the source from its T-pose to the pose in which it stands like the target.
  /// Limbs are turned along, joint by joint; feet only roll with their shins, unless a table says that they stand
  /// level, so that soles stay level; the trunk is taken as it stands.
  static Quaternion<double> bone_turn(std::string_view role, const detail::StandingSkeleton& from,
                                      const detail::StandingSkeleton& to, const Quaternion<double>& up) {
    if (const detail::LimbBone* limb = detail::find_limb_bone(role)) {
      const Vec3<double> bone = from.bone(*limb), wanted = to.bone(*limb);
      if (norm(bone) < 1e-9 || norm(wanted) < 1e-9) return up;
      return rotation_between(rotate(up, bone), wanted) * up;
    }
    if (role == "left_ankle" || role == "right_ankle") {
      const detail::LimbBone shin{role == "left_ankle" ? "left_knee" : "right_knee", role};
      auto roll = [&](const detail::StandingSkeleton& s) {
        const Vec3<double> bone = s.bone(shin);
        return s.table.level_soles ? 0 : std::atan2(bone.x, -bone.y);
      };
      return from_axis_angle(Vec3<double>{0, 0, 1}, roll(to) - roll(from));
    }
    const bool follows = role.empty() || role.ends_with("_foot") || role.ends_with("_hand");
    return follows ? up : Quaternion<double>::identity();
  }

  /// Lengths of legs and arms, and where the hips are.
  void measure(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to) {
    auto hip = [](const detail::StandingSkeleton& s, std::string_view role) {
      const int j = s.joint(role);
      if (j < 0) raise<config_error>(103, "SkeletonMap: ", s.table.name, " has no '", role, "'");
      return j;
    };
    left_hip_ = hip(from, "left_hip");
    right_hip_ = hip(from, "right_hip");
    target_left_hip_ = hip(to, "left_hip");
    target_right_hip_ = hip(to, "right_hip");
    auto ratio = [&](std::span<const detail::LimbBone> bones) {  // over the bones that both skeletons have
      double here = 0, there = 0;
      for (const detail::LimbBone& bone : bones) {
        const double length = from.length(bone), wanted = to.length(bone);
        if (length > 0 && wanted > 0) here += wanted, there += length;
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
  std::vector<Link> links_;  // of the target's joints
  int left_hip_ = -1, right_hip_ = -1, target_left_hip_ = -1, target_right_hip_ = -1;
};

/// Moves a clip up or down so that its feet stand on y = 0 as they do in the rest pose: the lowest joint of a frame, in
/// all but the lowest 5 % of the frames, is not below the lowest joint at rest. A rest pose that is below the floor
/// tells nothing of it (the root of many BVH files has OFFSET 0); that joint then stands on y = 0 itself. Returns by
/// how much the clip was moved.
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
  const std::size_t lowest_frames = heights.size() / 20;
  const double shift = std::max(lowest(rest), 0.0) - nth_smallest(std::move(heights), lowest_frames);
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
/// With the built-in tables that fit the clip and the target; on its own skeleton a motion stays as it is. Throws
/// config_error 103 with the joint that is missing.
inline Motion retarget(const Motion& motion, const Skeleton& target = smpl24_skeleton(),
                       const RetargetOptions& options = {}) {
  if (motion.skeleton == target) {
    Motion out = motion;
    if (options.floor) place_on_floor(out);
    return out;
  }
  return retarget(motion, SkeletonMap(motion.skeleton, target), options);
}

MOTIONLANG_NAMESPACE_END
