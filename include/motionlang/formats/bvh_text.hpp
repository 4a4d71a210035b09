// SPDX-License-Identifier: MIT
/// BVH files (Biovision hierarchy) unchanged: hierarchy, channels and values, read and written without loss. bvh.hpp
/// gives their meaning as a `Motion`.
#pragma once

#include <cstdint>      // BvhChannel
#include <span>         // frames
#include <string>       // names
#include <string_view>  // texts
#include <vector>       // nodes, values

#include <motionlang/core/shape.hpp>
#include <motionlang/file/file_path.hpp>
#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One column of the motion table. The axis is value % 3.
enum class BvhChannel : std::uint8_t { x_position, y_position, z_position, x_rotation, y_rotation, z_rotation };
constexpr bool is_rotation(BvhChannel c) { return c >= BvhChannel::x_rotation; }
constexpr int axis_of(BvhChannel c) { return static_cast<int>(c) % 3; }

/// A ROOT, a JOINT or an End Site.
struct BvhNode {
  std::string name;  // blanks in the file become "_"; of an end site the words after "End", usually "Site"
  int parent = -1;   // number of the node; -1 for a root
  bool end_site = false;
  Vec3<double> offset{};
  std::vector<BvhChannel> channels{};
};

/// A BVH file in its own units: nodes in file order (depth first), the table unchanged, degrees.
/// Laws   parse_bvh(format_bvh(x)) equals x up to the six printed decimals
struct Bvh {
  std::vector<BvhNode> nodes{};
  double frame_time = 1.0 / 30;  // seconds
  Index frames = 0;
  std::vector<double> values{};  // (frames, channels)
  std::string name{};            // of the file, for messages
  /// One sentence for each thing that the reader of the text left out or corrected.
  std::vector<std::string> notes{};

  Index channels() const {
    std::size_t n = 0;
    for (const BvhNode& node : nodes) n += node.channels.size();
    return static_cast<Index>(n);
  }
  std::span<const double> frame(Index f) const {
    return std::span(values).subspan(static_cast<std::size_t>(f * channels()), static_cast<std::size_t>(channels()));
  }
};

/// Reads the text of a BVH file. Accepts any order and number of channels, positions on every joint, keywords in any
/// case, and any line ends. Frames may be broken over lines; names may have blanks or stand after "End Site"; there may
/// be several ROOTs, joints without channels, UTF-16 and decimal commas. If every frame is a line, there may be more or
/// fewer frames than declared, and other text after them; `notes` report it. Throws io_error 402 (too short), 403
/// (malformed, or values left over), 405 (too many joints). Messages give file, line and column.
Bvh parse_bvh(std::string_view text, std::string_view name = "BVH text");
/// Throws io_error 401 and as parse_bvh.
Bvh read_bvh(const FilePath& path);

/// The text of a file that strict, line-based readers (Blender's) accept, too: one keyword a line, one frame a line,
/// LF, fixed notation with six decimals, nothing after the last frame. The frame time has up to nine decimals. Throws
/// numeric_error 301 for a value that is not finite, and 302 for a frame time that would be written as 0.
std::string format_bvh(const Bvh& file);
/// Throws io_error 401, and what format_bvh throws.
void write_bvh(const FilePath& path, const Bvh& file);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/bvh_text.ipp>
#endif
