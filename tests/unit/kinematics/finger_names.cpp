// Joints of fingers by their names.
#include <doctest/doctest.h>

#include <motionlang/kinematics/finger_names.hpp>

namespace ml = motionlang;

TEST_CASE("fingers as programs name them") {
  for (const char* name : {"left_index1", "LeftHandIndex1", "mixamorig:LeftHandIndex1", "index_01_l",
                           "DEF-f_index.01.L", "lIndex1", "leftIndexProximal", "J_Bip_L_Index1", "L_Index1"})
    CHECK_MESSAGE(ml::finger_of(name) == "left_index1", name);
  CHECK(ml::finger_of("rMid2") == "right_middle2");
  CHECK(ml::finger_of("RightHandMiddle3") == "right_middle3");
  CHECK(ml::finger_of("rightLittleDistal") == "right_pinky3");
  CHECK(ml::finger_of("thumb.002.R") == "right_thumb2");
  CHECK(ml::finger_of("leftThumbMetacarpal") == "left_thumb1");  // VRM 1.0
  CHECK(ml::finger_of("rightThumbProximal") == "right_thumb2");
  CHECK(ml::finger_of("leftThumbDistal") == "left_thumb3");
  CHECK(ml::finger_of("DEF-f_ring.03.R") == "right_ring3");
}

TEST_CASE("what is not a joint of a finger") {
  for (const char* name : {"", "l", "left_hand", "LeftHand", "LeftArm", "hand_l", "index_04_leaf_l", "LeftHandIndex4",
                           "LeftHandIndex1_end", "index_metacarpal_l", "LeftInHandIndex", "index1", "string1",
                           "lowerarm_twist_01_l", "left_right_index1", "LeftHandIndex99999999999999999999"})
    CHECK_MESSAGE(ml::finger_of(name).empty(), name);
}
