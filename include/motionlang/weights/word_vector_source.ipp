// SPDX-License-Identifier: MIT
// Bodies of word_vector_source.hpp.
#pragma once

#include <cmath>  // isfinite
#include <set>    // words

#include <motionlang/core/text_lines.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/json_members.hpp>
#include <motionlang/text/word_piece.hpp>
#include <motionlang/weights/word_vector_source.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Takes the wanted words of a source, in its order.
class VectorSelector {
 public:
  VectorSelector(const WordSelection& selection, std::string source)
      : left_(selection.commonest), source_(std::move(source)) {
    for (const std::string& text : selection.also) {
      for (std::string& word : WordPiece::words(text)) also_.insert(std::move(word));
    }
  }
  /// True if the vector of the next word is wanted. Each word is taken once.
  bool takes(const std::string& word) {
    const auto readable = WordPiece::words(word);
    if (readable.size() != 1 || readable.front() != word) return false;
    const bool common = left_ > 0;
    if (common) --left_;
    return (common || also_.contains(word)) && taken_.insert(word).second;
  }
  void add(std::string word, std::span<const float> vector, const std::string& place) {
    if (vector.empty() || (!words_.empty() && vector.size() * words_.size() != vectors_.size()))
      raise<io_error>(403, place, ": ", counted(vector.size(), "number"), " for '", word, "', others have ",
                      words_.empty() ? 0 : vectors_.size() / words_.size());
    for (const float x : vector) {
      if (!std::isfinite(x)) raise<io_error>(403, place, ": a number of '", word, "' is ", x);
    }
    words_.push_back(std::move(word));
    vectors_.insert(vectors_.end(), vector.begin(), vector.end());
  }
  WordVectors finish() {
    if (words_.empty()) raise<io_error>(403, source_, ": no vectors of words that are wanted");
    const std::size_t width = vectors_.size() / words_.size();
    std::vector<double> mean(width);
    for (std::size_t i = 0; i < vectors_.size(); ++i) mean[i % width] += vectors_[i];
    for (std::size_t i = 0; i < vectors_.size(); ++i)
      vectors_[i] -= static_cast<float>(mean[i % width] / static_cast<double>(words_.size()));
    return WordVectors::rounded(words_, vectors_);
  }

 private:
  Index left_;
  std::string source_;
  std::set<std::string> also_, taken_;
  std::vector<std::string> words_;
  std::vector<float> vectors_;
};

inline void select_from_json(const JsonMembers& file, VectorSelector& selector) {
  const auto words = file.load("words");
  const JsonMembers vectors = file.members("vectors");
  const auto dimensions = file.load("dimensions");
  const auto width = JsonView(dimensions, file.place("dimensions")).as<Index>();
  const JsonView list(words, file.place("words"));
  for (Index i = 0; i < list.size(); ++i) {
    const auto word = list[i].as<std::string>();
    if (!selector.takes(word)) continue;
    const auto numbers = vectors.load(word);
    auto vector = JsonView(numbers, vectors.place(word)).as<std::vector<float>>();
    vector.resize(std::min(vector.size(), static_cast<std::size_t>(width)));  // its length and number stand behind it
    selector.add(word, vector, vectors.place(word));
  }
}

inline void select_from_lines(std::string_view text, const std::string& name, VectorSelector& selector) {
  std::vector<float> vector;
  for_each_line(text, [&](std::string_view line, Index number) {
    const std::size_t blank = std::min(line.find(' '), line.size());
    std::string word(line.substr(0, blank));
    if (!selector.takes(word)) return;
    const std::string place = concat_text(name, ": line ", number);
    vector.clear();
    for (std::size_t at = blank; (at = line.find_first_not_of(' ', at)) != line.npos;) {
      const std::size_t end = std::min(line.find(' ', at), line.size());
      float x = 0;
      const auto [behind, error] = detail::from_chars(line.data() + at, line.data() + end, x);
      if (error != std::errc{} || behind != line.data() + end)
        raise<io_error>(403, place, ": '", line.substr(at, end - at), "' is not a number");
      vector.push_back(x);
      at = end;
    }
    selector.add(std::move(word), vector, place);
  });
}

}  // namespace detail

MOTIONLANG_BODY WordVectors select_word_vectors(const FilePath& source, const WordSelection& selection) {
  detail::VectorSelector selector(selection, source.string());
  const auto file = MappedFile::open(source);
  const std::string_view text = detail::as_text(file->bytes());
  if (detail::trim(text.substr(0, 100)).starts_with('{'))
    detail::select_from_json(JsonMembers::open(source), selector);
  else
    detail::select_from_lines(text, source.string(), selector);
  return selector.finish();
}

MOTIONLANG_NAMESPACE_END
