// SPDX-License-Identifier: MIT
/// The captions that a motion model learned from, with the times that their actions take. They tell if a model can know
/// what a text means, which texts it knows instead, and how long the text should last.
///
///     const auto captions = load_known_captions(path, stmc.text_encoder);     // weights/known_caption_file.hpp
///     if (!captions.knows("do a moonwalk")) show(captions.nearest("do a moonwalk", 3));
///     const auto action = captions.action("have a seat");                     // 2.4 s, then "sit quietly"
///
/// The captions of mirrored motions are known as well, but not stored: a text and its mirror image are looked up.
/// Misspelled words are mended first.
/// Texts that were tried with the model can be added, so that it also tells at what it often fails.
#pragma once

#include <optional>     // texts that are far from all captions
#include <string>       // texts
#include <string_view>  // messages
#include <vector>       // tables

#include <motionlang/text/text_table.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The action of a text: how long it takes, and whether it goes on for any time. If it ends, `then` is a text for what
/// follows.
struct KnownAction {
  double seconds = 0;
  bool repeats = true;
  std::string then{};
};

/// A caption, by its row of the table, and how alike it or its mirror image is to a text.
struct NearCaption {
  Index row = 0;
  bool mirrored = false;
  double likeness = 0;
};

/// A misspelled word, and the word that is read instead.
struct MisspelledWord {
  std::string word{}, read{};
};

class KnownCaptions {
 public:
  /// No captions.
  KnownCaptions() = default;
  /// table     captions, and behind them texts that were tried
  /// actions   of the captions
  /// nearness  the least likeness of a text that is known (dividing_likeness)
  /// done      the shares of the motions that did what the tried texts say
  /// Throws    shape_error 205 for other numbers of actions and shares; messages name `source`
  KnownCaptions(TextTable table, std::vector<KnownAction> actions, double nearness, std::vector<double> done = {},
                std::string_view source = "KnownCaptions");

  /// The same with other texts that were tried, and the shares of the motions that did what they say. No captions stay
  /// none.
  KnownCaptions with_tried(const std::vector<std::string>& texts, std::vector<double> done) const;

  /// The same with more captions and their actions, and with other actions for captions that it has. All texts are
  /// encoded anew. No captions stay none. Throws shape_error 205 for other numbers of texts and actions.
  KnownCaptions with_captions(const std::vector<std::string>& texts, const std::vector<KnownAction>& actions) const;

  bool empty() const { return actions_.empty(); }
  const TextTable& table() const { return table_; }
  const std::vector<KnownAction>& actions() const { return actions_; }
  double nearness() const { return nearness_; }
  /// The shares of the texts that were tried, which follow the captions in the table.
  const std::vector<double>& done() const { return done_; }

  /// The misspelled words of a text (TextTable::mended).
  std::vector<MisspelledWord> misspelled(const std::string& text) const;
  /// At most `count` captions or mirror images of captions, the nearest first, each once.
  std::vector<NearText> nearest(const std::string& text, Index count) const;
  /// The captions of a text that is known which are nearly as alike to it as the nearest one, at most `count`. Captions
  /// that say more than the text are less alike. If all are far (likeness below 0.7), those of its longest beginning
  /// that is nearly a caption: "kick" for "he kicks the xylophone". Half of the text has to say it, unless the captions
  /// are very far (0.5).
  std::vector<NearCaption> meant(const std::string& text, Index count) const;
  /// The same as texts. Throws what the encoder of the table throws.
  std::vector<std::string> meant_texts(const std::string& text, Index count) const;
  /// True if the nearest caption is near.
  bool knows(const std::string& text) const;
  /// The action of a text, or of its beginning (as in `meant`), by the captions near it. Their majority decides if it
  /// repeats. It takes as long as three quarters of these do at most. What follows is that of the nearest.
  std::optional<KnownAction> action(const std::string& text) const;
  /// The share of motions that do what the text says, by the texts nearly like it that were tried. Nothing if there are
  /// none.
  std::optional<double> success(const std::string& text) const;

 private:
  struct Found {
    NearText near{};
    bool mirrored = false;
  };
  /// In the rows from `first` to before `last`. A caption that is the mirror image of another is found twice.
  std::vector<Found> found(const std::string& text, Index count, Index first, Index last) const;
  /// "do not" for "don't", and words for misspelled ones.
  std::string plain(const std::string& text) const;
  /// `nearest` for a plain text.
  std::vector<NearText> nearest_of_plain(const std::string& plain, Index count) const;
  /// The text, or the caption of its beginning if the text is far from all of them.
  std::string known_beginning(const std::string& text) const;
  /// Each text once.
  static std::vector<Found> different(std::vector<Found> all, Index count);

  TextTable table_{};
  std::vector<KnownAction> actions_{};
  double nearness_ = 0;
  std::vector<double> done_{};
};

/// The likeness that divides best what is related from what is not: the largest sum of the shares that are on the right
/// side. Half way between the two values that it divides. 0 if one of both has no values.
double dividing_likeness(std::vector<double> related, std::vector<double> unrelated);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/known_captions.ipp>
#endif
