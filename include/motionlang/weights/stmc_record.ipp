// SPDX-License-Identifier: MIT
// Bodies of stmc_record.hpp.
#pragma once

#include <motionlang/core/precision.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/weights/stmc_record.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::string metadata_real_text(double x) {
  std::string out;
  append_python_float(out, x);
  return out;
}

MOTIONLANG_BODY std::string numbered_name(const char* what, std::size_t i) {
  const std::string digits = std::to_string(i);
  return concat_text(what, '/', digits.size() < 3 ? std::string(3 - digits.size(), '0') : "", digits);
}

/// The body of a record's timelines.
inline BodyPartition record_body(const SafetensorsFile& file) {
  const auto parts = file.metadata().find("body/parts");
  if (parts == file.metadata().end()) return {};
  BodyPartNames names{.names = {}, .path = metadata_text(file.metadata(), "body/path", "")};
  for (std::string_view rest = parts->second; !rest.empty();) {
    const std::size_t end = std::min(rest.find('#'), rest.size());
    names.names.emplace_back(trim(rest.substr(0, end)));
    rest.remove_prefix(std::min(rest.size(), end + 1));
  }
  return BodyPartition(names);
}

inline Timeline record_timeline(const SafetensorsFile& file, const BodyPartition& body, std::size_t m, Index rows) {
  const TensorView& view = file.tensor(numbered_name("timeline", m));
  if (view.shape.rank() != 2 || view.shape[1] != 3)
    raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.shape, ", not (texts, 3)");
  const auto numbers = values_of<double>(view);
  Timeline out{{}, body};
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
        {text->second, number(0, rows), number(1, rows), {static_cast<unsigned>(number(2, body.all().bits))}});
  }
  return out;
}

MOTIONLANG_BODY Metadata record_metadata(const RecordAbout& run, const RecordModel& model, std::size_t steps,
                                         TensorStore& store) {
  const StmcOptions& o = run.options;
  const SamplingOptions sampling = *o.sampling;
  auto text = [](auto value) { return std::to_string(value); };
  Metadata metadata{
      {"record", "stmc"},
      {"format", "1"},
      {"model", model.checksum},
      {"precision", model.precision},
      {"seed", text(run.rng.seed)},
      {"stream", text(run.rng.stream)},
      {"timelines", text(run.timelines.size())},
      {"steps", text(steps)},
      {"rows", text(run.rows)},
      {"exact", run.exact ? "1" : "0"},
      {"overlap", text(o.overlap)},
      {"guidance", metadata_real_text(*o.guidance)},
      {"recall", metadata_real_text(o.recall)},
      {"sampler", std::string(to_string(sampling.sampler))},
      {"eta", metadata_real_text(sampling.eta)},
      {"noise_scale", sampling.noise_scale == NoiseScale::posterior_std ? "posterior_std" : "posterior_variance"},
      {"clip", sampling.clip ? "1" : "0"},
      {"gaps", o.gaps == Gaps::fill ? "fill" : "refuse"},
      {"hidden", o.hidden == HiddenTexts::refuse ? "refuse" : "ignore"}};
  if (!run.timelines.empty() && run.timelines.front().body != BodyPartition()) {
    const BodyPartition& body = run.timelines.front().body;  // that of all, because it is the layout's
    metadata.emplace("body/parts", join_text(body.names(), " # "));
    metadata.emplace("body/path", body.name(body.path()));
  }
  for (std::size_t m = 0; m < run.timelines.size(); ++m) {
    std::vector<double> rows;
    for (const Interval& i : run.timelines[m].intervals) {
      metadata.emplace(concat_text("text/", m, '/', rows.size() / 3), i.text);
      for (const auto n : {i.start, i.end, static_cast<Index>(i.parts.bits)}) rows.push_back(static_cast<double>(n));
    }
    store.add<double>(numbered_name("timeline", m), {std::ssize(rows) / 3, 3}, rows, DType::F64);
  }
  return metadata;
}

MOTIONLANG_BODY RecordAbout read_record(const SafetensorsFile& file, const RecordModel& model, Index most_steps) {
  const auto& m = file.metadata();
  const std::string& name = file.name();
  const auto word = [&](const char* key) { return metadata_text(m, key, ""); };
  const auto whole = [&](const char* key) { return metadata_number<std::uint64_t>(m, key, name); };
  const auto real = [&](const char* key) { return metadata_number<double>(m, key, name); };
  if (word("record") != "stmc" || word("format") != "1")
    raise<config_error>(103, name, ": not a record of an STMC run of format 1 (metadata 'record' and 'format')");
  if (word("model") != model.checksum)
    raise<config_error>(102, name, ": made with weights of checksum ", word("model"), ", these have ", model.checksum,
                        "; the same weights have another checksum in another scalar, which other backends may use");
  if (word("precision") != model.precision)
    raise<config_error>(102, name, ": made with products in ", word("precision"), ", not ", model.precision);
  RecordAbout out{.rng = {.seed = whole("seed"), .stream = whole("stream")}};
  out.rows = metadata_size(m, "rows", latest_time, name);
  out.exact = word("exact") == "1";
  out.options = {.overlap = metadata_number<Index>(m, "overlap", name),
                 .guidance = real("guidance"),
                 .steps = metadata_size(m, "steps", most_steps, name),
                 .sampling = SamplingOptions{.sampler = parse_sampler(word("sampler"), name + ": metadata 'sampler':"),
                                             .eta = real("eta"),
                                             .clip = word("clip") == "1"},
                 .gaps = word("gaps") == "refuse" ? Gaps::refuse : Gaps::fill,
                 .hidden = word("hidden") == "ignore" ? HiddenTexts::ignore : HiddenTexts::refuse};
  if (m.contains("recall")) out.options.recall = real("recall");
  if (const double recall = out.options.recall; !(recall >= 0 && recall <= 1))
    raise<config_error>(101, name, ": metadata 'recall' = ", recall, " is not in 0 ... 1");
  const bool published = word("noise_scale") != "posterior_std";
  out.options.sampling->noise_scale = published ? NoiseScale::posterior_variance : NoiseScale::posterior_std;
  const Index timelines = metadata_size(m, "timelines", latest_time, name);
  const BodyPartition body = record_body(file);
  for (Index i = 0; i < timelines; ++i) {
    out.timelines.push_back(record_timeline(file, body, static_cast<std::size_t>(i), out.rows));
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
