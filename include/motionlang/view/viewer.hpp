// SPDX-License-Identifier: MIT
/// A page that plays motions: one self-contained HTML file, drawn with WebGL (without it, on a 2D canvas), with the
/// texts of a timeline below the figure.
#pragma once

#include <cstdint>  // weights
#include <span>     // motions
#include <string>   // texts
#include <vector>   // tracks

#include <motionlang/file/file_path.hpp>
#include <motionlang/formats/detail/skinned_mesh.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/view/track.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct ViewerOptions {
  std::string title{};    // "": the name of the first motion
  std::string info{};     // a line beside it: model, seed, ...
  bool autoplay = false;  // start at once (never for readers who ask for less movement)
};

/// One of several motions of a page.
struct ViewerMotion {
  Motion motion;
  std::vector<Track> tracks{};
  std::string note{};  // shown beside ViewerOptions::info while this motion is chosen
};

namespace detail {

/// The page with the user's body instead of the figures. The motions must be on the joints of the skeleton.
std::string body_viewer_page(std::span<const ViewerMotion> motions, const SkinnedMesh<std::uint16_t>& mesh,
                             const Skeleton& skeleton, const ViewerOptions& options);
/// The data of such a page, as JSON: {"motion": ..., "body": ...}.
std::string body_viewer_data(const Motion& motion, const SkinnedMesh<std::uint16_t>& mesh, const Skeleton& skeleton);

}  // namespace detail

/// The page as text.
/// tracks  rows below the figure; times in seconds from the start of the motion
/// Throws  config_error 101 without any motion or frame, or for times that are not finite; what Motion::validate
///         throws; numeric_error 301 for a place that single precision cannot hold
std::string viewer_html(const Motion& motion, std::span<const Track> tracks = {}, const ViewerOptions& options = {});
std::string viewer_html(std::span<const ViewerMotion> motions, const ViewerOptions& options = {});

/// The data of one motion, as JSON, which the program of such a page draws: its figure, its floor, and for every frame
/// the root and the rotations. Throws as viewer_html.
std::string viewer_data(const Motion& motion);

/// Throws io_error 401, and what viewer_html throws.
void write_viewer(const FilePath& path, const Motion& motion, std::span<const Track> tracks = {},
                  const ViewerOptions& options = {});
/// Several motions, from which the reader chooses.
void write_viewer(const FilePath& path, std::span<const ViewerMotion> motions, const ViewerOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/viewer.ipp>
#endif
