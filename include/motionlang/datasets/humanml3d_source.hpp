// SPDX-License-Identifier: MIT
/// The joints from which HumanML3D starts, from raw AMASS: the frames for a row of index.csv, and the axes. The caller
/// supplies the body as a function that poses frames, such as a BodyModel of SMPL-H on the user's own model file.
///
/// Source   Guo et al. (CVPR 2022), HumanML3D raw_pose_processing.ipynb
/// World    in: Z up, metres (AMASS). out: Y up, (x, y, z) -> (-x, z, y). HumanAct12 clips are already joints with Y
///          up. They stay as they are, and the index is not applied to them.
///
///     const auto joints = humanml3d_source_joints<double>(row, frames, fps, [&](std::span<const Index> numbers) {
///       return posed_joints(model, sequence, numbers);      // (numbers.size(), J), J >= 22
///     });
#pragma once

#include <cstdint>      // sizes
#include <span>         // frames
#include <string>       // names
#include <string_view>  // data sets
#include <vector>       // joints

#include <motionlang/features/amass_sequence.hpp>
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/body_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A row of index.csv: a clip is a part of a sequence.
struct HumanMl3dSource {
  std::string source_path;  // "./pose_data/KIT/3/kick_high_left02_poses.npy"
  Index start_frame = 0;    // at 20 frames per second, behind the lead
  Index end_frame = -1;     // -1: to the end, as published without the last frame
  std::string new_name;     // "000000.npy"
  bool operator==(const HumanMl3dSource&) const = default;
};

struct HumanMl3dSourceOptions {
  /// The published program slices [start:-1], which drops the last frame even if the clip goes to the end. true keeps
  /// it.
  bool keep_last_frame = false;
};

inline bool is_humanact12(std::string_view source_path) { return source_path.find("humanact12") != source_path.npos; }
/// HumanML3D has two bodies: the female one for everybody except "male".
inline bool humanml3d_uses_male_body(std::string_view gender) { return gender == "male"; }

/// Frames at 20 per second that are dropped before the index counts, because people stand in a T-pose there.
Index humanml3d_lead(std::string_view source_path);

/// The frames of a sequence for a row of the index: every floor(fps / 20)-th after the lead, from start to end. An end
/// behind the last frame means the last frame, as in Python's slices. Empty if the sequence is too short. Throws
/// config_error 101 for a rate below 20 frames per second and for negative frames (except end -1).
std::vector<Index> humanml3d_source_frames(const HumanMl3dSource& row, Index frames, double fps,
                                           const HumanMl3dSourceOptions& options = {});

/// The first 22 joints of the frames of a row, (frames, 22). `pose` takes frame numbers and returns their joints,
/// (frames, J) with J >= 22. For AMASS they are Z up; for HumanAct12 they are those of its files (give 20 as their
/// fps). Throws config_error 101 as humanml3d_source_frames, and shape_error 205 if `pose` does not return whole
/// frames.
template <Scalar S, class Pose>
std::vector<Vec3<S>> humanml3d_source_joints(const HumanMl3dSource& row, Index frames, double fps, Pose&& pose,
                                             const HumanMl3dSourceOptions& options = {}) {
  const std::vector<Index> numbers = humanml3d_source_frames(row, frames, fps, options);
  if (numbers.empty()) return {};
  const std::vector<Vec3<S>> posed = pose(std::span<const Index>(numbers));
  const std::size_t joints = posed.size() / numbers.size();
  if (joints < 22 || posed.size() % numbers.size() != 0) {
    raise<shape_error>(205, "humanml3d_source_joints: ", posed.size(), " joints for ", numbers.size(),
                       " frames; expected 22 or more for each");
  }
  const bool y_up = is_humanact12(row.source_path);
  std::vector<Vec3<S>> out;
  out.reserve(22 * numbers.size());
  for (std::size_t at = 0; at < posed.size(); at += joints) {
    for (std::size_t j = at; j < at + 22; ++j) {
      const Vec3<S>& p = posed[j];
      out.push_back(y_up ? p : Vec3<S>{-p.x, p.z, p.y});
    }
  }
  return out;
}

/// Joints of some frames of a sequence with a body model, (frames, J), in the sequence's own world. The model takes as
/// many rotations and shape coefficients as it has: SMPL-H all 52 joints, HumanML3D 10 coefficients. Throws shape_error
/// 205 if the sequence has fewer, and 203 for a missing frame.
template <Backend B>
std::vector<Vec3<typename B::scalar>> posed_joints(const BodyModel<B>& model, const AmassSequence& sequence,
                                                   std::span<const Index> frames) {
  using S = typename B::scalar;
  const Index n = std::ssize(frames), joints = model.joints(), shapes = model.shapedirs.size(1);
  if (sequence.columns < 3 * joints || std::ssize(sequence.betas) < shapes) {
    raise<shape_error>(205, "posed_joints: ", sequence.columns, " pose values and ", sequence.betas.size(),
                       " shape coefficients, the model needs ", 3 * joints, " and ", shapes);
  }
  std::vector<S> betas, rotations, translations;
  for (const Index frame : frames) {
    if (frame < 0 || frame >= sequence.frames) {
      raise<shape_error>(203, "posed_joints: frame ", frame, " of ", sequence.frames);
    }
    for (Index k = 0; k < shapes; ++k) betas.push_back(static_cast<S>(sequence.betas[static_cast<std::size_t>(k)]));
    const auto pose = std::span(sequence.poses).subspan(static_cast<std::size_t>(frame * sequence.columns));
    for (std::size_t j = 0; j < static_cast<std::size_t>(joints); ++j) {
      const auto r = to_matrix(AxisAngle<double>{{pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]}});
      for (const double value : r.m) rotations.push_back(static_cast<S>(value));
    }
    const double* t = sequence.trans.data() + 3 * frame;
    for (int k = 0; k < 3; ++k) translations.push_back(static_cast<S>(t[k]));
  }
  const auto posed =
      model.posed_joints(Tensor<B, 2>::from(betas, {n, shapes}), Tensor<B, 3>::from(rotations, {n, joints, 9}),
                         Tensor<B, 2>::from(translations, {n, 3}));
  const auto values = posed.to_vector();
  std::vector<Vec3<S>> out;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) out.push_back({values[i], values[i + 1], values[i + 2]});
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/humanml3d_source.ipp>
#endif
