// SPDX-License-Identifier: MIT
// Bodies of guo_evaluator_file.hpp.
#pragma once

#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/weights/guo_evaluator_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GuoEvaluatorConfig guo_evaluator_config(const TensorSet& file) {
  const RunFolder no_options{};
  const detail::RunReader t(no_options, file, "");
  const std::string movement = "movement_encoder.main.", text = "text_encoder.";
  return {.features = t.size(movement + "0.weight", 1) + 4,
          .movement_hidden = t.size(movement + "0.weight", 0),
          .movement_latent = t.size(movement + "3.weight", 0),
          .word = t.size(text + "pos_emb.weight", 0),
          .pos = t.size(text + "pos_emb.weight", 1),
          .text_hidden = t.size(text + "hidden", 2),
          .motion_hidden = t.size("motion_encoder.hidden", 2),
          .embedding = t.size(text + "output_net.3.weight", 0)};
}

namespace detail {

/// The file of this name that a path means: itself, or in the folder or its folder `model`. Empty if there is none.
inline std::filesystem::path checkpoint_at(const std::filesystem::path& given, const char* name) {
  if (!std::filesystem::is_directory(given)) return std::filesystem::exists(given) ? given : std::filesystem::path();
  for (const auto& place : {given / name, given / "model" / name}) {
    if (std::filesystem::exists(place)) return place;
  }
  return {};
}

}  // namespace detail

MOTIONLANG_BODY std::filesystem::path movement_autoencoder_path(const std::filesystem::path& given) {
  auto found = detail::checkpoint_at(given, "latest.tar");
  if (found.empty())
    raise<io_error>(401, given.string(), ": no latest.tar of a movement autoencoder, and none in its folder model");
  return found;
}

MOTIONLANG_BODY std::filesystem::path guo_evaluator_path(const std::filesystem::path& given) {
  auto found = detail::checkpoint_at(given, "finest.tar");
  if (found.empty()) raise<io_error>(401, "`evaluator` ", given.string(), ": no finest.tar and no model/finest.tar");
  return found;
}

MOTIONLANG_BODY bool is_guo_evaluator(const std::filesystem::path& given) {
  const auto found = detail::checkpoint_at(given, "finest.tar");
  if (found.empty() || found.extension() != ".tar") return false;
  return open_weights(found, {.path = ""}).find("text_encoder.pos_emb.weight") != nullptr;
}

MOTIONLANG_BODY std::string guo_fingerprint(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  return detail::hexadecimal(detail::content_hash(std::as_bytes(std::span(bytes))));
}

MOTIONLANG_NAMESPACE_END
