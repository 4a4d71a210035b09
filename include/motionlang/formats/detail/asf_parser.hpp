// SPDX-License-Identifier: MIT
/// The grammar of ASF files (Acclaim skeletons). Sections begin with ":", comments with "#". Unknown properties are
/// skipped line by line.
#pragma once

#include <array>  // order of axes

#include <motionlang/file/detail/text_scanner.hpp>
#include <motionlang/formats/detail/asf_skeleton.hpp>
#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/geometry/degree.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Rotation about a coordinate axis (0, 1, 2).
inline Quaternion<double> about_axis(int axis, double radians) {
  return from_axis_angle(Vec3<double>{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0}, radians);
}

class AsfParser {
 public:
  AsfParser(std::string_view text, std::string_view name) : scan_(text, name) {
    skeleton_.name = name;
    skeleton_.bones.push_back({.name = "root"});
    axes_.push_back({});
    children_.emplace_back();
  }

  AsfSkeleton parse() && {
    while (more()) {
      const std::string_view word = scan_.word("a section");
      if (same_word(word, ":units")) {
        units();
      } else if (same_word(word, ":root")) {
        root();
      } else if (same_word(word, ":bonedata")) {
        while (in_section()) bone();
      } else if (same_word(word, ":hierarchy")) {
        hierarchy();
      } else {
        scan_.rest_of_line();  // version, name, documentation, skin
      }
    }
    for (std::size_t b = 0; b < axes_.size(); ++b) skeleton_.bones[b].axis = axes_[b].rotation(skeleton_.degrees);
    return parents_first();
  }

 private:
  /// Angles about three axes. The first axis of `order` is turned about first.
  struct Axis {
    Vec3<double> angles{};
    std::array<int, 3> order{0, 1, 2};

    Quaternion<double> rotation(bool degrees) const {
      const double unit = degrees ? degree : 1, angle[3] = {angles.x, angles.y, angles.z};
      Quaternion<double> q = Quaternion<double>::identity();
      for (std::size_t i = 0; i < 3; ++i) q = about_axis(order[i], unit * angle[order[i]]) * q;
      return q;
    }
  };

  /// True if a word follows outside of comments.
  bool more() {
    while (scan_.peek().starts_with('#')) scan_.rest_of_line();
    return !scan_.at_end();
  }
  bool in_section() { return more() && !scan_.peek().starts_with(':'); }
  std::string_view keyword() {
    more();
    return scan_.word("a keyword");
  }
  Vec3<double> vector(std::string_view wanted) {
    const double x = scan_.number(wanted), y = scan_.number(wanted);
    return {x, y, scan_.number(wanted)};
  }
  std::array<int, 3> order() {
    const std::string_view word = scan_.word("an order of axes");
    std::array<int, 3> axis{};
    unsigned seen = 0;
    for (std::size_t i = 0; i < 3 && word.size() == 3; ++i) {
      axis[i] = lower(word[i]) - 'x';
      if (axis[i] >= 0 && axis[i] <= 2) seen |= 1u << static_cast<unsigned>(axis[i]);
    }
    if (seen != 7) scan_.fail(403, "'", TextScanner::shortened(word), "' is not an order of axes");
    return axis;
  }

