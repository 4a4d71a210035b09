// SPDX-License-Identifier: MIT
/// Evaluates descriptions of motions: TM2T's table 1. They are compared with people's descriptions, and the networks of
/// Guo et al. say how well they fit their motions (R-precision and distance).
///
///     const auto entries = text_entries(data.test, "test");
///     const auto figures = description_figures(run, data, entries, {.guo = &judge}, {.seed = 0});
///     const std::string table = description_table(figures.rows);
///
/// Source   TM2T (Guo et al., ECCV 2022), table 1; final_evaluations_m2t.py: for each motion, the descriptions of its
///          batch are ranked
/// Differs  spaCy tags the words of a description there. Here each gets the tag that it has most often in the training
///          texts, and "OTHER" if it occurs in none
#pragma once

#include <algorithm>    // min
#include <array>        // BLEU
#include <filesystem>   // descriptions of other programs
#include <map>          // tags
#include <optional>     // judges
#include <span>         // texts
#include <string>       // texts
#include <string_view>  // names
#include <utility>      // move
#include <vector>       // motions

#include <motionlang/core/progress.hpp>
#include <motionlang/train/bert_judge.hpp>
#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/made_motions.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/train/text_entries.hpp>
#include <motionlang/weights/tm2t_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The most frequent part of speech of every word.
class CommonTags {
 public:
  explicit CommonTags(const std::vector<DescribedMotion>& motions);

  /// True if the texts have no parts of speech. Sentences then stay as they are.
  bool empty() const { return tags_.empty(); }
  /// "word/TAG word/TAG". Among equally frequent tags the first in the alphabet is taken.
  std::string tagged(const std::string& sentence) const;
  std::vector<std::string> tagged(std::span<const std::string> sentences) const;

 private:
  std::map<std::string, std::string> tags_;
};

/// The entries in random batches of 32; an incomplete last one is left out, unless it is the only one.
/// texts   one for each entry, as GloVe::encode reads them
/// all     processes that share the batches; all get the match of all
/// Throws  shape_error 204 for another number of texts
template <Backend B>
MatchingMetric description_match(const GuoJudge<B>& judge, std::span<const TextEntry> entries,
                                 std::span<const std::string> texts, Index width, Philox rng,
                                 const AnyCommunicator& all = {}) {
  detail::require_same_count("description_match: texts against motions", std::ssize(texts), std::ssize(entries));
  std::vector<Index> order(entries.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[rng.below(static_cast<std::uint32_t>(i))]);
  const Index batch = std::min<Index>(32, std::ssize(entries));
  using S = typename B::scalar;
  const auto latents = [&](Index b, const Progress&) {
    std::vector<S> values;
    std::vector<Index> frames;
    std::vector<std::string> said;
    for (Index i = b * batch; i < (b + 1) * batch; ++i) {
      const auto which = static_cast<std::size_t>(order[static_cast<std::size_t>(i)]);
      const TextEntry& e = entries[which];
      const auto rows = entry_rows(e, 0, e.frames.length, width);
      values.insert(values.end(), rows.begin(), rows.end());
      frames.push_back(e.frames.length);
      said.push_back(texts[which]);
    }
    const Offsets offsets(frames);
    const auto motions = judge.motions({Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets});
    MessageWriter message;
    for (const Tensor<B, 2>& rows : {motions, judge.texts(said)})
      message.value(rows.size(1)), message.list(std::span<const S>(rows.span()));
    return message.bytes();
  };
  MatchingMetric out;
  for (const std::string& message : shared_items(all, batch > 0 ? std::ssize(entries) / batch : 0, latents)) {
    MessageReader in(message);
    const auto motion_width = in.value<Index>();
    const auto motions = in.list<S>();
    const auto text_width = in.value<Index>();
    const auto words = in.list<S>();
    out.add(Rows(std::span<const S>(motions), motion_width), Rows(std::span<const S>(words), text_width));
  }
  return out;
}

/// Who judges besides the words themselves; null: nobody.
template <Backend B>
struct DescriptionJudges {
  BertJudge<B>* bert = nullptr;
  const GuoJudge<B>* guo = nullptr;
};

/// The value of BERTScore that counts as 0: none; that of random texts of the training part; or TM2T's own, which
/// fits layer 17 of roberta-large alone.
enum class BertBaseline { none, random, tm2t };
/// Throws config_error 103 for another name.
BertBaseline parse_bert_baseline(std::string_view name);

/// The descriptions that another program wrote: for each entry the first line of ID.txt, where ID is the id of its
/// motion or of its clip. A slash becomes a blank.
/// Throws io_error 401 with the first motions that have none, 402 for an empty one.
std::vector<std::string> made_descriptions(const std::filesystem::path& folder, std::span<const TextEntry> entries);

