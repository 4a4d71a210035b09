// SPDX-License-Identifier: MIT
// Bodies of figure.hpp.
#pragma once

#include <algorithm>  // max, min, min_element
#include <cctype>     // tolower
#include <optional>   // soles

#include <motionlang/formats/figure.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The role of each joint by the shape of the skeleton.
struct Anatomy {
  std::vector<Vec3<double>> rest;
  std::vector<double> reach;  // length of the longest chain of bones below the joint
  std::vector<bool> trunk;    // joints with several limbs: from the pelvis to the shoulders
  std::vector<bool> hidden;   // the bone to it is not drawn: above the pelvis, or inside the head
  std::vector<Side> side;     // from the names; if they tell nothing, from the rest pose
  int head = -1;
  double size = 0;  // about the height of a person

  explicit Anatomy(const Skeleton& s) : rest(s.rest_positions()) {
    const auto joints = static_cast<std::size_t>(s.size());
    reach.assign(joints, 0.0);
    trunk.assign(joints, false);
    hidden.assign(joints, false);
    find_trunk(s);
    find_head(s);
    for (const std::string& name : s.names) side.push_back(side_of_name(name));
    const bool named = std::any_of(side.begin(), side.end(), [](Side x) { return x != Side::middle; });
    for (std::size_t j = 0; j < joints && !named; ++j) {
      const double x = rest[j].x - rest[0].x;
      if (std::abs(x) > 0.02 * size) side[j] = x > 0 ? Side::left : Side::right;
    }
  }

 private:
  /// A leg measures the body: it is the longest chain beside an equally long one. Limbs are chains of at least a third
  /// of it. Joints with two limbs, and all joints above these, are the trunk. Bones that lead to the first such joint
  /// (from a root on the floor, for example) are hidden.
  void find_trunk(const Skeleton& s) {
    std::vector<double> second(reach.size(), 0.0);  // length of the second longest chain below the joint
    for (std::size_t j = reach.size(); j-- > 1;) {
      const auto p = static_cast<std::size_t>(s.parents[j]);
      const double chain = reach[j] + norm(s.offsets[j]);
      second[p] = std::max(second[p], std::min(reach[p], chain));
      reach[p] = std::max(reach[p], chain);
    }
    const double leg = *std::max_element(second.begin(), second.end());
    size = leg > 0 ? 1.5 * leg : reach[0] > 0 ? reach[0] : 1;
    std::size_t first = 0;
    for (std::size_t j = reach.size(); j-- > 0 && leg > 0;) {
      if (second[j] > leg / 3) trunk[j] = true, first = j;
      if (trunk[j] && j > 0) trunk[static_cast<std::size_t>(s.parents[j])] = true;
    }
    for (std::size_t j = 1; j <= first; ++j) hidden[j] = trunk[j];
  }

  /// The first joint with "head" in its name, else the highest joint outside the trunk, if it is above the trunk.
  void find_head(const Skeleton& s) {
    auto is_named = [](std::string name) {
      for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      return name.find("head") != std::string::npos;
    };
    int highest = 0;
    for (int j = 1; j < s.size(); ++j) {
      if (head < 0 && is_named(s.name(j))) head = j;
      if (rest[static_cast<std::size_t>(j)].y > rest[static_cast<std::size_t>(highest)].y) highest = j;
    }
    if (head < 0 && trunk[0] && !trunk[static_cast<std::size_t>(highest)]) head = highest;
    if (head < 0) return;
    for (auto j = static_cast<std::size_t>(head) + 1; j < hidden.size(); ++j) {
      const int p = s.parents[j];
      if (p == head || (p > head && hidden[static_cast<std::size_t>(p)])) hidden[j] = true;
    }
  }
};

