// SPDX-License-Identifier: MIT
/// The concept of a tokenizer, batches of ids, and strings with an id of their own anywhere in a text.
#pragma once

#include <algorithm>    // max, fill
#include <array>        // first bytes
#include <concepts>     // same_as
#include <span>         // texts
#include <string>       // texts
#include <string_view>  // texts
#include <vector>       // ids

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Turns a text into the ids for a network, between the marks of start and end.
/// Laws     every id is at least 0 and below size(); any bytes are a text: bytes that are not UTF-8 count as U+FFFD
/// Models   WordPiece, BertTokenizer, ClipTokenizer, and yours
template <class T>
concept Tokenizer = requires(const T& t, std::string_view text) {
  { t.encode(text) } -> std::same_as<std::vector<Index>>;
  { t.size() } -> std::same_as<Index>;
};

/// The ids of several texts in order, for an embedding and `Offsets(lengths)`.
struct TokenBatch {
  std::vector<Index> ids, lengths;

  Index count() const { return static_cast<Index>(lengths.size()); }
  Index longest() const { return lengths.empty() ? 0 : *std::max_element(lengths.begin(), lengths.end()); }

  /// (texts, width), padded with `pad` on the right; width 0: that of the longest text. Throws shape_error 204 if a
  /// text is longer.
  std::vector<Index> padded(Index pad, Index width = 0) const;
};

template <Tokenizer T>
TokenBatch tokenize(const T& tokenizer, std::span<const std::string> texts) {
  TokenBatch out;
  for (const std::string& text : texts) {
    const std::vector<Index> ids = tokenizer.encode(text);
    out.ids.insert(out.ids.end(), ids.begin(), ids.end());
    out.lengths.push_back(static_cast<Index>(ids.size()));
  }
  return out;
}

/// A string that becomes its id before words are found. White space beside it does not matter, because all our
/// tokenizers drop white space.
struct AddedToken {
  std::string content;
  Index id = 0;
  bool normalized = false;  // find it in the normalised text, not in the raw one
  bool operator==(const AddedToken&) const = default;
};

namespace detail {

/// Finds added tokens in a text: the leftmost one, and of several at one place the longest.
class AddedTokenSearch {
 public:
  AddedTokenSearch() = default;
  explicit AddedTokenSearch(std::vector<AddedToken> tokens);
  bool empty() const { return tokens_.empty(); }
  bool has(Index id) const {
    return std::any_of(tokens_.begin(), tokens_.end(), [&](const AddedToken& t) { return t.id == id; });
  }

  /// Calls on_text(part) for the text between tokens and on_token(id) for tokens, in the order of the text.
  template <class OnText, class OnToken>
  void split(std::string_view text, OnText on_text, OnToken on_token) const {
    std::size_t from = 0;
    for (std::size_t at = 0; at < text.size();) {
      const AddedToken* token = begins_[static_cast<unsigned char>(text[at])] ? match(text.substr(at)) : nullptr;
      if (token == nullptr) {
        ++at;
        continue;
      }
      if (from < at) on_text(text.substr(from, at - from));
      on_token(token->id);
      from = at += token->content.size();
    }
    if (from < text.size()) on_text(text.substr(from));
  }

 private:
  const AddedToken* match(std::string_view text) const;

  std::vector<AddedToken> tokens_;
  std::array<bool, 256> begins_{};
};

}  // namespace detail

/// The frame around one text or a pair: ids and the places of the texts, each with its token type.
/// BERT: [CLS] A [SEP] B [SEP], types 0 0 0 1 1.
struct FramePart {
  enum Kind { token, text_a, text_b };
  Kind kind = token;
  Index id = 0;  // of a token
  Index type = 0;
  bool operator==(const FramePart&) const = default;
};

/// The ids of two texts in one frame, and the token type of each.
struct TokenPair {
  std::vector<Index> ids, types;
};

namespace detail {

TokenPair framed(std::span<const FramePart> frame, std::span<const Index> a, std::span<const Index> b = {});

/// The number of ids that a frame adds to its texts.
std::size_t frame_size(std::span<const FramePart> frame);

/// The framed ids of a text, at most `longest`. A longer text is cut if `truncate`, otherwise throws config_error 101.
std::vector<Index> framed_text(std::string_view tokenizer, std::span<const FramePart> frame, std::vector<Index> ids,
                               Index longest, bool truncate);
/// Two texts in one frame, which is never cut. Throws config_error 101 beyond `longest` ids.
TokenPair framed_pair(std::string_view tokenizer, std::span<const FramePart> frame, std::span<const Index> a,
                      std::span<const Index> b, Index longest);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/tokenizer.ipp>
#endif
