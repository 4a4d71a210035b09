// SPDX-License-Identifier: MIT
// Bodies of amass_sequence.hpp.
#pragma once

#include <algorithm>  // copy_n, find_if
#include <array>      // names of parts
#include <cmath>      // isfinite

#include <motionlang/file/npz.hpp>
#include <motionlang/file/pickle.hpp>
#include <motionlang/formats/amass_sequence.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Names of the arrays of poses that are stored in parts: face and hands are optional.
struct PosePartNames {
  std::string_view root, body;
  std::array<std::string_view, 5> more;  // in the order of SMPL-X
  std::string_view path;
};
inline constexpr PosePartNames pose_part_names[] = {
    {"root_orient", "pose_body", {"pose_jaw", "pose_eye", "pose_hand"}, "trans"},  // AMASS of SMPL-X
    {"global_orient",                                                              // parameters of the package smplx
     "body_pose",
     {"jaw_pose", "leye_pose", "reye_pose", "left_hand_pose", "right_hand_pose"},
     "transl"}};

/// The parts side by side. A hand with a number of values other than 45 has coefficients, not angles, and is left out.
template <class Matrix>
void join_pose_parts(const NpzArchive& npz, const PosePartNames& names, const Matrix& matrix, AmassSequence& out) {
  constexpr Index hand = 45;
  std::vector<NpyArray> parts{matrix(names.root), matrix(names.body)};
  for (const std::string_view name : names.more) {
    if (name.empty() || !npz.has(name)) continue;
    NpyArray part = matrix(name);
    if (!name.ends_with("_hand_pose") || part.shape[1] == hand) parts.push_back(std::move(part));
  }
  out.frames = parts.front().shape[0];
  for (const NpyArray& part : parts) {
    if (part.shape[0] != out.frames)
      raise<io_error>(407, npz.file(), ": parts of the poses have ", out.frames, " and ",
                      counted(part.shape[0], "row"));
    out.columns += part.shape[1];
  }
  out.poses.resize(static_cast<std::size_t>(out.frames * out.columns));
  Index first = 0;
  for (const NpyArray& part : parts) {
    const std::vector<double> numbers = part.to<double>();
    for (Index f = 0; f < out.frames; ++f)
      std::copy_n(numbers.begin() + f * part.shape[1], part.shape[1], out.poses.begin() + f * out.columns + first);
    first += part.shape[1];
  }
}

/// The gender of a file that has one: a text, an array of one text, or either as an object of Python, which is read and
/// not executed. Throws io_error 402 to 407 for anything else.
inline std::string amass_gender(const ZipArchive& zip) {
  const std::vector<std::byte> bytes = zip.read(*zip.find("gender.npy"));
  const std::string where = concat_text(zip.name(), "/gender");
  const NpyParts npy = npy_parts(bytes, where);
  if (npy.header.descr != "|O") return parse_npy(bytes, where).text();
  const Pickle pickle(npy.raw, where);
  return std::string(pickle.root().state()[4][0].text());  // version, shape, element type, order, elements
}

MOTIONLANG_BODY void require_finite_betas(const std::string& file, std::span<const double> betas) {
  for (std::size_t i = 0; i < betas.size(); ++i) {
    if (!std::isfinite(betas[i])) raise<numeric_error>(301, file, ": number ", i, " of 'betas' is ", betas[i]);
  }
}

}  // namespace detail

MOTIONLANG_BODY std::string_view amass_poses(const NpzArchive& npz) {
  if (npz.has("poses")) return "poses";
  for (const detail::PosePartNames& names : detail::pose_part_names) {
    if (npz.has(names.root)) return names.root;
  }
  return "";
}

MOTIONLANG_BODY std::optional<double> amass_rate(const NpzArchive& npz) {
  for (const char* name : {"mocap_frame_rate", "mocap_framerate", "fps"}) {
    if (npz.has(name)) return npz.read(name).value<double>();
  }
  return std::nullopt;
}

MOTIONLANG_BODY AmassSequence read_amass_sequence(const FilePath& path, double fps) {
  return amass_sequence(ZipArchive::open(path), fps);
}

MOTIONLANG_BODY AmassSequence amass_sequence(const ZipArchive& zip, double fps) {
  const NpzArchive npz(zip);
  constexpr Index most_columns = 4096;
  auto matrix = [&](std::string_view name) {
    NpyArray array = npz.read(name);
    if (array.shape.size() != 2) {
      raise<io_error>(407, npz.file(), ": '", name, "' has ", counted(array.shape.size(), "axis", "axes"),
                      ", 2 are expected");
    }
    if (array.shape[1] > most_columns)  // without rows, their number could be anything
      raise<io_error>(405, npz.file(), ": '", name, "' has ", counted(array.shape[1], "column"), ", at most ",
                      most_columns, " are expected");
    return array;
  };
  AmassSequence out;
  std::string_view path_name = "trans";
  const auto names = std::find_if(std::begin(detail::pose_part_names), std::end(detail::pose_part_names),
                                  [root = amass_poses(npz)](const auto& n) { return n.root == root; });
  if (names != std::end(detail::pose_part_names)) {
    detail::join_pose_parts(npz, *names, matrix, out);
    path_name = names->path;
  } else {
    const NpyArray poses = matrix("poses");
    out.frames = poses.shape[0], out.columns = poses.shape[1], out.poses = poses.to<double>();
  }
  const NpyArray trans = matrix(path_name);
  if (out.columns < 66 || out.columns % 3 != 0 || trans.shape[1] != 3 || trans.shape[0] != out.frames) {
    raise<io_error>(407, npz.file(), ": poses (", out.frames, ", ", out.columns, ") and ", path_name, " (",
                    trans.shape[0], ", ", trans.shape[1], "), expected (N, 66 or more) and (N, 3)");
  }
  out.trans = trans.to<double>();
  const std::optional<double> own = amass_rate(npz);
  if (!own && fps == 0)
    raise<io_error>(406, npz.file(), ": no frame rate 'mocap_frame_rate', 'mocap_framerate' or 'fps'; set `rate`");
  out.fps = own.value_or(fps);
  if (!(out.fps > 0 && out.fps < 1e6)) raise<io_error>(403, npz.file(), ": frame rate ", out.fps);
  if (fps != 0 && fps != out.fps)
    raise<config_error>(102, npz.file(), ": has ", out.fps, " frames per second, `rate` says ", fps);
  if (npz.has("gender")) out.gender = detail::amass_gender(zip);
  if (npz.has("betas")) {
    const NpyArray betas = npz.read("betas");
    out.betas = betas.to<double>();
    if (betas.shape.size() == 2) out.betas.resize(std::min(out.betas.size(), static_cast<std::size_t>(betas.shape[1])));
    detail::require_finite_betas(npz.file(), out.betas);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
