// SPDX-License-Identifier: MIT
/// Made-up recordings as raw KIT Motion-Language has them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <motionlang/file/file.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "synthetic_motion.hpp"

namespace raw_kit {

/// The positions of MMM's joints at 100 frames per second, reflected, 640 units per metre.
inline std::vector<motionlang::Vec3<double>> joints_of(const motionlang::Motion& motion) {
  auto joints = motionlang::retarget(motion, motionlang::kit21_skeleton()).positions();
  for (auto& p : joints) p = {-640 * p.x, 640 * p.y, 640 * p.z};
  return joints;
}

inline void write_texts(const std::filesystem::path& folder, const std::string& id,
                        const std::vector<std::string>& texts) {
  std::string list;
  for (const auto& t : texts) list += (list.empty() ? "[\"" : ", \"") + t + "\"";
  motionlang::write_file(folder / (id + "_meta.json"),
                         motionlang::concat_text("{\"nb_annotations\": ", texts.size(), "}"));
  motionlang::write_file(folder / (id + "_annotations.json"), texts.empty() ? "[]" : list + "]");
}

/// A recording with its texts.
inline void write(const std::filesystem::path& folder, const std::string& id,
                  const std::vector<motionlang::Vec3<double>>& joints, const std::vector<std::string>& texts) {
  std::filesystem::create_directories(folder);
  write_texts(folder, id, texts);
  std::string csv;
  for (int j = 0; j < 21; ++j) csv += motionlang::concat_text(",j", j, "_tx,j", j, "_ty,j", j, "_tz");
  csv += "\n";
  for (std::size_t f = 0; f < joints.size() / 21; ++f) {
    csv += std::to_string(f);
    for (std::size_t j = 0; j < 21; ++j) {
      const auto& p = joints[21 * f + j];
      char numbers[100];
      std::snprintf(numbers, sizeof numbers, ",%.10f,%.10f,%.10f", p.x, p.y, p.z);
      csv += numbers;
    }
    csv += "\n";
  }
  motionlang::write_file(folder / (id + "_fke.csv"), csv);
}

}  // namespace raw_kit
