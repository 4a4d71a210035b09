// SPDX-License-Identifier: MIT
/// Reads and writes data sets in the form of HumanML3D, clip by clip. KIT-ML and most private data have this form, too.
///
///     new_joint_vecs/<id>.npy  (N, 263) float32        texts/<id>.txt      captions (humanml3d_texts.hpp)
///     new_joints/<id>.npy      (N, 22, 3) float32      Mean.npy, Std.npy   (263) float32
///     train.txt, val.txt, test.txt, train_val.txt, all.txt    ids, of mirrored clips with an M in front
///
///     const HumanMl3dFolder data("HumanML3D");
///     for (const std::string& id : data.ids("train")) use(data.load(id));
///
/// Source  Guo et al. (CVPR 2022); HumanML3D, README and cal_mean_variance.ipynb; text-to-motion data/dataset.py
#pragma once

#include <cstddef>      // numbers of captions
#include <span>         // captions
#include <string>       // ids
#include <string_view>  // names of splits
#include <utility>      // move
#include <vector>       // features

#include <motionlang/datasets/humanml3d_texts.hpp>
#include <motionlang/features/layout.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The differences between the data sets. Captions are cut at 20 frames per second in both, as published.
struct HumanMl3dForm {
  Index joints = 22;
  double fps = 20;
  Index shortest = 40, longest = 199;  // frames of a clip that the published loaders keep

  Index width() const { return Guoh3dSlots{joints}.size(); }
};
inline constexpr HumanMl3dForm humanml3d_form{}, kit_ml_form{21, 12.5, 24, 199};

struct HumanMl3dClip {
  std::string id;
  Index frames = 0;
  std::vector<float> features;  // (frames, 12 J - 1)
  std::vector<float> joints;    // (frames, J, 3)
  std::vector<MotionCaption> captions;
  bool operator==(const HumanMl3dClip&) const = default;

  /// The published set has clips with NaN (007975 and its mirror).
  bool is_finite() const;
};

/// A folder that is open for reading. Nothing is kept in memory: every call reads its files.
class HumanMl3dFolder {
 public:
  explicit HumanMl3dFolder(FilePath folder, const HumanMl3dForm& form = {}) : folder_(std::move(folder)), form_(form) {}

  const HumanMl3dForm& form() const { return form_; }
  /// The ids of <split>.txt. Throws io_error 401, 403.
  std::vector<std::string> ids(std::string_view split = "all") const;
  /// Features, joints and captions. Throws io_error 401 to 405 as read_npy, 403 as read_captions, 407 for arrays of
  /// another shape and for features and joints of different lengths.
  HumanMl3dClip load(const std::string& id) const;
  /// (frames, 12 J - 1). Throws io_error 401 to 405, 407.
  std::vector<float> features(const std::string& id) const;
  /// (frames, J, 3). Throws io_error 401 to 405, 407.
  std::vector<float> joints(const std::string& id) const;
  /// Throws io_error 401, 403.
  std::vector<MotionCaption> captions(const std::string& id) const;

  /// (12 J - 1). Throws io_error 401 to 405, 407.
  std::vector<float> mean() const;
  std::vector<float> deviation() const;

 private:
  /// Throws io_error 403 for an id that leads out of the folder.
  FilePath file(std::string_view kind, const std::string& id, std::string_view extension) const;

  FilePath folder_;
  HumanMl3dForm form_;
};

/// The items that the published loaders make of a clip: one with the captions of the whole clip, and one for each
/// caption with times of its own.
struct HumanMl3dItem {
  FrameSlice frames;
  std::vector<std::size_t> captions;  // numbers among those of the clip
  bool operator==(const HumanMl3dItem&) const = default;
};
/// The items whose length the loaders keep. None if the clip itself is too short or too long. Seconds count at 20
/// frames per second, for KIT-ML too, as published.
std::vector<HumanMl3dItem> humanml3d_items(std::span<const MotionCaption> captions, Index frames,
                                           const HumanMl3dForm& form = {});

/// Writes the files of a clip, captions last, and makes missing folders. Write the lists of ids (write_ids) after all
/// clips, so that a list never names an incomplete clip.
/// Throws io_error 401, 403 for an id that leads out of the folder, shape_error 205 if the values do not fit the form,
/// timeline_error 510 as format_captions
void write_humanml3d_clip(const FilePath& folder, const HumanMl3dClip& clip, const HumanMl3dForm& form = {});
/// Writes Mean.npy and Std.npy, for example from FeatureStatistics. Throws io_error 401, and shape_error 205 for
/// another width.
void write_humanml3d_statistics(const FilePath& folder, std::span<const float> mean, std::span<const float> deviation,
                                const HumanMl3dForm& form = {});

namespace detail {

/// The values of an array of this shape, or of any number of rows of it. Throws io_error 407 for another shape.
std::vector<float> read_rows(const FilePath& path, std::vector<Index> shape, bool any_number = false);

/// write_humanml3d_clip with the text of the file of captions, in place of the clip's own captions. Throws the same
/// without timeline_error 510.
void write_clip_files(const FilePath& folder, const HumanMl3dClip& clip, std::string_view captions,
                      const HumanMl3dForm& form = {});

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/humanml3d_folder.ipp>
#endif
