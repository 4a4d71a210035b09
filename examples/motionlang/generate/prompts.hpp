// The prompts that `judge` gives to a model, and the tests of whether a motion does what its prompt says.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <motionlang/kinematics/motion.hpp>

namespace program {

namespace ml = motionlang;

/// Measurements of a motion on the 24-joint skeleton. Metres, seconds, degrees.
struct Measures {
  double speed = 0;    // of the root over the floor, mean
  double forward = 0;  // net displacement along the first heading
  double turned = 0;   // net change of heading, positive to the left
  double lowest_pelvis = 9, last_pelvis = 0, first_pelvis = 0, highest_pelvis = 0;
  double left_hand = -9, right_hand = -9;            // highest wrist above its shoulder
  double both_hands = -9;                            // highest moment of the lower wrist above its shoulder
  double left_hand_speed = 0, right_hand_speed = 0;  // largest, relative to the pelvis
  double left_foot = 0, right_foot = 0;              // highest ankle above the standing height
  double both_feet = 0;                              // highest moment of the lower foot above the floor
  double first_head = 0, lowest_head = 9;
};

Measures measure(const ml::Motion& motion);

struct Prompt {
  std::string text;
  double seconds;
  std::string rule;  // as the table prints it
  std::function<bool(const Measures&)> done;
};

/// What the free data show often: each of these is said about 19 segments or more (walking backwards) and up to 105
/// (bending).
const std::vector<Prompt>& prompts();

}  // namespace program
