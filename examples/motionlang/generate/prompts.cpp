#include "prompts.hpp"

#include <numbers>

#include <motionlang/kinematics/loops.hpp>

namespace program {

using ml::Index;

Measures measure(const ml::Motion& m) {
  Measures r;
  ml::JointTransforms<double> world;
  const Index n = m.frames();
  double floor = 9, path = 0, turned = 0, before = 0;
  std::vector<std::vector<ml::Vec3<double>>> frames;
  for (Index f = 0; f < n; ++f) {
    m.world(f, world);
    frames.push_back(world.position);
    for (const auto& p : world.position) floor = std::min(floor, p.y);
    const double heading = ml::detail::heading(m.rotations(f)[0]);
    if (f > 0) {
      turned += std::remainder(heading - before, 2 * std::numbers::pi);
      const auto d = m.root_at(f) - m.root_at(f - 1);
      path += std::hypot(d.x, d.z);
    }
    before = heading;
  }
  for (Index f = 0; f < n; ++f) {
    const auto& p = frames[static_cast<std::size_t>(f)];
    const double left = p[20].y - p[16].y, right = p[21].y - p[17].y;
    r.left_hand = std::max(r.left_hand, left);
    r.right_hand = std::max(r.right_hand, right);
    r.both_hands = std::max(r.both_hands, std::min(left, right));
    r.lowest_pelvis = std::min(r.lowest_pelvis, p[0].y - floor);
    r.highest_pelvis = std::max(r.highest_pelvis, p[0].y - floor);
    r.lowest_head = std::min(r.lowest_head, p[15].y - floor);
    r.left_foot = std::max(r.left_foot, p[7].y - floor);
    r.right_foot = std::max(r.right_foot, p[8].y - floor);
    r.both_feet = std::max(r.both_feet, std::min(p[10].y, p[11].y) - floor);
    if (f > 0) {
      const auto& q = frames[static_cast<std::size_t>(f) - 1];
      r.left_hand_speed = std::max(r.left_hand_speed, m.fps * ml::norm((p[20] - p[0]) - (q[20] - q[0])));
      r.right_hand_speed = std::max(r.right_hand_speed, m.fps * ml::norm((p[21] - p[0]) - (q[21] - q[0])));
    }
  }
  r.first_head = frames.front()[15].y - floor;
  r.first_pelvis = frames.front()[0].y - floor;
  r.last_pelvis = frames.back()[0].y - floor;
  r.speed = path / std::max(1e-9, static_cast<double>(n - 1) / m.fps);
  r.turned = turned * 180 / std::numbers::pi;
  const auto d = ml::rotate(ml::detail::turn(-ml::detail::heading(m.rotations(0)[0])), m.root_at(n - 1) - m.root_at(0));
  r.forward = d.z;
  return r;
}

const std::vector<Prompt>& prompts() {
  static const std::vector<Prompt> list{
      {"walk forward", 4, "goes > 2 m ahead at 0.5 to 1.9 m/s",
       [](const Measures& m) { return m.forward > 2 && m.speed > 0.5 && m.speed < 1.9; }},
      {"run forward", 3, "faster than 1.8 m/s", [](const Measures& m) { return m.speed > 1.8; }},
      {"walk backwards", 3, "goes > 0.6 m back", [](const Measures& m) { return m.forward < -0.6; }},
      {"walk slowly", 4, "0.25 to 1.1 m/s", [](const Measures& m) { return m.speed > 0.25 && m.speed < 1.1; }},
      {"stand still", 4, "slower than 0.15 m/s, pelvis stays up",
       [](const Measures& m) { return m.speed < 0.15 && m.lowest_pelvis > 0.75; }},
      {"turn left", 3, "turns > 45 degrees left", [](const Measures& m) { return m.turned > 45; }},
      {"turn right", 3, "turns > 45 degrees right", [](const Measures& m) { return m.turned < -45; }},
      {"raise both arms", 3, "both wrists > 0.15 m above the shoulders at once",
       [](const Measures& m) { return m.both_hands > 0.15; }},
      {"raise the right arm", 3, "only the right wrist > 0.1 m above its shoulder",
       [](const Measures& m) { return m.right_hand > 0.1 && m.left_hand < 0.1; }},
      {"sit down", 3, "pelvis ends > 0.2 m lower",
       [](const Measures& m) { return m.first_pelvis - m.last_pelvis > 0.2; }},
      {"jump forward", 2.5, "both feet > 0.1 m up, > 0.4 m ahead",
       [](const Measures& m) { return m.both_feet > 0.1 && m.forward > 0.4; }},
      {"bend forward", 3, "head comes > 0.25 m lower, pelvis stays above 0.6 m",
       [](const Measures& m) { return m.first_head - m.lowest_head > 0.25 && m.lowest_pelvis > 0.6; }},
  };
  return list;
}

}  // namespace program
