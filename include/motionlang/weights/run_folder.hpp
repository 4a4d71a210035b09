// SPDX-License-Identifier: MIT
/// The folders of the published systems' training programs: which system a folder belongs to, and where its options,
/// weights and statistics are. Only the options are opened.
///
///     const RunFolder run = find_run("models/mdm-smpl_clip_smplrifke_humanml3d");   // run.system == "stmc"
///
/// System         known by                                        weights
/// motionlang     config.json with "format": "motionlang"         weights.safetensors (weights/model_folder.hpp)
/// stmc           config.json with diffusion/...                  logs/checkpoints/last.ckpt, else the latest epoch
/// tmr            config.json with model/motion_encoder/...       last_weights/*.pt, else as stmc
/// hugging face   config.json with model_type                     model.safetensors, pytorch_model.bin, with an index
///                where in shards
/// mdm            args.json                                       model000475000.pt: the one with the largest number
/// actor          opt.yaml, or a checkpoint_0100.pth.tar          the checkpoint with the largest number
/// temos          .hydra/config.yaml (TEMOS, TEACH, SINC)         checkpoints/last.ckpt, else the latest epoch
/// motiondiffuse  opt.txt with diffusion_steps                    model/latest.tar, else the latest epoch
/// tm2t           any other opt.txt                               model/finest.tar, latest.tar, else the latest epoch
///
/// Packed         a config.json of "format": "motionlang" that says "published": weights/pack_run.hpp made it from the
///                folder of a system. It counts as that system, with its options and weights.safetensors. Folders of
///                tm2t and of MDM of actions are always packed, even if trained here
/// Statistics     mean and std (TEMOS: jfeats_mean, rfeats_mean ...), .pt or .npy, in the folder itself or in stats,
///                *_stats or meta
/// Source         what the training programs of these repositories write (EQUATIONS.md lists the repositories)
#pragma once

#include <algorithm>   // any_of
#include <filesystem>  // folders
#include <map>         // parts
#include <optional>    // of two places one

#include <motionlang/file/options_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct RunFolder {
  std::filesystem::path folder;
  std::string system;                                  // as above; "": unknown
  std::filesystem::path options_file;                  // empty if there is none
  std::vector<FileValue> options;                      // of that file
  std::filesystem::path weights;                       // the file with the tensors; empty if they are in parts
  std::map<std::string, std::filesystem::path> parts;  // files by the common prefix of their tensors' names
  bool packed = false;                                 // one file of weights, with the statistics

  /// Follows references. Null if no option has this path.
  const FileValue* option(std::string_view path) const { return find_option(options, path); }
};

namespace detail {

/// Numbers in names count as numbers: epoch=99 before epoch=100.
bool before_by_number(std::string_view a, std::string_view b);

/// The entries of a folder in the order of `before_by_number`; none if the path is not a folder.
std::vector<std::filesystem::path> listed(const std::filesystem::path& folder);

/// The options after "config/", which in a folder of ours are those of the system.
std::vector<FileValue> options_of_config(const RunFolder& run);

}  // namespace detail

/// Inspects a folder. Fields for missing things stay empty; the functions that need them throw.
/// Throws  io_error 401 if it cannot be listed, and what read_options throws
RunFolder find_run(const FilePath& path);

/// The same for the folder of a model, or of a training with the model inside.
RunFolder find_model_run(const FilePath& path);

/// A model is a file, or a folder with one *.safetensors file, not counting checkpoint.safetensors. Throws io_error
/// 401.
std::filesystem::path stmc_model_file(const std::filesystem::path& path);
/// The model of a training: train-tmr and similar commands put it into the folder `model` inside theirs.
std::filesystem::path found_model_folder(const FilePath& path);

/// Where a model is that STMC composes: the folder of a published one, or a file of ours.
struct StmcPlace {
  std::optional<RunFolder> run{};
  std::filesystem::path file{};  // if there is no run
};
/// Throws what find_run and stmc_model_file throw.
StmcPlace stmc_place(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/run_folder.ipp>
#endif
