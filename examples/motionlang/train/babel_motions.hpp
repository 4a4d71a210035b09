// Motions of AMASS with the labels of BABEL, as SINC and TEACH learn from them. Every item is one DescribedMotion: its
// id is the published key, "seg-4242-0"; its rows are turned ahead as one motion; its texts are labels. Of SINC they
// are about all of it; of TEACH there are two, one behind the other, and what is between them is the transition.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/babel.hpp>

#include "../usage_error.hpp"
#include "babel_config.hpp"
#include "described_motions.hpp"

namespace program {

struct BabelSources {
  std::filesystem::path data;        // folder of the motions
  std::filesystem::path babel;       // BABEL's own JSON
  std::filesystem::path validation;  // another, to validate with; then all of `babel` is for training
  std::filesystem::path splits;      // folder with lists of ids; "": at random
  std::filesystem::path spelling;    // JSON of what words of labels are replaced by; "": by themselves

  /// Throws usage_error 102 without `babel`, and for `validation` beside `splits`.
  void require_sound() const {
    if (babel.empty()) ml::raise<usage_error>(102, "--babel is required");
    if (!validation.empty() && !splits.empty()) ml::raise<usage_error>(102, "--babel-validation or --splits, not both");
  }
};

/// Frames of a sequence, and labels in them.
struct BabelItem {
  std::string key;
  ml::FrameSlice frames;
  std::vector<DescribedText> texts;  // their frames count from the first one of the item
};
struct BabelItems {
  std::vector<BabelItem> items;
  LeftOut left_out{};
};
/// The items of a sequence of so many frames.
using BabelReader = std::function<BabelItems(const ml::BabelSequence& sequence, ml::Index frames,
                                             const ml::SpellingTable& spelling, bool training)>;

/// What a motion's texts say.
inline std::vector<std::string> labels_of(const DescribedMotion& m) {
  std::vector<std::string> labels;
  for (const DescribedText& t : m.texts) labels.push_back(t.text);
  return labels;
}

/// Throws config_error 103 for an unknown type of data.
BabelReader sinc_reader(const SincDataConfig& config);
BabelReader teach_reader(const TeachDataConfig& config);

/// features: smplvelp or smplvelp-published, at 30 frames per second.
/// Throws io_error 401, 403, ... of files, with the place; io_error 403 if there is nothing to train on
DescribedMotions read_babel_motions(const BabelSources& sources, const std::string& features, const DataConfig& lots,
                                    const BabelReader& reader, ml::Progress progress);

}  // namespace program
