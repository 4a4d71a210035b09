// SPDX-License-Identifier: MIT
// Bodies of motion_index_file.hpp.
#pragma once

#include <utility>  // exchange

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/search/motion_index_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline nlohmann::ordered_json index_model_json(const IndexModel& m) {
  return {{"id", m.id},        {"path", m.path}, {"text_encoder", m.text_encoder},
          {"width", m.width},  {"fps", m.fps},   {"windows", m.windows},
          {"stride", m.stride}};
}

inline nlohmann::ordered_json indexed_clip_json(const IndexedClip& c) {
  nlohmann::ordered_json clip{{"path", c.path}, {"modified", c.modified}, {"bytes", c.bytes},  {"start", c.start},
                              {"end", c.end},   {"fps", c.fps},           {"frames", c.frames}};
  if (!c.content.empty()) clip["content"] = c.content;
  if (!c.lines.empty()) clip["lines"] = c.lines;
  if (!c.name.empty()) clip["name"] = c.name;
  if (!c.captions.empty()) clip["captions"] = c.captions;
  if (!c.license.empty()) clip["license"] = c.license;
  return clip;
}

inline std::string metadata_of(const SafetensorsFile& file, const char* key) {
  const auto found = file.metadata().find(key);
  return found == file.metadata().end() ? std::string() : found->second;
}
/// Throws io_error 403 for another file than an index, 404 for one of another version.
inline void require_index(const SafetensorsFile& file) {
  if (metadata_of(file, "format") != index_format) raise<io_error>(403, file.name(), ": not an index of motionlang");
  if (const std::string version = metadata_of(file, "version"); version != index_version)
    raise<io_error>(404, file.name(), ": version ", version, " of an index, expected ", index_version);
}

/// places  receives the first byte of each clip in the text, and the byte behind its last
inline std::string index_about(const MotionIndex& index, std::vector<std::int64_t>* places = nullptr) {
  std::string out = "{\"model\":" + json_text(index_model_json(index.model())) + ",\"clips\":[";
  bool first = true;
  for (const IndexedClip& c : index.clips()) {
    if (!std::exchange(first, false)) out += ',';
    const std::int64_t begin = std::ssize(out);
    out += json_text(indexed_clip_json(c));
    if (places != nullptr) places->insert(places->end(), {begin, std::ssize(out)});
  }
  return out + "]}";
}

inline IndexModel index_model(const JsonView& v) {
  return {v["id"].as<std::string>(), v["path"].as<std::string>(), v.value_or("text_encoder", ""),
          v["width"].as<Index>(),    v["fps"].as<double>(),       v["windows"].as<std::vector<Index>>(),
          v["stride"].as<Index>()};
}

inline IndexedClip indexed_clip(const JsonView& v) {
  IndexedClip c{.path = v["path"].as<std::string>(),
                .name = v.value_or("name", ""),
                .modified = v["modified"].as<std::int64_t>(),
                .bytes = v["bytes"].as<std::int64_t>(),
                .content = v.value_or("content", ""),
                .lines = v.value_or("lines", ""),
                .start = v["start"].as<double>(),
                .end = v["end"].as<double>(),
                .fps = v["fps"].as<double>(),
                .frames = v["frames"].as<Index>(),
                .captions = {},
                .license = v.value_or("license", "")};
  if (v.contains("captions")) c.captions = v["captions"].as<std::vector<std::string>>();
  return c;
}

/// The rows of a tensor in their place, or a copy if they are not aligned there.
inline VectorTable index_rows(const SafetensorsFile& file, const std::string& name, Index width) {
  const TensorView& t = file.tensor(name);
  if (t.dtype != DType::F32 || t.shape.rank() != 2 || t.shape[1] != width)
    raise<io_error>(407, file.name(), ": '", name, "' is ", t.dtype, " ", t.shape, ", not F32 vectors of ", width);
  const auto rows = direct<float>(t);
  if (rows && file.owner() != nullptr) return {*rows, file.owner()};
  VectorTable copied;
  copied.append(values_of<float>(t));
  return copied;
}

}  // namespace detail

