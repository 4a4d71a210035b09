// SPDX-License-Identifier: MIT
// Bodies of retarget.hpp.
#pragma once

#include <algorithm>  // max, min_element
#include <array>      // limbs

#include <motionlang/core/quantile.hpp>
#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/finger_names.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string to_string(const RetargetReport& r) {
  auto list = [](const std::vector<std::string>& names) {
    return names.empty() ? std::string("none") : join_text(names);
  };
  auto rounded = [](double x) { return std::round(x * 1000) / 1000; };
  std::vector<std::string> pairs;
  pairs.reserve(r.mapped.size());
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

MOTIONLANG_BODY SkeletonMap::SkeletonMap(const Skeleton& source, const SkeletonTable& source_table,
                                         const Skeleton& target, const SkeletonTable& target_table)
    : source_(source), target_(target) {
  const std::string missing = source_table.missing(source);
  if (!missing.empty()) raise<config_error>(103, "SkeletonMap: ", source_table.name, " needs a joint '", missing, "'");
  const auto from = detail::StandingSkeleton::of(source, source_table),
             to = detail::StandingSkeleton::of(target, target_table);
  report_.table = from.table.name;
  report_.target_table = to.table.name;
  for (const detail::StandingSkeleton* s : {&from, &to}) {
    const std::string lies = s->lies();
    if (!lies.empty())
      raise<config_error>(103, "SkeletonMap: a skeleton of ", s->skeleton.size(), " joints (root '",
                          s->skeleton.name(0), "') does not stand as ", s->table.name, ": ", lies, "; ",
                          detail::own_table_hint, "; option `up` turns another axis up");
  }
  connect(from, to);
  measure(from, to);
}

MOTIONLANG_BODY void SkeletonMap::apply(const JointTransforms<double>& from, Vec3<double>& root,
                                        std::span<Quaternion<double>> local) const {
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
  root = report_.leg_ratio * middle - 0.5 * (from_root(target_left_hip_, world) + from_root(target_right_hip_, world));
}

MOTIONLANG_BODY Vec3<double> SkeletonMap::from_root(int joint, const std::vector<Quaternion<double>>& world) const {
  Vec3<double> p{};
  for (; target_.parent(joint) >= 0; joint = target_.parent(joint)) {
    p = p + rotate(world[static_cast<std::size_t>(target_.parent(joint))], target_.offset(joint));
  }
  return p;
}

MOTIONLANG_BODY int SkeletonMap::namesake(const std::string& name) const {
  int s = source_.find(name);
  const std::string finger = finger_of(bare_joint_name(name));
  for (int k = 0; k < source_.size() && s < 0 && !finger.empty(); ++k) {
    if (finger_of(bare_joint_name(source_.name(k))) == finger) s = k;
  }
  return s;
}

MOTIONLANG_BODY void SkeletonMap::connect(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to) {
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

MOTIONLANG_BODY Quaternion<double> SkeletonMap::bone_turn(std::string_view role, const detail::StandingSkeleton& from,
                                                          const detail::StandingSkeleton& to,
                                                          const Quaternion<double>& up) {
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

MOTIONLANG_BODY void SkeletonMap::measure(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to) {
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

MOTIONLANG_BODY double place_on_floor(Motion& motion) {
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

MOTIONLANG_BODY Motion retarget(const Motion& motion, const SkeletonMap& map, const RetargetOptions& options) {
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

MOTIONLANG_BODY Motion retarget(const Motion& motion, const Skeleton& target, const RetargetOptions& options) {
  if (motion.skeleton == target) {
    Motion out = motion;
    if (options.floor) place_on_floor(out);
    return out;
  }
  return retarget(motion, SkeletonMap(motion.skeleton, target), options);
}

MOTIONLANG_NAMESPACE_END
