// SPDX-License-Identifier: MIT
/// Motions that another program generated, measured like those of a model here: the rows of other methods in the tables
/// of the papers.
///
///     const MadeMotions made("lin2018");
///     errors.push_back(made_errors(made, temos_features, data, data.test, TemosJoints(temos_features), 100));
///
/// A folder has a file for each motion of the part that is measured: its id and an extension of motion_file.hpp, such
/// as 00017.npy, or the id of its clip. Several samples of a motion are 00017_0.npy, 00017_1.npy, and so on. For models
/// of actions it has a folder for each label.
/// An .npy file of as many values in a row as the features have holds such features; other files hold motions.
/// Source  thesis tables 3.7, 4.1 and 5.7 (row "Guo"); TM2T table 2
#pragma once

#include <filesystem>  // files
#include <span>        // labels
#include <string>      // ids
#include <vector>      // rows

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/metrics/sampled_errors.hpp>
#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/temos_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The files of a motion's samples with one of these extensions, by its id, or else by its clip. There may be none.
std::vector<std::filesystem::path> made_files(const std::filesystem::path& folder, const DescribedMotion& motion,
                                              std::span<const char* const> kinds);
/// Throws io_error 401: not all of the motions, which are counted here, have a file.
[[noreturn]] void raise_not_made(const std::filesystem::path& folder, std::size_t motions, const LeftOut& missing);
/// The name of a folder, as rows of tables have it.
std::string made_name(const std::filesystem::path& folder);

}  // namespace detail

class MadeMotions {
 public:
  /// rate  frames per second of arrays of joints in the folder, which say none; 0: as published, 20 or 12.5
  explicit MadeMotions(std::filesystem::path folder, double rate = 0) : folder_(std::move(folder)), rate_(rate) {}

  /// The files of a motion's samples. Throws io_error 401 if there are none.
  std::vector<std::filesystem::path> files(const DescribedMotion& motion) const;
  /// The fewest samples that a motion of the part has. Throws io_error 401 with the first motions that have none.
  Index samples(const std::vector<DescribedMotion>& part) const;

  /// Rows of features at a rate, and that rate: features in a file keep their own.
  struct Rows {
    std::vector<float> rows;
    double fps = 0;
  };
  /// Throws io_error 401 and what readers of motions throw.
  Rows rows(const std::filesystem::path& file, const MotionFeatures& features, double fps) const;

  /// The motions of a model of actions, with their labels. Throws io_error 401 for a label without a folder or without
  /// motions.
  std::vector<DescribedMotion> of_actions(std::span<const std::string> labels, const RowMaker& maker) const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  /// The files of its id, else of its clip; there may be none.
  std::vector<std::filesystem::path> found(const DescribedMotion& motion) const;
  std::filesystem::path folder_;
  double rate_;
};

/// Errors of the first sample of each motion, as temos_errors measures: the row has the name of the folder.
/// joints    how they are measured
/// rate      frames per second of the comparison; 0: that of the data
/// recorded  the motions at this rate, as for temos_errors
NamedErrors made_errors(const MadeMotions& made, const MotionFeatures& features, const DescribedMotions& data,
                        const std::vector<DescribedMotion>& part, const TemosJoints& joints, double rate = 0,
                        std::span<const DescribedMotion> recorded = {});

/// Motions of other programs for the evaluator of Guo et al.: a random sample of each wanted motion, with at most 196
/// frames. The motions must outlive the maker.
/// width  263 for HumanML3D's features, 251 for KIT's
template <Backend B>
GuoMaker<B> made_maker(const MadeMotions& made, Index width) {
  const MotionFeatures& features = motion_features(width == 251 ? "kit" : "guoh3d");
  return [&made, &features](std::span<const GuoWanted> wanted, const Philox& rng) {
    std::vector<typename B::scalar> values;
    std::vector<Index> frames;
    auto draw = rng;
    for (const GuoWanted& w : wanted) {
      if (w.motion == nullptr) raise<config_error>(102, "made_maker: no motion for '", w.caption, "'");
      const auto files = made.files(*w.motion);
      const auto& file = files[draw.below(static_cast<std::uint32_t>(files.size()))];
      const auto rows = made.rows(file, features, features.fps).rows;
      constexpr Index longest = 196;
      const Index length = std::min<Index>(longest, std::ssize(rows) / features.width);
      values.insert(values.end(), rows.begin(), rows.begin() + length * features.width);
      frames.push_back(length);
    }
    const Offsets offsets(frames);
    return Sequences<B>{Tensor<B, 2>::from(values, {offsets.rows(), features.width}), offsets};
  };
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/made_motions.ipp>
#endif
