// SPDX-License-Identifier: MIT
// Bodies of description_evaluation.hpp.
#pragma once

#include <algorithm>  // replace
#include <array>      // extensions
#include <sstream>    // words, lines

#include <motionlang/core/formatted.hpp>
#include <motionlang/datasets/described_words.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/train/description_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY CommonTags::CommonTags(const std::vector<DescribedMotion>& motions) {
  std::map<std::string, std::map<std::string, Index>> counts;
  for (const DescribedMotion& m : motions) {
    for (const DescribedText& t : m.texts) {
      for (const TaggedWord& w : t.words) ++counts[w.word][w.tag];
    }
  }
  for (const auto& [word, of_tag] : counts) {
    Index most = 0;
    for (const auto& [tag, count] : of_tag) {
      if (count > most) most = count, tags_[word] = tag;
    }
  }
}

MOTIONLANG_BODY std::string CommonTags::tagged(const std::string& sentence) const {
  if (empty()) return sentence;
  std::istringstream words(sentence);
  std::string out;
  for (std::string word; words >> word;) {
    const auto found = tags_.find(word);
    out += (out.empty() ? "" : " ") + word + "/" + (found == tags_.end() ? "OTHER" : found->second);
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> CommonTags::tagged(std::span<const std::string> sentences) const {
  std::vector<std::string> out;
  for (const std::string& s : sentences) out.push_back(tagged(s));
  return out;
}

MOTIONLANG_BODY BertBaseline parse_bert_baseline(std::string_view name) {
  if (name == "none") return BertBaseline::none;
  if (name == "random") return BertBaseline::random;
  if (name == "tm2t") return BertBaseline::tm2t;
  raise<config_error>(103, "baseline of BERTScore '", name, "' is not one of none, random, tm2t");
}

MOTIONLANG_BODY std::string description_table(std::span<const DescriptionScores> rows) {
  const bool match = !rows.empty() && rows.front().r_precision, bert = !rows.empty() && rows.front().bert;
  std::string out = formatted("  %-34s%s%8s%8s%8s%8s%9s%9s%s\n", "", match ? "     R@1     R@2     R@3  MM-Dist" : "",
                              "BLEU-1", "BLEU-2", "BLEU-3", "BLEU-4", "ROUGE-L", "CIDEr", bert ? "  BERTScore" : "");
  for (const DescriptionScores& row : rows) {
    out += formatted("  %-34s", row.by.c_str());
    if (match) {
      for (const double p : row.r_precision.value()) out += formatted("%8.3f", p);
      out += formatted("%9.3f", row.distance);
    }
    for (const double b : row.bleu) out += formatted("%8.2f", 100 * b);
    out += formatted("%9.2f%9.2f", 100 * row.rouge_l, 100 * row.cider);
    if (bert) out += formatted("%11.2f", 100 * row.bert.value());
    out += "\n";
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> made_descriptions(const std::filesystem::path& folder,
                                                           std::span<const TextEntry> entries) {
  constexpr std::array kinds{".txt"};
  std::vector<std::filesystem::path> files;
  LeftOut missing;
  for (const TextEntry& e : entries) {
    const auto found = detail::made_files(folder, *e.motion, kinds);
    if (found.empty())
      missing.add("without a file", e.motion->id);
    else
      files.push_back(found.front());
  }
  if (files.size() != entries.size()) detail::raise_not_made(folder, entries.size(), missing);
  std::vector<std::string> out;
  for (const auto& file : files) {
    std::istringstream lines(read_file(FilePath(file)));
    std::string line;
    if (!std::getline(lines, line) || line.find_first_not_of(" \t\r") == line.npos)
      raise<io_error>(402, file.string(), ": the first line is '", line, "', expected a description");
    if (line.ends_with('\r')) line.pop_back();
    std::replace(line.begin(), line.end(), '/', ' ');  // which marks parts of speech
    out.push_back(std::move(line));
  }
  return out;
}

namespace detail {

MOTIONLANG_BODY void Descriptions::add(const CaptionPair& references, const DescribedText& text, const GloVe& words) {
  pairs.push_back(references);
  pairs.back().candidate = lemmas(words_of(text, words));
  tagged.push_back(tagged_text(text));
}

MOTIONLANG_BODY Descriptions random_descriptions(std::span<const CaptionPair> references,
                                                 const std::vector<DescribedMotion>& training, const GloVe& words,
                                                 Philox rng) {
  Descriptions out;
  for (const CaptionPair& pair : references) {
    const auto& texts = training[rng.below(static_cast<std::uint32_t>(training.size()))].texts;
    out.add(pair, texts[rng.below(static_cast<std::uint32_t>(texts.size()))], words);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
