// SPDX-License-Identifier: MIT
/// Splits clips into training, validation and test.
#pragma once

#include <algorithm>   // sort, unique
#include <array>       // lists
#include <cmath>       // lround
#include <filesystem>  // lists
#include <map>         // parts
#include <string>      // ids
#include <vector>      // ids

#include <motionlang/core/rng.hpp>
#include <motionlang/datasets/data_config.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/formats/motion_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Training (0), validation (1) or test (2) of every clip: by lists of ids, else at random.
class ClipSplit {
 public:
  /// lists: folder of train.txt, val.txt, test.txt, or, as in TEMOS, train, val, test. "": at random, by the shares
  ClipSplit(const std::filesystem::path& lists, const DataConfig& config, std::vector<std::string> clips) {
    if (!lists.empty()) {
      for (const int part : {0, 1, 2}) {
        const auto plain = lists / std::array{"train", "val", "test"}[static_cast<std::size_t>(part)];
        const auto with_ending = std::filesystem::path(plain.string() + ".txt");
        const auto& list = std::filesystem::is_regular_file(plain) ? plain : with_ending;
        if (part != 0 && !std::filesystem::exists(list)) continue;
        for (const std::string& id : read_ids(list)) part_.emplace(id, part);
      }
      return;
    }
    std::sort(clips.begin(), clips.end());
    clips.erase(std::unique(clips.begin(), clips.end()), clips.end());
    auto rng = Philox{.seed = config.split_seed}.split("split");
    for (std::size_t i = clips.size(); i > 1; --i)
      std::swap(clips[i - 1], clips[rng.below(static_cast<std::uint32_t>(i))]);
    const auto count = static_cast<double>(clips.size());
    const auto test = static_cast<std::size_t>(std::lround(config.test_share * count)),
               validation = static_cast<std::size_t>(std::lround(config.validation_share * count));
    for (std::size_t i = 0; i < clips.size(); ++i) part_[clips[i]] = i < test ? 2 : i < test + validation ? 1 : 0;
  }
  /// -1 for a clip that is on no list, with or without an extension.
  int of(const std::string& clip) const {
    auto found = part_.find(clip);
    if (found == part_.end() && is_motion_file(clip))
      found = part_.find(std::filesystem::path(clip).replace_extension().generic_string());
    return found == part_.end() ? -1 : found->second;
  }

 private:
  std::map<std::string, int> part_;
};

MOTIONLANG_NAMESPACE_END
