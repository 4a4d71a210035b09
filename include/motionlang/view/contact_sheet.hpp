// SPDX-License-Identifier: MIT
/// Many motions as one picture: a grid of cells, each with a caption and a few poses. It is a self-contained SVG file,
/// or pixels.
#pragma once

#include <span>    // motions
#include <string>  // captions
#include <vector>  // frames

#include <motionlang/file/png.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A cell of the picture.
struct SheetEntry {
  const Motion& motion;
  std::string caption;
};

struct ContactSheetOptions {
  int columns = 8;
  int poses = 2;            // of each motion
  double width = 1280;      // pixels; the height follows
  std::string title{};      // "": none
  double resolution = 1.5;  // of PNG: pixels for each unit of the width
};

/// Frames whose poses differ most, in the order of time. The first choice is the frame that is farthest from the mean
/// pose, and each further one the farthest from those that are chosen. A distance is a mean over the joints, seen from
/// the root over the floor. There are fewer frames than `count` if the motion has fewer.
std::vector<Index> key_frames(const Motion& motion, int count);

/// The picture as SVG text. Throws config_error 101 without a motion or a frame, and unless there are columns, poses
/// and at least 60 pixels for each column; what Motion::validate throws.
std::string contact_sheet_svg(std::span<const SheetEntry> entries, const ContactSheetOptions& options = {});
/// The same in pixels. Throws as contact_sheet_svg, and config_error 101 for more than 20,000 pixels a side.
Picture contact_sheet_picture(std::span<const SheetEntry> entries, const ContactSheetOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/contact_sheet.ipp>
#endif
