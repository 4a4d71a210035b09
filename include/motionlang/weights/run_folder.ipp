// SPDX-License-Identifier: MIT
// Bodies of run_folder.hpp.
#pragma once

#include <motionlang/core/sort.hpp>
#include <motionlang/weights/known_systems.hpp>
#include <motionlang/weights/run_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY bool before_by_number(std::string_view a, std::string_view b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto number = [&](std::string_view& text) {  // without leading zeros; removes it from the text
    std::size_t end = 0;
    while (end < text.size() && digit(text[end])) ++end;
    const std::string_view whole = text.substr(0, end);
    text.remove_prefix(end);
    return whole.substr(std::min(whole.find_first_not_of('0'), whole.size()));
  };
  while (!a.empty() && !b.empty()) {
    if (digit(a[0]) && digit(b[0])) {
      const std::string_view x = number(a), y = number(b);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[0] != b[0]) return a[0] < b[0];
      a.remove_prefix(1), b.remove_prefix(1);
    }
  }
  return a.size() < b.size();
}

MOTIONLANG_BODY std::vector<std::filesystem::path> listed(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) out.push_back(entry.path());
  detail::sort(
      out, [](const auto& a, const auto& b) { return before_by_number(a.filename().string(), b.filename().string()); });
  return out;
}

/// The file at a place of a run; empty if there is none.
inline std::filesystem::path file_at(const std::filesystem::path& run, const WeightsPlace& place) {
  const std::filesystem::path folder = run / place.folder;
  std::error_code ignored;
  for (const std::string_view name : place.names) {
    if (!name.empty() && std::filesystem::is_regular_file(folder / name, ignored)) return folder / name;
  }
  std::filesystem::path best;
  if (place.ends.empty()) return best;
  for (const auto& p : listed(folder)) {
    const std::string name = p.filename().string();
    if (name.starts_with(place.begins) && name.ends_with(place.ends) && std::filesystem::is_regular_file(p, ignored))
      best = p;
  }
  return best;
}

/// The file at the first of these places that has one.
inline std::filesystem::path first_file(const std::filesystem::path& run, std::span<const WeightsPlace> places) {
  for (const WeightsPlace& place : places) {
    if (auto found = file_at(run, place); !found.empty()) return found;
  }
  return {};
}

inline bool has_option_below(const RunFolder& run, std::string_view beginning) {
  return std::any_of(run.options.begin(), run.options.end(),
                     [&](const FileValue& v) { return v.path.starts_with(beginning); });
}

/// The system from the options, "" if they say nothing.
inline std::string system_of_options(const RunFolder& run) {
  const std::string file = run.options_file.filename().string();
  if (file == "args.json") return "mdm";
  if (file == "opt.yaml") return "actor";
  if (file == "config.yaml") return "temos";
  if (file == "opt.txt") return run.option("diffusion_steps") != nullptr ? "motiondiffuse" : "tm2t";
  if (const FileValue* format = run.option("format"); format != nullptr && to_string(*format) == "motionlang")
    return "motionlang";
  if (has_option_below(run, "diffusion/")) return "stmc";
  if (has_option_below(run, "model/motion_encoder/")) return "tmr";
  return run.option("model_type") != nullptr ? "hugging face" : "";
}

MOTIONLANG_BODY std::vector<FileValue> options_of_config(const RunFolder& run) {
  constexpr std::string_view below = "config/";
  std::vector<FileValue> out;
  for (const FileValue& v : run.options) {
    if (v.path.starts_with(below)) out.push_back({v.path.substr(below.size()), v.value});
  }
  return out;
}

/// Replaces a packed folder's description by that of the run from which it was made. TM2T and MDM of actions have no
/// other form, even if trained here.
inline void unpack(RunFolder& run) {
  const FileValue *published = run.option("published"), *system = run.option("system");
  if (run.system != "motionlang" || system == nullptr) return;
  const bool same_form = to_string(*system) == "tm2t" || run.option("config/num_actions") != nullptr;
  if ((published == nullptr || to_string(*published) != "true") && !same_form) return;
  run.system = to_string(*system);
  if (const KnownSystem* known = known_system(run.system); known != nullptr && !known->folder_of.empty())
    run.system = known->folder_of;
  run.options = options_of_config(run);
  run.packed = true;
}

