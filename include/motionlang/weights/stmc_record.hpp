// SPDX-License-Identifier: MIT
/// The record of an STMC run in one safetensors file, for edits in another process.
///
/// Metadata   record = "stmc", format = "1", model (a checksum of the weights), precision (core/precision.hpp), the
///            generator and the options of the run
/// Tensors    x0/000, x0/001, ... (timelines * rows, features), normalised; timeline/0, ... (texts, 3): first frame,
///            end, body parts as bits; their texts are metadata text/0/0, ...
#pragma once

#include <motionlang/compose/detail/seconds_text.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/precision.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/systems/stmc_edit.hpp>
#include <motionlang/weights/stmc_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Of all numbers of a module and their scalar.
template <Module M>
std::string weights_checksum(const M& module) {
  std::uint64_t h = 0;
  for (const auto& t : tensors_of(module)) h = content_hash(std::as_bytes(t.span()), h);
  return hexadecimal(h);
}
inline std::string metadata_real_text(double x) {
  std::string out;
  append_python_float(out, x);
  return out;
}
/// "x0/007": names whose order is that of the numbers, below 1000.
inline std::string numbered_name(const char* what, std::size_t i) {
  const std::string digits = std::to_string(i);
  return concat_text(what, '/', digits.size() < 3 ? std::string(3 - digits.size(), '0') : "", digits);
}

}  // namespace detail

/// `about` is added to the metadata. Throws io_error 401, config_error 102 if `about` would change what the record is.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
void save_stmc_record(const FilePath& path, const StmcRecord<B>& record, const Stmc<B, D, E>& stmc,
                      const std::map<std::string, std::string>& about = {}) {
  using S = typename B::scalar;
  const StmcOptions& o = record.options;
  const SamplingOptions sampling = o.sampling.value_or(stmc.sampling);
  auto text = [](auto value) { return std::to_string(value); };
  std::map<std::string, std::string> metadata{
      {"record", "stmc"},
      {"format", "1"},
      {"model", detail::weights_checksum(stmc)},
      {"precision", precision_name(product_precision())},
      {"seed", text(record.rng.seed)},
      {"stream", text(record.rng.stream)},
      {"timelines", text(record.timelines.size())},
      {"steps", text(record.x0.size())},
      {"rows", text(record.rows)},
      {"exact", record.exact ? "1" : "0"},
      {"overlap", text(o.overlap)},
      {"guidance", detail::metadata_real_text(o.guidance.value_or(stmc.guidance))},
      {"sampler", std::string(to_string(sampling.sampler))},
      {"eta", detail::metadata_real_text(sampling.eta)},
      {"noise_scale", sampling.noise_scale == NoiseScale::posterior_std ? "posterior_std" : "posterior_variance"},
      {"clip", sampling.clip ? "1" : "0"},
      {"gaps", o.gaps == Gaps::fill ? "fill" : "refuse"},
      {"hidden", o.hidden == HiddenTexts::refuse ? "refuse" : "ignore"}};
  TensorStore store;
  for (std::size_t m = 0; m < record.timelines.size(); ++m) {
    std::vector<double> rows;
    for (const Interval& i : record.timelines[m].intervals) {
      metadata.emplace(concat_text("text/", m, '/', rows.size() / 3), i.text);
      for (const auto n : {i.start, i.end, static_cast<Index>(i.parts.bits)}) rows.push_back(static_cast<double>(n));
    }
    store.add<double>(detail::numbered_name("timeline", m), {std::ssize(rows) / 3, 3}, rows, DType::F64);
  }
  for (const auto& [key, value] : about) {
    if (!metadata.emplace(key, value).second)
      raise<config_error>(102, path.string(), ": metadata '", key,
                          "' belongs to the record, not to what is told about it");
  }
  std::vector<TensorView> views = store.views();
  for (std::size_t k = 0; k < record.x0.size(); ++k) {
    views.push_back({.name = detail::numbered_name("x0", k),
                     .dtype = sizeof(S) == 4 ? DType::F32 : DType::F64,
                     .shape = record.x0[k].shape(),
                     .bytes = std::as_bytes(record.x0[k].span())});
  }
  write_safetensors(path, views, metadata);
}

