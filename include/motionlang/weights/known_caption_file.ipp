// SPDX-License-Identifier: MIT
// Bodies of known_caption_file.hpp.
#pragma once

#include <algorithm>  // any_of, equal, find
#include <limits>     // numbers of texts
#include <utility>    // move

#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/weights/known_caption_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr const char *captions_entry = "captions", *following_entry = "captions.then",
                            *nearness_entry = "captions.nearness";

inline std::vector<std::string> lines_of_entry(const SafetensorsFile& file, const char* entry) {
  const auto found = file.metadata().find(entry);
  if (found == file.metadata().end()) raise<config_error>(107, file.name(), ": metadata '", entry, "' is missing");
  std::vector<std::string> lines;
  for_each_line(found->second, [&](std::string_view line, Index) { lines.emplace_back(line); });
  return lines;
}

inline double nearness_of(const SafetensorsFile& file) {
  const std::string text = join_text(lines_of_entry(file, nearness_entry), " ");
  double value = 0;
  const auto [end, error] = from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= 0 && value <= 1))
    raise<config_error>(107, file.name(), ": metadata '", nearness_entry, "' = '", text, "' is not in 0 ... 1");
  return value;
}

}  // namespace detail

MOTIONLANG_BODY KnownCaptions stored_known_captions(const SafetensorsFile& file, TextVectors encode,
                                                    const WordVectors& words) {
  if (!file.metadata().contains(detail::captions_entry)) return {};
  auto texts = detail::lines_of_entry(file, detail::captions_entry);
  const auto following = detail::lines_of_entry(file, detail::following_entry);
  const std::string prefix = caption_tensors;
  const TensorView &codes = file.tensor(prefix + "codes"), &mean = file.tensor(prefix + "mean"),
                   &seconds = file.tensor(prefix + "seconds"), &then = file.tensor(prefix + "then");
  const auto require = [&](const TensorView& view, DType dtype, const FileShape& shape) {
    if (view.dtype != dtype || view.shape != shape)
      raise<io_error>(407, file.name(), ": tensor '", view.name, "' is ", view.dtype, " ", view.shape, ", not ", dtype,
                      " ", shape);
  };
  const auto* tried = file.find(prefix + "done");
  const Index all = std::ssize(texts), last = tried == nullptr ? 0 : tried->shape.count();
  const Index count = all - last;
  if (count < 1)
    raise<io_error>(407, file.name(), ": tensor '", prefix, "done' has ", counted(last, "share"), " for ",
                    counted(all, "text"));
  if (tried != nullptr) require(*tried, DType::F32, {last});
  if (mean.shape.rank() != 1) raise<io_error>(407, file.name(), ": tensor '", mean.name, "' is ", mean.shape);
  require(mean, DType::F32, {mean.shape[0]});
  require(codes, DType::I8, {all, mean.shape[0]});
  require(seconds, DType::F32, {count});
  require(then, DType::I16, {count});
  const auto require_range = [&](const TensorView& view, double least, double most) {
    for (const double x : values_of<double>(view)) {
      if (!(x >= least && x <= most))
        raise<config_error>(107, file.name(), ": tensor '", view.name, "' has a ", x, "; ", least, " ... ", most,
                            " are allowed");
    }
  };
  require_range(mean, std::numeric_limits<float>::lowest(), std::numeric_limits<float>::max());
  require_range(seconds, 0, 3600);
  if (tried != nullptr) require_range(*tried, 0, 1);
  const auto lengths = values_of<float>(seconds);
  const auto numbers = values_of<std::int16_t>(then);
  std::vector<KnownAction> actions;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (numbers[i] >= std::ssize(following))
      raise<config_error>(107, file.name(), ": caption ", i, " is followed by text ", numbers[i], " of ",
                          following.size());
    actions.push_back({.seconds = static_cast<double>(lengths[i]), .repeats = numbers[i] < 0});
    if (numbers[i] >= 0) actions.back().then = following[static_cast<std::size_t>(numbers[i])];
  }
  std::vector<double> done;
  if (tried != nullptr) done = values_of<double>(*tried);
  return {TextTable(std::move(texts), values_of<std::int8_t>(codes), values_of<float>(mean), std::move(encode), words,
                    file.name()),
          std::move(actions), detail::nearness_of(file), std::move(done), file.name()};
}

