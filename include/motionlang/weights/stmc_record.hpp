// SPDX-License-Identifier: MIT
/// The record of an STMC run in one safetensors file, for edits in another process.
///
/// Metadata   record = "stmc", format = "1", model (a checksum of the weights), precision (core/precision.hpp; if there
///            are several: "bf16, fp32 from text_encoder.embedding.weight"), the generator and the options of the run;
///            for a body other than the human one body/parts, the names joined by " # ", and body/path
/// Tensors    x0/000, x0/001, ... (timelines * rows, features), normalised; timeline/0, ... (texts, 3): first frame,
///            end, body parts as bits; their texts are metadata text/0/0, ...
#pragma once

#include <motionlang/compose/detail/seconds_text.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/systems/stmc_edit.hpp>
#include <motionlang/weights/stmc_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A checksum of all values of a module and their scalar.
template <Module M>
std::string weights_checksum(const M& module) {
  std::uint64_t h = 0;
  for (const auto& t : tensors_of(module)) h = content_hash(std::as_bytes(t.span()), h);
  return hexadecimal(h);
}
/// "x0/007": names whose order is that of their numbers, below 1000.
std::string numbered_name(const char* what, std::size_t i);

/// The part that does not depend on the backend.
struct RecordAbout {
  std::vector<Timeline> timelines{};
  Philox rng{};
  StmcOptions options{};
  Index rows = 0;
  bool exact = true;
};
/// The precisions of a model's products: "bf16", or "bf16, fp32 from text_encoder.embedding.weight" if they change from
/// one weight to the next, in the order of its fields.
template <Module M>
std::string weights_precision(const M& model) {
  using B = module_backend<M>;
  Precision last = product_precision();
  std::string out;
  if constexpr (PackingBackend<B>) {
    for (const auto& t : tensors_of(model)) {
      if (!has_panels<B>(t.rank)) continue;
      const Precision own = B::precision_of(*t.data);
      if (out.empty())
        out = precision_name(own);
      else if (own != last)
        out += concat_text(", ", precision_name(own), " from ", t.path);
      last = own;
    }
  }
  return out.empty() ? precision_name(last) : out;
}

/// The weights of a model and the precisions in which they are used.
struct RecordModel {
  std::string checksum, precision;
};
template <Module M>
RecordModel record_model(const M& model) {
  return {weights_checksum(model), weights_precision(model)};
}
/// The same with the motions that the model remembers.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
RecordModel record_model_of(const Stmc<B, D, E>& stmc) {
  RecordModel out = record_model(stmc);
  if (stmc.memory) out.checksum += stmc.memory->fingerprint();
  return out;
}
/// Guidance and sampling are set in the options. The timelines go into the store.
Metadata record_metadata(const RecordAbout& run, const RecordModel& model, std::size_t steps, TensorStore& store);
/// model   the one that the edit will use
RecordAbout read_record(const SafetensorsFile& file, const RecordModel& model, Index most_steps);

}  // namespace detail

/// `about` is added to the metadata. Throws io_error 401, config_error 102 if `about` would overwrite an entry of the
/// record.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
void save_stmc_record(const FilePath& path, const StmcRecord<B>& record, const Stmc<B, D, E>& stmc,
                      const std::map<std::string, std::string>& about = {}) {
  using S = typename B::scalar;
  detail::RecordAbout run{record.timelines, record.rng, record.options, record.rows, record.exact};
  run.options.sampling = record.options.sampling.value_or(stmc.sampling);
  run.options.guidance = record.options.guidance.value_or(stmc.guidance);
  TensorStore store;
  auto metadata = detail::record_metadata(run, detail::record_model_of(stmc), record.x0.size(), store);
  detail::add_metadata(metadata, about, "record", path.string());
  std::vector<TensorView> views = store.views();
  for (std::size_t k = 0; k < record.x0.size(); ++k) {
    views.push_back({.name = detail::numbered_name("x0", k),
                     .dtype = sizeof(S) == 4 ? DType::F32 : DType::F64,
                     .shape = record.x0[k].shape(),
                     .bytes = std::as_bytes(record.x0[k].span())});
  }
  write_safetensors(path, views, metadata);
}

/// Reads a record and compares it with the model that the edit will use. Throws io_error 401 ... 407, config_error 101,
/// 102 (made with other weights or another precision), 103 (no record, or of an unknown sampler), 107.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
StmcRecord<B> load_stmc_record(const SafetensorsFile& file, const Stmc<B, D, E>& stmc) {
  detail::RecordAbout run = detail::read_record(file, detail::record_model_of(stmc), stmc.diffusion.steps());
  const Shape shape{std::ssize(run.timelines) * run.rows, stmc.layout.size};
  StmcRecord<B> out{.timelines = std::move(run.timelines),
                    .rng = run.rng,
                    .options = run.options,
                    .rows = run.rows,
                    .exact = run.exact};
  for (Index k = 0; k < *out.options.steps; ++k) {
    const TensorView& view = file.tensor(detail::numbered_name("x0", static_cast<std::size_t>(k)));
    if (view.shape != shape)
      raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.shape, ", expected ", shape);
    out.x0.push_back(Tensor<B, 2>::from(values_of<typename B::scalar>(view), shape));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/stmc_record.ipp>
#endif
