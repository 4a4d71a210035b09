// SPDX-License-Identifier: MIT
/// The joints that TEMOS, TEACH and SINC compare, out of the 73 points of an SMPL-H body (52 joints, then vertices of
/// the face, feet and hands).
///
///     mmm      21 joints of MMM, 640 units per metre, Y up          smplmmm  21 joints of MMM, metres, Z up
///     mmmns    21 joints of MMM, metres, Y up                       smplnh   22 joints without the hands
///     smplh    all 73
/// Source  thesis 4.3.5, table 4.10; TEMOS temos/transforms/rots2joints/smplh.py
#pragma once

#include <array>        // indices
#include <span>         // points
#include <string_view>  // names
#include <vector>       // joints

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// MMM's joints among the 73 points; 59 and 62 are the heels.
inline constexpr std::array<std::size_t, 21> mmm_of_smplh{0, 3, 9, 12, 15, 16, 18, 20, 17, 19, 21,
                                                          1, 4, 7, 59, 10, 2,  5,  8,  62, 11};

/// points  (frames, 73), metres, Z up
/// trans   (frames), the place of the first root of the result, without regard to its units and axes, as published
/// result  (frames, 21, 22 or 73)
/// Throws  config_error 103 for an unknown name, shape_error 205
template <Scalar S>
std::vector<Vec3<S>> select_joints(std::string_view name, std::span<const Vec3<S>> points,
                                   std::span<const Vec3<S>> trans) {
  const bool scaled = name == "mmm", y_up = scaled || name == "mmmns", mmm = y_up || name == "smplmmm";
  if (!mmm && name != "smplnh" && name != "smplh") {
    raise<config_error>(103, "select_joints: '", name, "' is not mmm, mmmns, smplmmm, smplnh or smplh");
  }
  if (points.size() != 73 * trans.size()) {
    raise<shape_error>(205, "select_joints: ", points.size(), " points for ", trans.size(), " frames of 73");
  }
  const std::size_t joints = mmm ? mmm_of_smplh.size() : name == "smplnh" ? 22 : 73;
  std::vector<Vec3<S>> out;
  out.reserve(trans.size() * joints);
  for (std::size_t t = 0; t < trans.size(); ++t) {
    for (std::size_t j = 0; j < joints; ++j) {
      const Vec3<S> p = (scaled ? S(640) : S(1)) * points[73 * t + (mmm ? mmm_of_smplh[j] : j)];
      out.push_back(y_up ? Vec3<S>{p.y, p.z, -p.x} : p);
    }
  }
  if (out.empty()) return out;
  const Vec3<S> shift = trans[0] - out[0];
  for (Vec3<S>& p : out) p = p + shift;
  return out;
}

MOTIONLANG_NAMESPACE_END