namespace detail {

inline Timeline record_timeline(const SafetensorsFile& file, std::size_t m, Index rows) {
  const TensorView& view = file.tensor(numbered_name("timeline", m));
  if (view.shape.rank() != 2 || view.shape[1] != 3)
    raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.shape, ", not (texts, 3)");
  const auto numbers = values_of<double>(view);
  Timeline out;
  for (std::size_t i = 0; 3 * i < numbers.size(); ++i) {
    const auto number = [&](std::size_t column, Index largest) {
      const double x = numbers[3 * i + column];
      if (!(x >= 0 && x <= static_cast<double>(largest)))
        raise<config_error>(101, file.name(), ": ", x, " in tensor '", view.name, "' is not in 0 ... ", largest);
      return static_cast<Index>(x);
    };
    const auto text = file.metadata().find(concat_text("text/", m, '/', i));
    if (text == file.metadata().end())
      raise<config_error>(107, file.name(), ": metadata 'text/", m, "/", i, "' is missing");
    out.intervals.push_back(
        {text->second, number(0, rows), number(1, rows), {static_cast<unsigned>(number(2, BodyParts::all().bits))}});
  }
  return out;
}

}  // namespace detail

/// Reads a record and compares it with the model that is to go on with it. Throws io_error 401 ... 407, config_error
/// 101, 102 (made with other weights or another precision), 103 (no record, or of an unknown sampler), 107.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
StmcRecord<B> load_stmc_record(const SafetensorsFile& file, const Stmc<B, D, E>& stmc) {
  const auto& m = file.metadata();
  const std::string& name = file.name();
  const auto word = [&](const char* key) { return detail::metadata_text(m, key, ""); };
  const auto whole = [&](const char* key) { return detail::metadata_number<std::uint64_t>(m, key, name); };
  const auto real = [&](const char* key) { return detail::metadata_number<double>(m, key, name); };
  if (word("record") != "stmc" || word("format") != "1")
    raise<config_error>(103, name, ": not a record of an STMC run of format 1 (metadata 'record' and 'format')");
  if (const std::string model = detail::weights_checksum(stmc); word("model") != model)
    raise<config_error>(
        102, name, ": made with weights of checksum ", word("model"), ", these have ", model,
        "; the checksum of the same weights is another in another scalar, which other backends may use");
  const std::string precision = precision_name(product_precision());
  if (word("precision") != precision)
    raise<config_error>(102, name, ": made with products in ", word("precision"), ", not ", precision);
  StmcRecord<B> out{.rng = {.seed = whole("seed"), .stream = whole("stream")}};
  out.rows = detail::metadata_size(m, "rows", latest_time, name);
  out.exact = word("exact") == "1";
  out.options = {.overlap = detail::metadata_number<Index>(m, "overlap", name),
                 .guidance = real("guidance"),
                 .steps = detail::metadata_size(m, "steps", stmc.diffusion.steps(), name),
                 .sampling = SamplingOptions{.sampler = parse_sampler(word("sampler"), name + ": metadata 'sampler':"),
                                             .eta = real("eta"),
                                             .clip = word("clip") == "1"},
                 .gaps = word("gaps") == "refuse" ? Gaps::refuse : Gaps::fill,
                 .hidden = word("hidden") == "ignore" ? HiddenTexts::ignore : HiddenTexts::refuse};
  if (word("noise_scale") == "posterior_std") out.options.sampling->noise_scale = NoiseScale::posterior_std;
  const Index timelines = detail::metadata_size(m, "timelines", latest_time, name);
  for (Index i = 0; i < timelines; ++i) {
    out.timelines.push_back(detail::record_timeline(file, static_cast<std::size_t>(i), out.rows));
  }
  const Shape shape{timelines * out.rows, stmc.layout.size};
  for (Index k = 0; k < *out.options.steps; ++k) {
    const TensorView& view = file.tensor(detail::numbered_name("x0", static_cast<std::size_t>(k)));
    if (view.shape != shape)
      raise<io_error>(407, name, ": tensor '", view.name, "' is ", view.shape, ", expected ", shape);
    out.x0.push_back(Tensor<B, 2>::from(values_of<typename B::scalar>(view), shape));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
