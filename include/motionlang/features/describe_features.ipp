// SPDX-License-Identifier: MIT
// Bodies of describe_features.hpp.
#pragma once

#include <motionlang/core/formatted.hpp>
#include <motionlang/features/describe_features.hpp>
#include <motionlang/kinematics/describe_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// "4-66", or "0" for a single value.
inline std::string range_text(const IndexRange& r) {
  return r.size() == 1 ? concat_text(r.begin) : concat_text(r.begin, "-", r.end - 1);
}

}  // namespace detail

MOTIONLANG_BODY std::string line_about_features(const MotionFeatures& f) {
  return concat_text(f.name, ": ", f.width, " numbers in a frame, ", f.fps, " frames per second, skeleton of ",
                     f.skeleton().size(), " joints\n");
}

MOTIONLANG_BODY std::string describe_features(const MotionFeatures& f) {
  std::string out = line_about_features(f) + "values, from 0 on; their units; their meaning\n";
  for (const FeatureRange& r : f.ranges) {
    const Index joints = r.joints.size();
    const char* const of = joints == 1 ? "joint " : "each of joints ";
    out += formatted("  %-8s %-12s ", detail::range_text(r.numbers).c_str(), std::string(r.unit).c_str());
    out += concat_text(joints == 0 ? "" : of + detail::range_text(r.joints) + ": ", r.meaning, "\n");
  }
  out += "values of the body parts\n";
  const FeatureLayout layout = f.layout();
  for (const std::string_view part : body_part_names)
    out += formatted("  %-10s %s\n", std::string(part).c_str(),
                     join_text(layout.ranges(*parse_body_part(part)), ", ", detail::range_text).c_str());
  return out + "joints and their parents\n" + describe_skeleton(f.skeleton());
}

MOTIONLANG_NAMESPACE_END