/// A foot is a leaf bone near the floor that points forward: it gets a sole from the heel to the tip of the toes.
inline std::optional<RoundCone> sole(const Anatomy& anatomy, const RoundCone& bone, double reach) {
  const double unit = anatomy.size / 1.6, start = anatomy.rest[static_cast<std::size_t>(bone.joint)].y;
  const auto lower = [](const Vec3<double>& a, const Vec3<double>& b) { return a.y < b.y; };
  const double floor = std::min_element(anatomy.rest.begin(), anatomy.rest.end(), lower)->y;
  const Vec3<double> forward{bone.to.x, 0, bone.to.z};
  if (start - floor > 0.15 * unit || reach > 0.12 * unit || bone.side == Side::middle) return std::nullopt;
  if (norm(forward) < 0.05 * unit) return std::nullopt;
  return RoundCone{bone.joint, bone.to - 1.25 * forward, bone.to + 0.3 * forward, 0.034 * unit, 0.026 * unit,
                   bone.side};
}

}  // namespace detail

MOTIONLANG_BODY Figure make_figure(const Skeleton& skeleton) {
  const detail::Anatomy anatomy(skeleton);
  const double unit = anatomy.size / 1.6;  // 1 for an adult: the arm span between joints
  const double trunk_radius = 0.122 * unit;
  auto limb_radius = [&](std::size_t j) { return std::min(0.030 * unit + 0.052 * anatomy.reach[j], 0.078 * unit); };
  auto is_middle = [&](std::size_t j) { return std::abs(anatomy.rest[j].x - anatomy.rest[0].x) < 0.02 * anatomy.size; };

  Figure figure{{}, anatomy.size};
  for (int joint = 1; joint < skeleton.size(); ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    const auto p = static_cast<std::size_t>(skeleton.parents[j]);
    const double length = norm(skeleton.offsets[j]);
    if (anatomy.hidden[j] || length < 1e-4 * anatomy.size) continue;
    RoundCone cone{skeleton.parents[j], {}, skeleton.offsets[j], limb_radius(p), limb_radius(j), Side::middle};
    if (anatomy.trunk[j]) {
      cone.radius_from = cone.radius_to = trunk_radius;
    } else if (anatomy.trunk[p]) {  // hips, collars, neck: the ends of the trunk, a little inside the next limb
      cone.radius_from = 0.85 * trunk_radius;
      cone.radius_to *= 0.97;
    } else if (anatomy.reach[j] + length < 0.2 * unit && !is_middle(j)) {  // fingers, toes, tips: thinner than long
      cone.radius_to = std::min(cone.radius_to, 0.4 * length);
      cone.radius_from = std::min(cone.radius_from, std::max(cone.radius_to, 0.5 * length));
    }
    if (is_middle(j) && !anatomy.trunk[j]) cone.radius_to = std::max(cone.radius_to, 0.045 * unit);  // neck
    if (!anatomy.trunk[p]) cone.side = anatomy.side[j];
    figure.cones.push_back(cone);
    if (const auto sole = detail::sole(anatomy, cone, anatomy.reach[j])) figure.cones.push_back(*sole);
  }
  for (std::size_t j = 0; j < skeleton.ends.size(); ++j) {  // feet without joints of toes
    if (anatomy.reach[j] > 0) continue;
    const RoundCone cone{static_cast<int>(j), {}, skeleton.ends[j], limb_radius(j), limb_radius(j), anatomy.side[j]};
    if (const auto sole = detail::sole(anatomy, cone, 0)) figure.cones.insert(figure.cones.end(), {cone, *sole});
  }
  if (anatomy.head >= 0) {
    const Vec3<double> up = normalized(skeleton.offset(anatomy.head));
    figure.cones.push_back(
        {anatomy.head, 0.035 * unit * up, 0.105 * unit * up, 0.078 * unit, 0.092 * unit, Side::middle});
  }
  if (figure.cones.empty()) figure.cones.push_back({0, {}, {}, 0.06 * unit, 0.06 * unit, Side::middle});
  return figure;
}

MOTIONLANG_NAMESPACE_END
