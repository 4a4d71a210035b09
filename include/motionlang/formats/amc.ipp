// SPDX-License-Identifier: MIT
// Bodies of amc.hpp.
#pragma once

#include <algorithm>  // max, min
#include <charconv>   // from_chars: numbers of frames

#include <motionlang/file/file.hpp>
#include <motionlang/formats/amc.hpp>
#include <motionlang/formats/detail/asf_parser.hpp>
#include <motionlang/geometry/degree.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY AsfSkeleton parse_asf(std::string_view text, std::string_view name) {
  return detail::AsfParser(text, name).parse();
}

MOTIONLANG_BODY AsfSkeleton read_asf(const FilePath& path) { return parse_asf(read_file(path), path.string()); }

MOTIONLANG_BODY Skeleton to_skeleton(const AsfSkeleton& asf) {
  Skeleton skeleton;
  for (const AsfBone& bone : asf.bones) {
    const bool below_root = bone.parent > 0;  // the root itself has no extent: its children start at its position
    const Vec3<double> start = below_root ? asf.bones[static_cast<std::size_t>(bone.parent)].end : Vec3<double>{};
    skeleton.names.push_back(bone.name);
    skeleton.parents.push_back(bone.parent);
    skeleton.offsets.push_back(asf.metres_per_unit * (bone.parent < 0 ? bone.end : start));
  }
  skeleton.validate();
  return skeleton;
}

namespace detail {

class AmcParser {
 public:
  AmcParser(std::string_view text, std::string_view name, const AsfSkeleton& asf)
      : scan_(text, name),
        asf_(asf),
        limit_(max_text_rotations(text.size())),
        unit_(asf.degrees ? degree : 1),
        named_(asf.bones.size()),
        ways_(asf.bones.size()) {
    motion_.name = name;
    motion_.skeleton = to_skeleton(asf);
  }

  Motion parse(double fps, std::vector<std::string>* notes) && {
    motion_.fps = fps;
    while (!scan_.at_end()) {
      const std::string_view word = scan_.word("a bone");
      if (word[0] == '#') {
        scan_.rest_of_line();
      } else if (word[0] == ':') {
        header(word);
      } else if (word.find_first_not_of("0123456789") == word.npos) {
        if (!scan_.began_line())
          scan_.fail(403, "'", TextScanner::shortened(word),
                     "' is one value too many, or a frame number that does not start a line");
        new_frame(word);
      } else {
        values(word);
      }
    }
    if (motion_.root.empty()) scan_.fail(402, "no frame");
    require_all_bones();
    for (std::size_t b = 1; b < ways_.size(); ++b) move_bone(b);
    motion_.validate();
    if (notes != nullptr) tell(*notes);
    return std::move(motion_);
  }

 private:
  /// The values of a bone's degrees of freedom other than rotations, over all frames.
  struct Ways {
    Vec3<double> low{}, high{}, sum{};
    double shortest = 0, longest = 0;  // dof "l"
    bool has_length = false;
  };

