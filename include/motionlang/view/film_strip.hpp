// SPDX-License-Identifier: MIT
/// A motion as one picture: poses from left to right in time, their shadows along the path of the root, and the texts
/// of a timeline below. Long motions take several rows. It is a self-contained SVG file, or pixels.
#pragma once

#include <span>    // tracks
#include <string>  // title

#include <motionlang/file/file_path.hpp>
#include <motionlang/file/png.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/view/track.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The colours of the figures: left and right; of the text that started last; or, for each body part, of its own text.
enum class StripColours { sides, newest_text, text_of_part };

struct FilmStripOptions {
  int poses = 0;        // 0: as many as the motion needs, one for each quarter of a metre that the joints move
  double width = 1280;  // pixels; the height follows
  StripColours colours = StripColours::sides;  // without tracks, texts have none
  std::string title{};                         // "": the name of the motion
  double resolution = 2;                       // of PNG: pixels for each unit of the width
};

/// The picture as SVG text.
/// tracks   shown below the poses of their time, one line each; times in seconds from the start of the motion
/// Throws   shape_error 205, numeric_error 301 if the motion is not valid or too far away for single precision;
///          config_error 101 without any frame, for a width below 100 or above a million, or times that are not finite
std::string film_strip_svg(const Motion& motion, std::span<const Track> tracks = {},
                           const FilmStripOptions& options = {});

/// The picture in pixels. Throws as film_strip_svg, and config_error 101 for a resolution that is not positive and
/// for a picture of more than 20,000 pixels a side.
Picture film_strip_picture(const Motion& motion, std::span<const Track> tracks = {},
                           const FilmStripOptions& options = {});

/// Writes SVG; for pixels use write_png(path, film_strip_picture(motion)). Throws io_error 401, and what film_strip_svg
/// throws.
void write_film_strip(const FilePath& path, const Motion& motion, std::span<const Track> tracks = {},
                      const FilmStripOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/film_strip.ipp>
#endif
