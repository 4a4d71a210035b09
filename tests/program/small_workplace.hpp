// SPDX-License-Identifier: MIT
/// A folder with a small model and a timeline, in which the program is run.
#pragma once

#include <map>

#include <motionlang/backend/eigen.hpp>

#include "../support/small_model.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

inline constexpr const char* timeline_text =
    "walk forward # 0 # 1 # legs\n"
    "raise both arms # 0.2 # 0.8 # left arm # right arm\n";

/// A folder with a small model and a timeline of 20 frames.
struct Workplace : TemporaryFolder {
  explicit Workplace(ml::Index diffusion_steps = 5) {
    const auto config = small::config(diffusion_steps);
    ml::save_stmc(*this / "model.safetensors", small::model<B>(config), config, {{"license", "MIT"}});
    ml::write_file(*this / "two.txt", timeline_text);
  }
  Outcome run(const std::vector<std::string>& arguments, const std::string& interrupt_at = "",
              const std::string& input = "/dev/null") const {
    return ::run(arguments, path, interrupt_at, input);
  }
  Outcome generate(const std::string& out, std::vector<std::string> more = {}, const std::string& timeline = "two.txt",
                   const std::string& interrupt_at = "") const {
    more.insert(more.begin(), {"generate", "--timeline", timeline, "--model", "model.safetensors", "--out", out});
    return run(more, interrupt_at);
  }
  /// Names of the files in a folder, and their contents.
  std::map<std::string, std::string> files(const std::string& folder) const {
    std::map<std::string, std::string> out;
    if (!std::filesystem::exists(*this / folder)) return out;
    for (const auto& f : std::filesystem::directory_iterator(*this / folder))
      out[f.path().filename().string()] = ml::read_file(f.path());
    return out;
  }
};
