// SPDX-License-Identifier: MIT
/// The checkpoints of Guo's evaluator, as published: that of the evaluator, and that of the autoencoder whose
/// convolutions it takes. Both are read and written.
///
///     const auto evaluator = load_guo_evaluator<B>(open_weights("text_mot_match/model/finest.tar", {.path = ""}));
///     write_guo_evaluator("own/finest.tar", evaluator);        // the published programs read it
///
/// Source  Guo et al. (CVPR 2022), text-to-motion networks/evaluator_wrapper.py, networks/trainers.py (save)
#pragma once

#include <filesystem>  // places
#include <string>      // fingerprints

#include <motionlang/file/file.hpp>
#include <motionlang/file/torch_archive.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/weights/detail/run_reader.hpp>
#include <motionlang/weights/weight_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Sizes of the networks in a file, from the shapes of its tensors. Throws io_error 406, 407.
GuoEvaluatorConfig guo_evaluator_config(const TensorSet& file);

/// The networks, ready to run. The states of optimisers are skipped. Throws io_error 406, 407, numeric_error 301.
template <Backend B>
GuoEvaluator<B> load_guo_evaluator(const TensorSet& file) {
  const auto room = detail::room_of(file);
  NoInit zeros;
  GuoEvaluator<B> networks(guo_evaluator_config(file), zeros);
  detail::load_run_module(networks, file, "", [](const std::string& name) { return name.starts_with("opt_"); });
  prepare(networks);
  return networks;
}

/// The file of an evaluator: the path itself, or finest.tar in that folder or in its folder `model`. Throws io_error
/// 401 if there is none.
std::filesystem::path guo_evaluator_path(const std::filesystem::path& given);
/// True if there is such a file and it has the tensors of an evaluator.
bool is_guo_evaluator(const std::filesystem::path& given);
/// Sixteen digits that change with any byte of a file. They name the evaluator beside a table, because numbers of
/// different evaluators cannot be compared. Throws io_error 401.
std::string guo_fingerprint(const std::filesystem::path& file);

/// The file of an autoencoder: the path itself, or latest.tar in that folder or in its folder `model`. Throws io_error
/// 401.
std::filesystem::path movement_autoencoder_path(const std::filesystem::path& given);
/// The autoencoder in the published checkpoint (Decomp_SP001_SM001_H512/model/latest.tar), from a path as above.
/// dropout  of the encoder, which no tensor shows
/// Throws   io_error 401, 406, 407, numeric_error 301
template <Backend B>
MovementAutoencoder<B> load_movement_autoencoder(const std::filesystem::path& given, double dropout = 0.2);

/// finest.tar as text_mot_match has it, without the states of the optimisers. `epoch` is a number of the published
/// form.
template <Backend B>
void write_guo_evaluator(const FilePath& path, const GuoEvaluator<B>& networks, Index epoch = 0);
/// latest.tar as Decomp_... has it, without the states of the optimisers. `steps`: the number of updates.
template <Backend B>
void write_movement_autoencoder(const FilePath& path, const MovementAutoencoder<B>& networks, Index epoch = 0,
                                Index steps = 0);

namespace detail {

/// The tensors of a module as a dictionary of their names.
template <Module M>
void add_state_dict(TorchArchive& archive, std::string_view key, const M& module) {
  TensorStore store;
  store.add_module(module);
  archive.begin(key);
  for (const TensorView& t : store.views()) archive.tensor(t.name, t);
  archive.end();
}

}  // namespace detail

template <Backend B>
MovementAutoencoder<B> load_movement_autoencoder(const std::filesystem::path& given, double dropout) {
  const WeightFile file = open_weights(movement_autoencoder_path(given), {.path = ""});
  const RunFolder no_options{};
  const detail::RunReader t(no_options, file, "");
  const Index hidden = t.size("movement_enc.main.0.weight", 0), latent = t.size("movement_enc.main.3.weight", 0);
  const auto room = detail::room_of(file);
  NoInit zeros;
  MovementAutoencoder<B> out(t.size("movement_enc.main.0.weight", 1) + 4, hidden, latent, zeros, dropout);
  detail::load_run_module(out, file, "", [](const std::string& name) { return name.starts_with("opt_"); });
  return out;
}

template <Backend B>
void write_guo_evaluator(const FilePath& path, const GuoEvaluator<B>& networks, Index epoch) {
  TorchArchive archive;
  detail::add_state_dict(archive, "text_encoder", networks.text_encoder);
  detail::add_state_dict(archive, "motion_encoder", networks.motion_encoder);
  detail::add_state_dict(archive, "movement_encoder", networks.movement_encoder);
  archive.number("epoch", static_cast<std::int32_t>(epoch));
  archive.number("iter", 0);
  write_file(path, archive.finish());
}

template <Backend B>
void write_movement_autoencoder(const FilePath& path, const MovementAutoencoder<B>& networks, Index epoch,
                                Index steps) {
  TorchArchive archive;
  detail::add_state_dict(archive, "movement_enc", networks.movement_enc);
  detail::add_state_dict(archive, "movement_dec", networks.movement_dec);
  archive.number("ep", static_cast<std::int32_t>(epoch));
  archive.number("total_it", static_cast<std::int32_t>(steps));
  write_file(path, archive.finish());
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/guo_evaluator_file.ipp>
#endif
