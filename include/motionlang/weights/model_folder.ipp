// SPDX-License-Identifier: MIT
// Bodies of model_folder.hpp.
#pragma once

#include <motionlang/weights/model_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr int model_version = 1;

inline constexpr std::string_view model_members[] = {"format",   "version", "system",       "license", "provenance",
                                                     "features", "fps",     "text_encoder", "config"};

inline bool is_model_member(std::string_view name) {
  return std::find(std::begin(model_members), std::end(model_members), name) != std::end(model_members);
}

}  // namespace detail

MOTIONLANG_BODY ModelFolder parse_model_config(std::string_view text, const std::string& name) {
  const auto document = parse_json(text, name);
  const JsonView view(document, name);
  if (const auto format = view["format"].as<std::string>(); format != detail::model_format)
    raise<config_error>(103, name, ": format is '", utf8_head(format, 80), "', expected '", detail::model_format, "'");
  if (const Index version = view.value_or("version", Index{1}); version != detail::model_version)
    raise<io_error>(404, name, ": version is ", version, ", expected ", detail::model_version);
  ModelFolder out;
  out.system = view["system"].as<std::string>();
  out.license = view.value_or("license", "");
  out.provenance = view.value_or("provenance", "");
  out.features = view.value_or("features", "");
  out.text_encoder = view.value_or("text_encoder", "");
  out.fps = view.value_or("fps", 20.0);
  if (!(out.fps > 0 && out.fps <= 1000)) raise<config_error>(101, name, ": fps is ", out.fps, ", not in (0, 1000]");
  if (!view["config"].is_object()) raise<config_error>(107, name, ": config: expected an object");
  out.config = nlohmann::ordered_json(view["config"].json());
  for (const std::string& key : view.keys()) {
    if (!detail::is_model_member(key)) out.others[key] = view[key].json();
  }
  return out;
}

MOTIONLANG_BODY ModelFolder read_model_folder(const FilePath& folder) {
  const std::string path = folder.inside(detail::model_config_file);
  return parse_model_config(read_file(path), path);
}

MOTIONLANG_BODY std::string model_config_text(const ModelFolder& m, const std::string& name) {
  for (const auto& [key, text] : {std::pair<const char*, const std::string&>{"system", m.system},
                                  {"license", m.license},
                                  {"provenance", m.provenance}}) {
    if (text.empty()) raise<config_error>(101, name, ": ", key, " is empty: users of the model need it");
    if (!is_utf8(text)) raise<io_error>(403, name, ": ", key, " is not UTF-8");
  }
  nlohmann::ordered_json out{{"format", detail::model_format},
                             {"version", detail::model_version},
                             {"system", m.system},
                             {"license", m.license},
                             {"provenance", m.provenance},
                             {"features", m.features},
                             {"fps", m.fps},
                             {"text_encoder", m.text_encoder},
                             {"config", m.config}};
  for (const auto& [key, value] : m.others.items()) {
    if (detail::is_model_member(key))
      raise<config_error>(102, name, ": '", key, "' is reserved for the description of the model");
    out[key] = value;
  }
  return out.dump(2) + "\n";
}

MOTIONLANG_BODY void write_model_folder(const FilePath& path, const ModelFolder& model,
                                        std::span<const TensorView> tensors,
                                        std::span<const std::filesystem::path> text_encoder_files) {
  namespace fs = std::filesystem;
  const std::string config = model_config_text(model, path.inside(detail::model_config_file));
  fs::path target = fs::path(path.string()).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  if (std::error_code ignored; fs::exists(target, ignored))
    raise<io_error>(401, path.string(), " exists already; remove it or choose another name");
  const fs::path part = target.string() + ".part-" + std::to_string(::getpid());
  std::error_code problem;
  fs::remove_all(part, problem);  // of a killed run with the same number
  problem.clear();
  const auto check = [&](const char* what) {
    if (!problem) return;
    const std::string reason = problem.message();
    fs::remove_all(part, problem);
    raise<io_error>(401, "cannot ", what, " ", path.string(), ": ", reason);
  };
  fs::create_directories(part, problem);
  check("make");
  const auto write = [&] {
    write_safetensors(part / detail::model_weights_file, tensors, {{"format", "motionlang"}});
    write_file(part / detail::model_config_file, std::string_view(config));
  };
  detail::guard_all(write, [&] {
    fs::remove_all(part, problem);
    return false;
  });
  if (!text_encoder_files.empty()) fs::create_directories(part / "text_encoder", problem);
  check("make text_encoder in");
  for (const fs::path& file : text_encoder_files) {
    fs::copy_file(file, part / "text_encoder" / file.filename(), problem);
    check("copy the text encoder to");
  }
  fs::rename(part, target, problem);
  check("rename to");
}

MOTIONLANG_NAMESPACE_END
