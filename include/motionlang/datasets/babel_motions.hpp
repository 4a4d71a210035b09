// SPDX-License-Identifier: MIT
/// Motions of AMASS with the labels of BABEL, from which SINC and TEACH learn. Every item is one DescribedMotion. Its
/// id is the published key, "seg-4242-0", its rows are turned to face ahead as one motion, and its texts are labels.
/// The labels of SINC describe the whole item. TEACH has two labels in sequence, with the transition between them.
#pragma once

#include <filesystem>  // where motions are
#include <functional>  // readers of items
#include <string>      // labels
#include <vector>      // items

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/babel.hpp>

#include <motionlang/datasets/described_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames per second of SINC and TEACH.
inline constexpr double babel_fps = 30;

/// The shares by which clips are split at random.
template <class Data>
DataConfig split_config(const Data& c) {
  return {.test_share = c.test_share, .validation_share = c.validation_share, .split_seed = c.split_seed};
}

struct SincDataConfig {
  std::string types = "seg+seq+spatial_pairs";  // what the model learns, in any order; separate_pairs may be added
  Index shortest = 15, window = 300;            // frames; a longer item gives `window` from a random place
  Index longest = 800;                          // for validation
  Index simultaneous_max = 4;                   // labels at the same time
  double proportion = 0.5;                      // share of single actions that get a partner with other parts
  bool random = false;                          // combine any actions, with random parts
  bool shuffle = false;  // several labels in random order, as in the paper; the released program keeps them
  double test_share = 0.2, validation_share = 0.05;  // as in DataConfig
  std::uint64_t split_seed = 1;

  void require_sound() const {
    split_config(*this).require_sound();
    require_value("shortest", shortest, shortest >= 1, "1 or more");
    require_value("window", window, window >= shortest, "shortest or more");
    require_value("longest", longest, longest >= shortest, "shortest or more");
    require_value("simultaneous_max", simultaneous_max, simultaneous_max >= 2, "2 or more");
    require_value("proportion", proportion, proportion >= 0 && proportion <= 1, "0 to 1");
  }
  static constexpr auto fields() {
    using C = SincDataConfig;
    return motionlang::fields("types", &C::types, "shortest", &C::shortest, "window", &C::window, "longest",
                              &C::longest, "simultaneous_max", &C::simultaneous_max, "proportion", &C::proportion,
                              "random", &C::random, "shuffle", &C::shuffle, "test_share", &C::test_share,
                              "validation_share", &C::validation_share, "split_seed", &C::split_seed);
  }
};

struct TeachDataConfig {
  Index shortest = 15, longest = 750;                // frames of either action; the second includes its transition
  double test_share = 0.2, validation_share = 0.05;  // as in DataConfig
  std::uint64_t split_seed = 1;

  void require_sound() const {
    split_config(*this).require_sound();
    require_value("shortest", shortest, shortest >= 1, "1 or more");
    require_value("longest", longest, longest >= shortest, "shortest or more");
  }
  static constexpr auto fields() {
    using C = TeachDataConfig;
    return motionlang::fields("shortest", &C::shortest, "longest", &C::longest, "test_share", &C::test_share,
                              "validation_share", &C::validation_share, "split_seed", &C::split_seed);
  }
};

struct BabelSources {
  std::filesystem::path data{};        // folder of the motions
  std::filesystem::path babel{};       // BABEL's own JSON
  std::filesystem::path validation{};  // another file for validation; then all of `babel` is for training
  std::filesystem::path splits{};      // folder with lists of ids; "": at random
  std::filesystem::path spelling{};    // JSON of replacements for words of labels; "": none

  /// Throws config_error 102 without `babel`, and if `validation` and `splits` are both set.
  void require_sound() const;
};

/// Frames of a sequence, and labels in them.
struct BabelItem {
  std::string key;
  FrameSlice frames;
  std::vector<DescribedText> texts;  // their frames count from the first frame of the item
};
struct BabelItems {
  std::vector<BabelItem> items;
  LeftOut left_out{};
};
namespace detail {

/// JSON of words and their replacements; empty for "". Throws io_error 401, 403, config_error 107.
SpellingTable read_spelling(const std::filesystem::path& path);

}  // namespace detail

/// Makes the items of a sequence of this many frames.
using BabelReader = std::function<BabelItems(const BabelSequence& sequence, Index frames, const SpellingTable& spelling,
                                             bool training)>;

/// The texts of a motion.
inline std::vector<std::string> labels_of(const DescribedMotion& m) {
  std::vector<std::string> labels;
  for (const DescribedText& t : m.texts) labels.push_back(t.text);
  return labels;
}

/// Throws config_error 103 for an unknown type of data.
BabelReader sinc_reader(const SincDataConfig& config);
BabelReader teach_reader(const TeachDataConfig& config);

/// features: smplvelp or smplvelp-published, at 30 frames per second.
/// Throws io_error 401, 403, ... for files, with the place; io_error 403 if there is nothing to train on
DescribedMotions read_babel_motions(const BabelSources& sources, const std::string& features, const DataConfig& shares,
                                    const BabelReader& reader, Progress progress);

/// Whole sequences with the texts of their segments, for the search of moments. Sequences without segments are left
/// out, and segments of T-poses and transitions.
/// maker   of the rows, at its own rate
/// part    0: training, 1: validation, 2: test, as the sources split them; -1: all
/// Throws  as read_babel_motions; io_error 403 if no sequence is left
std::vector<DescribedMotion> read_babel_sequences(const BabelSources& sources, const RowMaker& maker,
                                                  const DataConfig& shares, int part, Progress progress);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/babel_motions.ipp>
#endif
