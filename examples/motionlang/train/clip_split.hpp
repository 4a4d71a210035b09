// Which clips are for training, validation and test.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <motionlang/core/rng.hpp>
#include <motionlang/file/id_list.hpp>

#include "../files/motion_files.hpp"
#include "described_motions.hpp"

namespace program {

/// Training (0), validation (1) or test (2) of every clip: by lists of ids, else at random.
class Split {
 public:
  /// lists: folder of train.txt, val.txt and test.txt; "": at random, by the shares of `config`
  Split(const std::filesystem::path& lists, const DataConfig& config, std::vector<std::string> clips) {
    if (!lists.empty()) {
      for (const int part : {0, 1, 2}) {
        const auto list =
            lists / (std::array{"train", "val", "test"}[static_cast<std::size_t>(part)] + std::string(".txt"));
        if (part != 0 && !std::filesystem::exists(list)) continue;
        for (const std::string& id : ml::read_ids(list)) part_.emplace(id, part);
      }
      return;
    }
    std::sort(clips.begin(), clips.end());
    clips.erase(std::unique(clips.begin(), clips.end()), clips.end());
    auto rng = ml::Philox{.seed = config.split_seed}.split("split");
    for (std::size_t i = clips.size(); i > 1; --i)
      std::swap(clips[i - 1], clips[rng.below(static_cast<std::uint32_t>(i))]);
    const auto count = static_cast<double>(clips.size());
    const auto test = static_cast<std::size_t>(config.test_share * count + 0.5),
               validation = static_cast<std::size_t>(config.validation_share * count + 0.5);
    for (std::size_t i = 0; i < clips.size(); ++i) part_[clips[i]] = i < test ? 2 : i < test + validation ? 1 : 0;
  }
  /// -1 for a clip that is on no list, neither with an extension nor without.
  int of(const std::string& clip) const {
    auto found = part_.find(clip);
    if (found == part_.end() && is_motion_file(clip))
      found = part_.find(std::filesystem::path(clip).replace_extension().generic_string());
    return found == part_.end() ? -1 : found->second;
  }

 private:
  std::map<std::string, int> part_;
};

inline std::vector<DescribedMotion>& part_of(DescribedMotions& all, int part) {
  return part == 0 ? all.training : part == 1 ? all.validation : all.test;
}

}  // namespace program