/// Files of statistics under the names "mean" and "std", behind that of their folder.
inline void add_statistics(RunFolder& run) {
  const auto add = [&](const std::filesystem::path& folder, const std::string& prefix) {
    for (const auto& p : listed(folder)) {
      const std::string name = p.filename().string();
      for (const char* what : {"mean", "std"}) {
        const std::string capital = std::string(1, static_cast<char>(what[0] - 'a' + 'A')) + (what + 1);
        for (const std::string& stem :
             {std::string(what), capital, concat_text("jfeats_", what), concat_text("rfeats_", what)}) {
          if (name == stem + ".pt" || name == stem + ".npy") run.parts.emplace(prefix + what, p);
        }
      }
    }
  };
  add(run.folder, "");
  for (const auto& p : listed(run.folder)) {
    const std::string name = p.filename().string();
    if (name == "stats" || name == "meta" || name.ends_with("_stats")) add(p, name + ".");
  }
}

inline void find_weights(RunFolder& run) {
  namespace fs = std::filesystem;
  const fs::path& folder = run.folder;
  constexpr WeightsPlace whole_place{
      "", {"weights.safetensors", "model.safetensors"}, "model", ".safetensors.index.json"};
  const fs::path whole = file_at(folder, whole_place);
  fs::path split;  // a folder of one file for each module
  for (const auto& p : listed(folder)) {
    if (p.filename().string().ends_with("_weights") && split.filename() != "last_weights") split = p;
  }
  if (run.system.empty()) {  // no options: the checkpoints tell
    const auto has_first = [&](const char* system) {
      return !file_at(folder, known_system(system)->weights.front()).empty();
    };
    run.system = has_first("actor") ? "actor" : !split.empty() ? "tmr" : has_first("mdm") && whole.empty() ? "mdm" : "";
  }
  const KnownSystem* const known = known_system(run.system);
  if (known == nullptr || run.packed || (known->modules && !whole.empty()))
    run.weights = whole;
  else if (!known->modules || split.empty())
    run.weights = first_file(folder, known->weights);
  if (known == nullptr && run.weights.empty())
    run.weights = file_at(folder, {"", {"pytorch_model.bin"}, "pytorch_model", ".bin.index.json"});

  const auto add_parts = [&](const fs::path& of) {
    for (const auto& p : listed(of)) {
      if (p.extension() == ".pt") run.parts.emplace(p.stem().string(), p);
    }
  };
  if (run.weights.empty() && !split.empty()) add_parts(split);
  add_statistics(run);
  if (run.weights.empty() && split.empty()) add_parts(folder);  // unknown system: every file is a part
}

}  // namespace detail

MOTIONLANG_BODY RunFolder find_run(const FilePath& path) {
  namespace fs = std::filesystem;
  RunFolder run{.folder = path.string(), .system = {}, .options_file = {}, .options = {}, .weights = {}, .parts = {}};
  std::error_code problem;
  static_cast<void>(fs::directory_iterator(run.folder, problem));
  if (problem) raise<io_error>(401, "cannot list ", path.string(), ": ", problem.message());
  std::error_code ignored;
  for (const char* name : {"config.json", "args.json", "opt.yaml", "opt.txt", ".hydra/config.yaml"}) {
    if (run.options_file.empty() && fs::is_regular_file(run.folder / name, ignored))
      run.options_file = run.folder / name;
  }
  if (!run.options_file.empty()) {
    run.options = read_options(run.options_file);
    run.system = detail::system_of_options(run);
    detail::unpack(run);
  }
  detail::find_weights(run);
  return run;
}

MOTIONLANG_BODY std::filesystem::path found_model_folder(const FilePath& path) {
  const std::filesystem::path folder = path.string(), inside = folder / "model";
  return !std::filesystem::exists(folder / "config.json") && std::filesystem::exists(inside / "config.json") ? inside
                                                                                                             : folder;
}

MOTIONLANG_BODY std::filesystem::path stmc_model_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return path;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() == ".safetensors" && entry.path().filename() != "checkpoint.safetensors")
      found.push_back(entry.path());
  }
  if (found.size() != 1)
    raise<io_error>(401, path.string(), ": ", found.size(), " .safetensors files where one is expected");
  return found.front();
}

MOTIONLANG_BODY RunFolder find_model_run(const FilePath& path) {
  RunFolder run = find_run(path);
  return run.system.empty() ? find_run(FilePath(found_model_folder(path))) : run;
}

MOTIONLANG_BODY StmcPlace stmc_place(const FilePath& path) {
  if (!std::filesystem::is_directory(path.string())) return {.file = path.string()};
  RunFolder run = find_model_run(path);
  if (run.system.empty()) return {.file = stmc_model_file(run.folder)};
  return {.run = std::move(run)};
}

MOTIONLANG_NAMESPACE_END
