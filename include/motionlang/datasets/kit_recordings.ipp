// SPDX-License-Identifier: MIT
// Bodies of kit_recordings.hpp.
#pragma once

#include <dirent.h>   // opendir
#include <algorithm>  // sort
#include <cmath>      // isfinite

#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/datasets/kit_recordings.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Vec3<double>> parse_kit_joints(std::string_view text, std::string_view name) {
  constexpr std::size_t columns = 1 + 3 * KitRecording::joint_count;
  std::vector<Vec3<double>> joints;
  Index lines = 0;
  detail::for_each_line(text, [&](std::string_view line, Index number) {
    line = detail::trim(line);
    if (line.empty() || ++lines == 1) return;
    double values[columns];
    std::size_t n = 0;
    for (std::size_t at = 0; at <= line.size(); ++n) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      const std::string_view field = detail::trim(line.substr(at, end - at));
      double value = 0;
      const auto [last, status] = detail::from_chars(field.data(), field.data() + field.size(), value);
      if (status != std::errc{} || last != field.data() + field.size() || !std::isfinite(value))
        raise<io_error>(403, name, ":", number, ": '", utf8_head(field, 40), "' is not a number");
      if (n < columns) values[n] = value;
      at = end + 1;
    }
    if (n != columns)
      raise<io_error>(403, name, ":", number, ": ", counted(n, "number"), ", ", columns, " are expected");
    for (std::size_t i = 1; i < columns; i += 3) joints.push_back({values[i], values[i + 1], values[i + 2]});
  });
  if (lines == 0) raise<io_error>(402, name, ": the file is empty");
  return joints;
}

MOTIONLANG_BODY bool is_kit_recordings(const std::filesystem::path& folder) {
  std::error_code problem;
  for (std::filesystem::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    if (at->path().filename().string().ends_with("_meta.json")) return true;
  }
  return false;
}

MOTIONLANG_BODY std::filesystem::path KitAmassPaths::file(const std::string& id,
                                                          const std::filesystem::path& amass) const {
  if (!members_.has(id)) return {};
  const nlohmann::json entry = members_.load(id);
  const JsonView view(entry, members_.place(id));
  const auto path = view["path"].as<std::string>(), collection = view["identifier"].as<std::string>();
  if (!detail::is_clip_id(path)) raise<io_error>(403, view.path(), ": '", path, "' is not a path of a clip");
  if (collection != "kit" && collection != "cmu")
    raise<io_error>(403, view.path(), ": collection '", collection, "' is not kit or cmu");
  std::vector<std::string> names{path};
  constexpr std::string_view old_ending = "_poses.npz";
  if (path.ends_with(old_ending)) names.push_back(path.substr(0, path.size() - old_ending.size()) + "_stageii.npz");
  const auto folders = collection == "kit" ? std::vector{"KIT"} : std::vector{"CMU", "EKUT"};
  for (const char* folder : folders) {
    for (const std::string& name : names) {
      if (auto found = amass / folder / name; std::filesystem::exists(found)) return found;
    }
  }
  return {};
}

MOTIONLANG_BODY std::vector<std::string> KitRecordings::ids() const {
  constexpr std::string_view ending = "_meta.json";
  DIR* const folder = ::opendir(folder_.c_str());
  if (folder == nullptr) raise<io_error>(401, "cannot read the folder ", folder_.string());
  std::vector<std::string> out;
  while (const dirent* entry = ::readdir(folder)) {
    const std::string_view name = entry->d_name;
    if (name.size() > ending.size() && name.ends_with(ending))
      out.emplace_back(name.substr(0, name.size() - ending.size()));
  }
  ::closedir(folder);
  std::sort(out.begin(), out.end());
  return out;
}

MOTIONLANG_BODY std::vector<std::string> KitRecordings::annotations(const std::string& id) const {
  const FilePath meta_path = file(id, "_meta.json"), texts_path = file(id, "_annotations.json");
  const nlohmann::json meta = read_json(meta_path);
  const auto count = JsonView(meta, meta_path.string())["nb_annotations"].as<Index>();
  if (count == 0) return {};
  const nlohmann::json texts = read_json(texts_path);
  auto out = JsonView(texts, texts_path.string()).as<std::vector<std::string>>();
  if (std::ssize(out) != count) {
    raise<io_error>(403, texts_path.string(), ": ", counted(out.size(), "text"), ", ", meta_path.string(), " has ",
                    count);
  }
  return out;
}

MOTIONLANG_BODY KitRecording KitRecordings::load(const std::string& id) const {
  const FilePath path = file(id, "_fke.csv");
  return {id, annotations(id), parse_kit_joints(detail::as_text(MappedFile::open(path)->bytes()), path.string())};
}

MOTIONLANG_BODY FilePath KitRecordings::file(const std::string& id, std::string_view ending) const {
  if (!detail::is_clip_id(id)) raise<io_error>(403, folder_.string(), ": '", id, "' is not an id of a clip");
  return concat_text(folder_.string(), "/", id, ending);
}

MOTIONLANG_NAMESPACE_END
