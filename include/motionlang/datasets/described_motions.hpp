// SPDX-License-Identifier: MIT
/// Motions with texts or labels as rows of features, split into training, validation and test, for ACTOR, TEMOS and
/// TMR. There are three sources: a folder of clips with a table, folders in the form of HumanML3D or KIT-ML, or the
/// unified annotation file with its motions.
///
///     const auto data = read_described_motions({.data = "clips", .captions = "captions.tsv"}, DataConfig{},
///                                              row_maker("guoh3d"));
///
/// Shapes  rows (frames, width) of a motion, not normalised
#pragma once

#include <array>       // parts
#include <filesystem>  // where motions are
#include <functional>  // makers of rows
#include <memory>      // an opened file
#include <string>      // texts
#include <vector>      // motions

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/data_config.hpp>
#include <motionlang/datasets/left_out.hpp>
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/text/tagged_word.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Makes rows of `width` values from a clip on SMPL's 24 joints, at `fps`.
struct RowMaker {
  std::string name;
  Index width = 0;
  double fps = 0;
  std::function<std::vector<double>(const Motion&)> rows;
};

/// Makes rows of named features. Throws config_error 103 for an unknown name.
RowMaker row_maker(const std::string& features);

struct DescribedText {
  std::string text;
  FrameSlice frames;                // the rows that it describes
  std::vector<TaggedWord> words{};  // lemmas with their parts of speech, if the data set has them
};
struct DescribedMotion {
  std::string id;           // in a table: "clip@start-end", or "clip" for the whole clip; "M" at the start: mirrored
  std::string clip;         // motions of one clip are never split
  std::vector<float> rows;  // (frames, width), not normalised
  std::vector<DescribedText> texts;
};

struct DescribedMotions {
  Index width = 0;
  double fps = 0;
  std::vector<DescribedMotion> training, validation, test;
  LeftOut left_out{};

  std::array<const std::vector<DescribedMotion>*, 3> parts() const { return {&training, &validation, &test}; }
  /// Training, validation or test. Throws config_error 103.
  const std::vector<DescribedMotion>& part(const std::string& name) const;
  /// 0: training, 1: validation, 2: test, as ClipSplit numbers them.
  std::vector<DescribedMotion>& numbered_part(int part) { return part == 0 ? training : part == 1 ? validation : test; }
};

/// The different texts of all parts, sorted.
std::vector<std::string> all_texts(const DescribedMotions& data);

/// The places of the motions: one of `captions`, `labels` and `annotations`, or a `data` folder in the form of
/// HumanML3D or KIT-ML. `annotations` may come with `labels` for them.
struct DataSources {
  std::filesystem::path data{};      // folder
  std::filesystem::path captions{};  // table (clip_lines.hpp)
  std::filesystem::path labels{};    // table; with `annotations`: labels of their segments, motions or texts
  std::filesystem::path
      annotations{};  // JSON of TMR and STMC; its paths lead to .npy features, .npz (AMASS) or .bvh in `data`
  std::filesystem::path splits{};  // folder with train.txt, val.txt and test.txt; for HumanML3D the data folder itself
  bool actions = false;            // take labels, not texts, even if `annotations` has both
  std::shared_ptr<const AnnotationFile> opened{};  // `annotations` if it is already open

  bool labelled() const { return actions || !labels.empty(); }
  /// Throws config_error 102 for captions together with labels or annotations.
  void require_sound() const;
};

/// The features of the ready-made rows in the data, by their width. It reads the first training clip of a data set, or
/// the first .npy file of the annotation file, which stays open. "" if there are only clips. Throws io_error 401 to
/// 405, 407 for rows of another width.
std::string ready_made_features(DataSources& sources);

/// Throws io_error 401, 403, ... of files (with the line of the table), config_error 102 if the sources contradict each
/// other or ready-made data are not the features of `rows`, and io_error 407 for ready-made rows of another width.
DescribedMotions read_described_motions(const DataSources& sources, const DataConfig& config, const RowMaker& rows,
                                        Progress progress = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/described_motions.ipp>
#endif
