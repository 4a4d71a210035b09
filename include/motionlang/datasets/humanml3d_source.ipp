// SPDX-License-Identifier: MIT
// Bodies of humanml3d_source.hpp.
#pragma once

#include <algorithm>  // clamp, max, min

#include <motionlang/datasets/humanml3d_source.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Index humanml3d_lead(std::string_view source_path) {
  struct Lead {
    std::string_view data_set;
    Index frames;
  };
  constexpr Lead leads[] = {{"Eyes_Japan_Dataset", 60},
                            {"MPI_HDM05", 60},
                            {"TotalCapture", 20},
                            {"MPI_Limits", 20},
                            {"Transitions_mocap", 10}};
  Index frames = 0;
  for (const Lead& lead : leads) {
    if (source_path.find(lead.data_set) != source_path.npos) frames += lead.frames;
  }
  return frames;
}

MOTIONLANG_BODY std::vector<Index> humanml3d_source_frames(const HumanMl3dSource& row, Index frames, double fps,
                                                           const HumanMl3dSourceOptions& options) {
  std::vector<Index> picked = every_nth_frame(frames, fps, 20);
  if (is_humanact12(row.source_path)) return picked;
  if (row.start_frame < 0 || row.end_frame < -1) {
    raise<config_error>(101, "humanml3d_source_frames: '", row.new_name, "' from frame ", row.start_frame, " to ",
                        row.end_frame);
  }
  const Index available = std::max<Index>(0, std::ssize(picked) - humanml3d_lead(row.source_path));
  const Index last = row.end_frame == -1 ? available - (options.keep_last_frame ? 0 : 1) : row.end_frame;
  picked.erase(picked.begin(), picked.end() - available);
  picked.resize(static_cast<std::size_t>(std::clamp<Index>(last, 0, available)));
  picked.erase(picked.begin(), picked.begin() + std::min<Index>(row.start_frame, std::ssize(picked)));
  return picked;
}

MOTIONLANG_NAMESPACE_END