MOTIONLANG_BODY MotionIndexFile MotionIndexFile::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return from_bytes(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY MotionIndexFile MotionIndexFile::from_bytes(std::span<const std::byte> bytes, std::string name,
                                                            std::shared_ptr<const void> owner) {
  return MotionIndexFile(SafetensorsFile::from_bytes(bytes, std::move(name), std::move(owner)));
}

MOTIONLANG_BODY std::span<const std::byte> MotionIndexFile::extra(std::string_view name) const {
  const TensorView* t = file_.find(name);
  return t == nullptr ? std::span<const std::byte>{} : t->bytes;
}

MOTIONLANG_BODY MotionIndex MotionIndexFile::read(const SafetensorsFile& file) {
  detail::require_index(file);
  const std::string written = detail::metadata_of(file, "checksum");
  if (const std::string found = tensors_checksum(file.tensors()); found != written)
    raise<io_error>(403, file.name(), ": damaged: its checksum is ", found, ", it was written with ", written);

  const TensorView& about = file.tensor("about");
  if (about.dtype != DType::U8) raise<io_error>(407, file.name(), ": 'about' is ", about.dtype, ", not U8");
  const std::string where = file.name() + ": about";
  const auto document = parse_json(detail::as_text(about.bytes), where);
  const JsonView view(document, where);
  IndexModel model = detail::index_model(view["model"]);
  const JsonView list = view["clips"];
  std::vector<IndexedClip> clips;
  for (Index i = 0; i < list.size(); ++i) clips.push_back(detail::indexed_clip(list[i]));

  const TensorView& frames = file.tensor("moment_frames");
  if (frames.shape.rank() != 2 || frames.shape[1] != 3)
    raise<io_error>(407, file.name(), ": 'moment_frames' is ", frames.shape, ", not three numbers for each moment");
  const auto numbers = values_of<std::int64_t>(frames);
  std::vector<MotionIndex::Moment> moments;
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    const auto number = [&](std::size_t j) { return static_cast<Index>(numbers[i + j]); };
    moments.push_back({number(0), {number(1), number(2)}});
  }

  const auto rows = [&](const char* name) { return detail::index_rows(file, name, model.width); };
  VectorTable clip_rows = rows("clips"), moment_rows = rows("moments"), caption_rows = rows("captions");
  return MotionIndex(file.name(), std::move(model), std::move(clips), std::move(moments), std::move(clip_rows),
                     std::move(moment_rows), std::move(caption_rows));
}

namespace detail {

/// more, metadata  further tensors and entries of the file
inline std::vector<std::byte> index_bytes(const MotionIndex& index, std::string_view about,
                                          std::span<const TensorView> more,
                                          std::map<std::string, std::string> metadata = {}) {
  const Index width = index.model().width;
  std::vector<std::int64_t> frames;
  for (const auto& m : index.moments()) frames.insert(frames.end(), {m.clip, m.frames.first, m.frames.length});
  const auto rows = [&](const char* name, std::span<const float> values) {
    return tensor_view(name, {std::ssize(values) / width, width}, values);
  };
  std::vector<TensorView> tensors{
      rows("clips", index.clip_rows()),
      rows("moments", index.moment_rows()),
      rows("captions", index.caption_rows()),
      tensor_view<std::int64_t>("moment_frames", {std::ssize(index.moments()), 3}, frames),
      {"about", DType::U8, {std::ssize(about)}, std::as_bytes(std::span<const char>(about))}};
  tensors.insert(tensors.end(), more.begin(), more.end());
  metadata["format"] = index_format, metadata["version"] = index_version;
  metadata["checksum"] = tensors_checksum(tensors);
  return safetensors_bytes(tensors, metadata);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::byte> motion_index_bytes(const MotionIndex& index, const IndexExtras& extras) {
  std::vector<TensorView> more;
  for (const auto& [name, bytes] : extras) more.push_back({name, DType::U8, {std::ssize(bytes)}, bytes});
  return detail::index_bytes(index, detail::index_about(index), more);
}

MOTIONLANG_BODY void write_motion_index(const FilePath& path, const MotionIndex& index, const IndexExtras& extras) {
  write_file(path, motion_index_bytes(index, extras));
}

MOTIONLANG_NAMESPACE_END