  /// A translated bone starts at its mean position, because a skeleton has constant bones.
  void move_bone(std::size_t bone) {
    const Vec3<double> mean = (1 / static_cast<double>(motion_.root.size())) * ways_[bone].sum;
    Vec3<double>& offset = motion_.skeleton.offsets[bone];
    offset = offset + asf_.metres_per_unit * rotate(asf_.bones[bone].axis, mean);
  }
  void tell(std::vector<std::string>& notes) const {
    if (const std::string& number = scan_.decimal_comma(); !number.empty())
      notes.push_back(concat_text("numbers have decimal commas: '", number, "' is read as with a point"));
    for (std::size_t b = 0; b < ways_.size(); ++b) {
      const Ways& w = ways_[b];
      if (const double way = asf_.metres_per_unit * norm(w.high - w.low); b > 0 && way > 1e-6)
        notes.push_back(concat_text("left out: how '", asf_.bones[b].name, "' is moved (tx, ty, tz) across ", way,
                                    " m: it keeps its mean place at the bone before"));
      if (w.has_length)
        notes.push_back(concat_text("left out: the lengths (l) of '", asf_.bones[b].name, "', from ", w.shortest,
                                    " to ", w.longest, ": it keeps that of the skeleton"));
    }
  }
  void header(std::string_view word) {
    if (same_word(word, ":degrees")) unit_ = degree;
    if (same_word(word, ":radians")) unit_ = 1;
    scan_.rest_of_line();
  }
  /// Frames are numbered consecutively, from any number on.
  void new_frame(std::string_view word) {
    std::uint64_t number = 0;
    const bool too_long = std::from_chars(word.data(), word.data() + word.size(), number).ec != std::errc{};
    if (too_long) scan_.fail(403, "frame ", TextScanner::shortened(word), ", a number too large");
    if (!motion_.root.empty() && number != number_ + 1) scan_.fail(403, "frame ", number, " after frame ", number_);
    if (!motion_.root.empty()) require_all_bones();
    number_ = number;
    const std::size_t joints = asf_.bones.size();
    if (motion_.local.size() + joints > limit_) {
      scan_.fail(405, "more than ", motion_.frames(), " frames of ", counted(joints, "bone"));
    }
    motion_.root.push_back(motion_.skeleton.offset(0));
    motion_.local.resize(motion_.local.size() + joints, Quaternion<double>::identity());
  }
  /// If one frame names a bone, all frames must name it; bones that no frame names are at rest.
  void require_all_bones() const {
    for (std::size_t b = 0; b < named_.size(); ++b) {
      if (named_[b] != 0 && named_[b] != motion_.root.size())
        scan_.fail(403, "frame ", number_, ", which ends here, has no numbers of '", asf_.bones[b].name,
                   "', unlike those before it");
    }
  }
  /// The values of one bone in the current frame.
  void values(std::string_view name) {
    const int number = asf_.find(name);
    if (number < 0) scan_.fail(403, "the skeleton has no bone '", TextScanner::shortened(name), "'");
    if (motion_.root.empty()) scan_.fail(403, "numbers of '", name, "' before the first frame");
    const AsfBone& bone = asf_.bones[static_cast<std::size_t>(number)];
    std::size_t& frames = named_[static_cast<std::size_t>(number)];
    if (frames == motion_.root.size()) scan_.fail(403, "frame ", number_, " has numbers of '", name, "' twice");
    if (frames == 0 && motion_.root.size() > 1)
      scan_.fail(403, "frame ", number_, " has numbers of '", name, "', unlike those before it");
    frames = motion_.root.size();
    Vec3<double> translation{};
    Ways& ways = ways_[static_cast<std::size_t>(number)];
    const bool first = motion_.root.size() == 1;
    Quaternion<double> turn = Quaternion<double>::identity();
    for (const AsfChannel& channel : bone.channels) {
      const double v = scan_.number("a value of the motion");
      if (channel.kind == AsfChannel::Kind::rotation) turn = about_axis(channel.axis, unit_ * v) * turn;
      if (channel.kind == AsfChannel::Kind::translation) {
        (channel.axis == 0 ? translation.x : channel.axis == 1 ? translation.y : translation.z) = v;
      }
      if (channel.kind == AsfChannel::Kind::length) {
        ways.shortest = ways.has_length ? std::min(ways.shortest, v) : v;
        ways.longest = ways.has_length ? std::max(ways.longest, v) : v;
        ways.has_length = true;
      }
    }
    if (first) ways.low = ways.high = translation;
    for (double Vec3<double>::*x : {&Vec3<double>::x, &Vec3<double>::y, &Vec3<double>::z}) {
      ways.low.*x = std::min(ways.low.*x, translation.*x);
      ways.high.*x = std::max(ways.high.*x, translation.*x);
      ways.sum.*x += translation.*x;
    }
    motion_.rotations(motion_.frames() - 1)[static_cast<std::size_t>(number)] = bone.axis * turn * inverse(bone.axis);
    if (number == 0) motion_.root.back() = motion_.skeleton.offset(0) + asf_.metres_per_unit * translation;
  }

  TextScanner scan_;
  const AsfSkeleton& asf_;
  std::size_t limit_;               // of rotations
  double unit_;                     // radians per unit of the angles
  std::uint64_t number_ = 0;        // of the frame
  std::vector<std::size_t> named_;  // the number of frames when a bone was last named
  std::vector<Ways> ways_;          // of each bone
  Motion motion_;
};

}  // namespace detail

MOTIONLANG_BODY Motion parse_amc(std::string_view text, const AsfSkeleton& asf, const AmcReadOptions& options,
                                 std::string_view name, std::vector<std::string>* notes) {
  return detail::AmcParser(text, name, asf).parse(options.fps, notes);
}

MOTIONLANG_BODY Motion read_amc(const FilePath& path, const AsfSkeleton& asf, const AmcReadOptions& options,
                                std::vector<std::string>* notes) {
  return parse_amc(read_file(path), asf, options, path.string(), notes);
}

MOTIONLANG_NAMESPACE_END