struct DescriptionOptions {
  BertBaseline baseline = BertBaseline::none;
  std::filesystem::path made{};  // folder of made_descriptions, which get a row with its name; "": none
  std::uint64_t seed = 0;
  Progress progress{};             // of the descriptions
  AnyCommunicator communicator{};  // processes that share descriptions and judgements; all get the figures of all
};

/// A row of the table. Scores are from 0 to 1.
struct DescriptionScores {
  std::string by;  // who describes
  std::array<double, 4> bleu{};
  double rouge_l = 0, cider = 0;
  std::optional<double> bert{};
  std::optional<std::array<double, 3>> r_precision{};
  double distance = 0;  // with r_precision
};
struct DescriptionFigures {
  /// The model, another program, random texts and, for the networks of Guo et al., the first text.
  std::vector<DescriptionScores> rows{};
  BertScore baseline{};
};

/// The table as text, in per cent. Columns of judges are left out if the first row lacks them.
std::string description_table(std::span<const DescriptionScores> rows);

namespace detail {

/// Descriptions of all entries: beside references, and with tags as the networks of Guo et al. read them.
struct Descriptions {
  std::vector<CaptionPair> pairs{};
  std::vector<std::string> tagged{};

  void add(const CaptionPair& references, const DescribedText& text, const GloVe& words);
};
/// For each entry a random text of the training part.
Descriptions random_descriptions(std::span<const CaptionPair> references, const std::vector<DescribedMotion>& training,
                                 const GloVe& words, Philox rng);

template <Backend B>
DescriptionScores description_scores(const std::string& by, const Descriptions& given,
                                     std::span<const TextEntry> entries, Index width,
                                     const DescriptionJudges<B>& judges, const BertScore& baseline, const Philox& rng,
                                     const AnyCommunicator& all) {
  DescriptionScores out{by, motionlang::bleu(corpus_counts(given.pairs)), motionlang::rouge_l(given.pairs),
                        motionlang::cider(given.pairs)};
  if (judges.bert != nullptr) out.bert = (*judges.bert)(given.pairs, baseline, all);
  if (judges.guo != nullptr) {
    const MatchingMetric m = description_match(*judges.guo, entries, given.tagged, width, rng.split("batches"), all);
    out.r_precision = {m.r_precision(1), m.r_precision(2), m.r_precision(3)};
    out.distance = m.matching_score();
  }
  return out;
}

}  // namespace detail

/// run      a TM2T from motions to texts
/// entries  of a part of the data
/// Throws   numeric_error 302 without references, and what the judges throw
template <Backend B>
DescriptionFigures description_figures(const Tm2tRun<B>& run, const DescribedMotions& data,
                                       std::span<const TextEntry> entries, const DescriptionJudges<B>& judges,
                                       const DescriptionOptions& options = {}) {
  detail::Descriptions said, elsewhere, by_people;
  const AnyCommunicator& all = options.communicator;
  const auto made = options.made.empty() ? std::vector<std::string>() : made_descriptions(options.made, entries);
  const auto describe = [&](Index i, const Progress&) {
    const TextEntry& e = entries[static_cast<std::size_t>(i)];
    const Index length = std::min(e.frames.length / 4 * 4, tm2t_longest);
    const auto rows = entry_rows(e, 0, length, data.width);
    return run.model.describe({Tensor<B, 2>::from(rows, {length, data.width}), Offsets{length}}, run.words).front();
  };
  const auto texts = shared_items(all, std::ssize(entries), describe, options.progress);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const CaptionPair references = entry_references(entries[i], run.words);
    said.pairs.push_back(references);
    said.pairs.back().candidate = texts[i];
    by_people.add(references, *entries[i].texts.front(), run.words);
  }
  const CommonTags tags(data.training);
  said.tagged = tags.tagged(texts);
  for (std::size_t i = 0; i < made.size(); ++i) {
    elsewhere.add(said.pairs[i], {made[i], {}}, run.words);
    elsewhere.tagged.back() = tags.tagged(elsewhere.pairs.back().candidate);
  }
  const Philox rng{.seed = options.seed};
  const auto by_chance = detail::random_descriptions(said.pairs, data.training, run.words, rng.split("chance"));
  DescriptionFigures out;
  if (judges.bert != nullptr && options.baseline == BertBaseline::random)
    out.baseline = judges.bert->mean(by_chance.pairs, {}, all);
  if (options.baseline == BertBaseline::tm2t) out.baseline = tm2t_bert_baseline;
  const auto add = [&](const std::string& by, const detail::Descriptions& given) {
    out.rows.push_back(detail::description_scores(by, given, entries, data.width, judges, out.baseline, rng, all));
  };
  add("described", said);
  if (!options.made.empty()) add(detail::made_name(options.made), elsewhere);
  add("a random text of the training part", by_chance);
  if (judges.guo != nullptr) add("the first text of people", by_people);
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/description_evaluation.ipp>
#endif