MOTIONLANG_BODY StoredCaptions::StoredCaptions(KnownCaptions captions) : captions_(std::move(captions)) {
  const auto require_line = [](const std::string& text) {
    if (text.empty() || text.find_first_of("\r\n") != text.npos)
      raise<config_error>(101, "known captions: '", text,
                          "' cannot be stored; a text is one line with at least a letter");
  };
  for (const std::string& text : captions_.table().texts()) require_line(text);
  for (const KnownAction& action : captions_.actions()) {
    seconds_.push_back(static_cast<float>(action.seconds));
    if (action.repeats) {
      then_.push_back(-1);
      continue;
    }
    require_line(action.then);
    auto found = std::find(following_.begin(), following_.end(), action.then);
    if (found == following_.end()) found = following_.insert(found, action.then);
    if (std::ssize(following_) > std::numeric_limits<std::int16_t>::max())
      raise<config_error>(101, "known captions: ", following_.size(), " different texts follow actions");
    then_.push_back(static_cast<std::int16_t>(found - following_.begin()));
  }
  for (const double share : captions_.done()) done_.push_back(static_cast<float>(share));
}

MOTIONLANG_BODY void StoredCaptions::add_to(std::vector<TensorView>& tensors,
                                            std::map<std::string, std::string>& metadata) const {
  if (captions_.empty()) return;
  const TextTable& table = captions_.table();
  const Index all = table.size(), count = std::ssize(seconds_), width = std::ssize(table.mean());
  const std::string prefix = caption_tensors;
  metadata[detail::captions_entry] = join_text(table.texts(), "\n");
  metadata[detail::following_entry] = join_text(following_, "\n");
  metadata[detail::nearness_entry] = concat_text(captions_.nearness());
  tensors.push_back(tensor_view(prefix + "codes", {all, width}, table.codes()));
  tensors.push_back(tensor_view(prefix + "mean", {width}, table.mean()));
  tensors.push_back(tensor_view(prefix + "seconds", {count}, std::span<const float>(seconds_)));
  tensors.push_back(tensor_view(prefix + "then", {count}, std::span<const std::int16_t>(then_)));
  if (!done_.empty())
    tensors.push_back(tensor_view(prefix + "done", {std::ssize(done_)}, std::span<const float>(done_)));
}

MOTIONLANG_BODY detail::FileWithoutCaptions::FileWithoutCaptions(const SafetensorsFile& file)
    : metadata(file.metadata()) {
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(caption_tensors)) tensors.push_back(t);
  }
  for (const char* entry : {captions_entry, following_entry, nearness_entry}) metadata.erase(entry);
}

MOTIONLANG_BODY void replace_known_captions(const FilePath& path, const KnownCaptions& captions) {
  const auto file = SafetensorsFile::open(path);
  detail::FileWithoutCaptions rest(file);
  const bool has_motions = std::any_of(rest.tensors.begin(), rest.tensors.end(),
                                       [](const TensorView& t) { return t.name.starts_with(memory_tensors); });
  if (has_motions) {
    const auto own = detail::lines_of_entry(file, detail::captions_entry);
    const auto count = captions.actions().size();
    if (static_cast<std::size_t>(file.tensor(std::string(caption_tensors) + "seconds").shape.count()) != count ||
        !std::equal(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(count), captions.table().texts().begin()))
      raise<config_error>(102, file.name(), ": it has motions for its captions, which would belong to others then");
  }
  const StoredCaptions stored(captions);
  stored.add_to(rest.tensors, rest.metadata);
  write_safetensors(path, rest.tensors, rest.metadata);
}

MOTIONLANG_NAMESPACE_END