  void units() {
    while (in_section()) {
      const std::string_view word = keyword();
      if (same_word(word, "length")) {
        const double length = scan_.number("the unit of length");
        if (!(length > 0)) scan_.fail(403, "the unit of length is ", length);
        skeleton_.metres_per_unit = 0.0254 / length;
      } else if (same_word(word, "angle")) {
        skeleton_.degrees = !same_word(scan_.word("'deg' or 'rad'").substr(0, 3), "rad");
      } else {
        scan_.rest_of_line();
      }
    }
  }
  void root() {
    while (in_section()) {
      const std::string_view word = keyword();
      if (same_word(word, "order")) {
        channels(skeleton_.bones[0]);
      } else if (same_word(word, "axis")) {
        axes_[0].order = order();
      } else if (same_word(word, "position")) {
        skeleton_.bones[0].end = vector("a position");
      } else if (same_word(word, "orientation")) {
        axes_[0].angles = vector("an orientation");
      } else {
        scan_.rest_of_line();
      }
    }
  }
  void bone() {
    if (skeleton_.bones.size() == max_text_joints) scan_.fail(405, "more than ", max_text_joints, " bones");
    scan_.expect("begin");
    AsfBone bone;
    Axis axis;
    Vec3<double> direction{};
    double length = 0;
    for (std::string_view word = keyword(); !same_word(word, "end"); word = keyword()) {
      if (same_word(word, "name")) {
        bone.name = scan_.word("the name of a bone");
      } else if (same_word(word, "direction")) {
        direction = vector("a direction");
      } else if (same_word(word, "length")) {
        length = scan_.number("the length of a bone");
      } else if (same_word(word, "axis")) {
        axis.angles = vector("an angle");
        axis.order = order();
      } else if (same_word(word, "dof")) {
        channels(bone);
      } else if (word.starts_with(':')) {
        scan_.fail(403, "the bone '", bone.name, "' has no 'end'");
      } else {
        scan_.rest_of_line();  // id, limits, masses
      }
    }
    if (bone.name.empty()) scan_.fail(403, "a bone without a name");
    if (skeleton_.find(bone.name) >= 0) scan_.fail(403, "two bones are called '", bone.name, "'");
    bone.end = length * normalized(direction);
    skeleton_.bones.push_back(std::move(bone));
    axes_.push_back(axis);
    children_.emplace_back();
  }
  /// "TX TY TZ RX RY RZ", "rx rz", "l": to the end of the line.
  void channels(AsfBone& bone) {
    using enum AsfChannel::Kind;
    for (std::string_view w = scan_.word_on_line(); !w.empty() && w[0] != '#'; w = scan_.word_on_line()) {
      const char kind = lower(w[0]);
      const int axis = w.size() == 2 ? lower(w[1]) - 'x' : -1;
      if (kind == 'l' && w.size() == 1) {
        bone.channels.push_back({length, 0});
      } else if ((kind == 't' || kind == 'r') && axis >= 0 && axis <= 2) {
        bone.channels.push_back({kind == 't' ? translation : rotation, axis});
      } else {
        scan_.fail(403, "'", TextScanner::shortened(w), "' is not a degree of freedom");
      }
    }
  }
  /// Lines "parent child child ..." between begin and end.
  void hierarchy() {
    scan_.expect("begin");
    for (std::string_view w = keyword(); !same_word(w, "end"); w = keyword()) {
      const int parent = known(w);
      for (w = scan_.word_on_line(); !w.empty() && w[0] != '#'; w = scan_.word_on_line()) {
        const int child = known(w);
        AsfBone& bone = skeleton_.bones[static_cast<std::size_t>(child)];
        if (child == 0 || bone.parent >= 0) scan_.fail(403, "the bone '", bone.name, "' has two parents");
        bone.parent = parent;
        children_[static_cast<std::size_t>(parent)].push_back(child);
      }
    }
  }
  int known(std::string_view bone) {
    const int b = skeleton_.find(bone);
    if (b < 0) scan_.fail(403, "no bone is called '", TextScanner::shortened(bone), "'");
    return b;
  }

  /// Renumbers the bones depth first.
  AsfSkeleton parents_first() {
    AsfSkeleton sorted{{}, skeleton_.metres_per_unit, skeleton_.degrees, skeleton_.name};
    std::vector<int> number(skeleton_.bones.size(), -1), open{0};
    while (!open.empty()) {
      const auto old = static_cast<std::size_t>(open.back());
      open.pop_back();
      number[old] = static_cast<int>(sorted.bones.size());
      AsfBone bone = skeleton_.bones[old];
      if (bone.parent >= 0) bone.parent = number[static_cast<std::size_t>(bone.parent)];
      sorted.bones.push_back(std::move(bone));
      open.insert(open.end(), children_[old].rbegin(), children_[old].rend());
    }
    for (std::size_t b = 0; b < number.size(); ++b) {
      if (number[b] < 0) scan_.fail(403, "the hierarchy does not lead to the bone '", skeleton_.bones[b].name, "'");
    }
    return sorted;
  }

  TextScanner scan_;
  AsfSkeleton skeleton_;
  std::vector<Axis> axes_;  // of the bones; the unit of angles may come after them
  std::vector<std::vector<int>> children_;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
