// SPDX-License-Identifier: MIT
/// The folder of a stage of Guo's evaluator: the published files, and a config.json that says where they come from.
///
///     config.json        license, provenance, hyperparameters
///     latest.tar         of the movement stage
///     finest.tar         of the matching stage: the evaluator
///     meta/mean.npy, meta/std.npy   the statistics of its features
///     glove/our_vab_...  the words of the matching stage
#pragma once

#include <filesystem>  // folders
#include <map>         // the record of a training
#include <optional>    // statistics
#include <string>      // the record of a training

#include <motionlang/features/normalizer.hpp>
#include <motionlang/file/fields_json.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/train/feature_statistics.hpp>
#include <motionlang/train/guo_config.hpp>
#include <motionlang/weights/glove_file.hpp>
#include <motionlang/weights/guo_evaluator_file.hpp>
#include <motionlang/weights/trained_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// config.json without weights.
void write_guo_config(const std::filesystem::path& folder, const std::string& system, const GuoTrainingConfig& config,
                      double fps, const std::map<std::string, std::string>& about);

/// The folder `meta` beside a checkpoint, or beside its folder `model`; empty if there is none with mean.npy.
std::filesystem::path guo_meta_near(const std::filesystem::path& checkpoint);

}  // namespace detail

/// How a model trained here chose its motions, with `mirror` off, so that an evaluation finds the same split; none for
/// other models. Throws io_error 403, config_error of a config.json that is damaged.
std::optional<DataConfig> data_config_of(const std::filesystem::path& model);

/// Everything except the networks. words: null if the stage has none. Throws what described_model and write_file throw.
template <Backend B>
void save_guo_folder(const std::filesystem::path& folder, const std::string& system, const GuoTrainingConfig& config,
                     double fps, const std::map<std::string, std::string>& about, const Normalizer<B>& statistics,
                     const GloVe* words) {
  std::filesystem::create_directories(folder / "meta");
  for (const auto& [name, values] : {std::pair("mean.npy", &statistics.mean), {"std.npy", &statistics.std}}) {
    const std::vector<float> numbers(values->span().begin(), values->span().end());
    write_npy(folder / "meta" / name, NpyArray::of(std::span<const float>(numbers), {values->size(0)}));
  }
  if (words != nullptr) {
    std::filesystem::create_directories(folder / "glove");
    write_glove(folder / "glove/our_vab", *words);
  }
  detail::write_guo_config(folder, system, config, fps, about);
}

/// The statistics beside a checkpoint, as its program and ours write them; none if there are none. Throws io_error 407
/// for another width.
template <Backend B>
std::optional<Normalizer<B>> guo_statistics_near(const std::filesystem::path& checkpoint, Index width) {
  const auto folder = detail::guo_meta_near(checkpoint);
  if (folder.empty()) return std::nullopt;
  auto out = statistics_of<B>(folder, width);
  out.eps = 0;
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/guo_model_folder.ipp>
#endif
