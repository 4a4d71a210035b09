// The option --dataset: HumanAct12, UESTC and NTU-13 in files of their own.
#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include <motionlang/datasets/action_recordings.hpp>

#include "../usage_error.hpp"

namespace program {

inline void add_dataset_option(CLI::App& command, std::string& dataset) {
  command
      .add_option("--dataset", dataset,
                  "Actions in the files of their data set in --data, instead of a table: humanact12 "
                  "(humanact12poses.pkl), uestc (vibe_cache_refined.pkl, info/) or ntu13 (ntu_vibe_list.txt)")
      ->check(CLI::IsMember({"humanact12", "uestc", "ntu13"}));
}

/// Throws usage_error 102 if --data is not the data set that --dataset names.
inline void require_dataset(const std::string& dataset, const std::filesystem::path& data) {
  if (!dataset.empty() && motionlang::action_data_set(data) != dataset)
    motionlang::raise<usage_error>(102, "--dataset ", dataset, ": ", data.string(), " has other files");
}

/// Clips of such files are in the world of their camera, as published, unless --set says otherwise.
template <class Clips>
void choose_clips(Clips& clips, const std::string& dataset, const std::filesystem::path& data) {
  require_dataset(dataset, data);
  if (!dataset.empty()) clips.turned_ahead = false, clips.camera = true;
}

}  // namespace program
