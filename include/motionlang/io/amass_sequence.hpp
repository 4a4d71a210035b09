// SPDX-License-Identifier: MIT
/// AMASS files as they stand, for a body model: all rotation vectors, shape and gender, world Z up. As a Motion on SMPL's
/// bones: amass.hpp.
///
/// Source  Mahmood et al. (ICCV 2019); spec body-models.md 6
#pragma once

#include <algorithm>    // copy_n
#include <string_view>  // names of arrays

#include <motionlang/features/amass_sequence.hpp>
#include <motionlang/io/npz.hpp>
#include <motionlang/io/pickle.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// Poses that SMPL-X tools store in parts, side by side: root and body, face and hands where they are there.
template <class Matrix>
void join_pose_parts(const NpzArchive& npz, const Matrix& matrix, AmassSequence& out) {
  std::vector<NpyArray> parts{matrix("root_orient"), matrix("pose_body")};
  for (const char* name : {"pose_jaw", "pose_eye", "pose_hand"}) {
    if (npz.has(name)) parts.push_back(matrix(name));
  }
  out.frames = parts.front().shape[0];
  for (const NpyArray& part : parts) {
    if (part.shape[0] != out.frames)
      raise<io_error>(407, npz.file(), ": parts of the poses have ", out.frames, " and ", part.shape[0], " rows");
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

/// The gender of a file that has one: a text, or an array of one, or either as an object of Python, which is read and not
/// run. Throws io_error 402 to 407 for anything else.
inline std::string amass_gender(const ZipArchive& zip) {
  const std::vector<std::byte> bytes = zip.read(*zip.find("gender.npy"));
  const std::string where = concat_text(zip.name(), "/gender");
  const NpyParts npy = npy_parts(bytes, where);
  if (npy.header.descr != "|O") return parse_npy(bytes, where).text();
  const Pickle pickle(npy.raw, where);
  return std::string(pickle.root().state()[4][0].text());  // version, shape, element type, order, elements
}

}  // namespace detail

/// The array that the poses of a sequence begin with: "poses", or "root_orient" where they are stored in parts. ""
/// where the archive holds no sequence, as the shape.npz files beside them.
inline std::string_view amass_poses(const NpzArchive& npz) {
  return npz.has("poses") ? "poses" : npz.has("root_orient") ? "root_orient" : "";
}

/// A sequence of SMPL (72 columns), SMPL-H (156, mocap_framerate) or SMPL-X (165, mocap_frame_rate), whose poses
/// may be stored in parts (root_orient, pose_body, ...). The gender may be a text or an array of one, as in SSM_synced,
/// or that as an object of Python.
/// Throws  io_error 401 to 405, 406 if an array is missing (as in the shape.npz files beside the sequences, which are no
///         motion), 407 if one has another shape, 403 for an impossible frame rate
inline AmassSequence read_amass_sequence(const FilePath& path) {
  const ZipArchive zip = ZipArchive::open(path);
  const NpzArchive npz(zip);
  auto matrix = [&](std::string_view name) {
    NpyArray array = npz.read(name);
    if (array.shape.size() != 2) {
      raise<io_error>(407, npz.file(), ": '", name, "' has ", array.shape.size(), " axes, 2 are expected");
    }
    return array;
  };
  AmassSequence out;
  if (amass_poses(npz) == "root_orient") {
    detail::join_pose_parts(npz, matrix, out);
  } else {
    const NpyArray poses = matrix("poses");
    out.frames = poses.shape[0], out.columns = poses.shape[1], out.poses = poses.to<double>();
  }
  const NpyArray trans = matrix("trans");
  if (out.columns < 66 || out.columns % 3 != 0 || trans.shape[1] != 3 || trans.shape[0] != out.frames) {
    raise<io_error>(407, npz.file(), ": poses (", out.frames, ", ", out.columns, ") and trans (", trans.shape[0], ", ",
                    trans.shape[1], "), expected (N, 66 or more) and (N, 3)");
  }
  out.trans = trans.to<double>();
  out.fps = npz.read(npz.has("mocap_frame_rate") ? "mocap_frame_rate" : "mocap_framerate").value<double>();
  if (!(out.fps > 0 && out.fps < 1e6)) raise<io_error>(403, npz.file(), ": frame rate ", out.fps);
  if (npz.has("gender")) out.gender = detail::amass_gender(zip);
  if (npz.has("betas")) out.betas = npz.read("betas").to<double>();
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
