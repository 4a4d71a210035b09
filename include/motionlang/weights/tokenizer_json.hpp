// SPDX-License-Identifier: MIT
/// Tokenizers from the JSON files of Hugging Face: tokenizer.json, tokenizer_config.json, vocab.json. They support the
/// kinds that BERT, MPNet, RoBERTa and CLIP use. Any other normaliser, splitter or template is refused by its name,
/// because ids without it would be wrong and look right.
///
///     const AnyTokenizer tokenizer = read_tokenizer("all-mpnet-base-v2");   // a folder
///
/// Source  huggingface/tokenizers, what it writes to tokenizer.json
#pragma once

#include <map>      // tokens
#include <variant>  // BERT, CLIP or RoBERTa

#include <motionlang/text/roberta_tokenizer.hpp>
#include <motionlang/weights/tokenizer_files.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class JsonView;

/// One of the tokenizers that files describe.
class AnyTokenizer {
 public:
  AnyTokenizer(BertTokenizer t) : kind_(std::move(t)) {}
  AnyTokenizer(ClipTokenizer t) : kind_(std::move(t)) {}
  AnyTokenizer(RobertaTokenizer t) : kind_(std::move(t)) {}

  std::vector<Index> encode(std::string_view text) const {
    return std::visit([&](const auto& t) { return t.encode(text); }, kind_);
  }
  std::string decode(std::span<const Index> ids) const {
    return std::visit([&](const auto& t) { return t.decode(ids); }, kind_);
  }
  Index size() const {
    return std::visit([](const auto& t) { return t.size(); }, kind_);
  }
  Index pad_id() const {
    return std::visit([](const auto& t) { return t.pad_id(); }, kind_);
  }
  /// Null if it is another kind.
  const BertTokenizer* bert() const { return std::get_if<BertTokenizer>(&kind_); }
  const ClipTokenizer* clip() const { return std::get_if<ClipTokenizer>(&kind_); }
  const RobertaTokenizer* roberta() const { return std::get_if<RobertaTokenizer>(&kind_); }

 private:
  std::variant<BertTokenizer, ClipTokenizer, RobertaTokenizer> kind_;
};
static_assert(Tokenizer<AnyTokenizer>);

/// Choices of the caller. A tokenizer.json has them too, but the published systems do not apply those.
struct TokenizerLimits {
  std::optional<Index> longest = {};  // ids of a text with its special tokens; by default 512, for CLIP 77
  std::optional<bool> truncate = {};  // by default CLIP cuts, others refuse
  bool stored = false;                // take both from the block "truncation" of the file, if it has one
  // For CLIP: as these files say; MDM and STMC were trained with the original.
  ClipCleaning cleaning = ClipCleaning::hugging_face;
};

namespace detail {

/// Pieces by id, from an object of ids and the added tokens that it lacks. Throws io_error 403 unless every id from 0
/// on has one.
std::vector<std::string> pieces_by_id(const JsonView& vocabulary, std::span<const AddedToken> added = {});

std::vector<AddedToken> added_tokens(const JsonView& document);

}  // namespace detail

/// The tokenizer that a tokenizer.json describes.
/// Throws  io_error 403 if it is malformed, 404 with the type for an unsupported kind; config_error 107 for values of
///         the wrong kind, missing pieces, merges of unknown ones
AnyTokenizer tokenizer_from_json(const JsonView& document, const TokenizerLimits& limits = {});
/// Throws io_error 401 and as tokenizer_from_json.
AnyTokenizer read_tokenizer_json(const FilePath& path, const TokenizerLimits& limits = {});

/// vocab.json: the id of every piece. Throws io_error 401, 403 unless the ids are 0, 1, ...; config_error 107.
std::vector<std::string> read_vocabulary_json(const FilePath& path);

/// The settings in a tokenizer_config.json for a tokenizer with its vocabulary in another file.
struct TokenizerConfig {
  std::string tokenizer_class;
  std::optional<bool> lower_case = {}, strip_accents = {}, split_cjk = {};
  std::optional<Index> longest = {};          // model_max_length; none if it is unlimited
  std::map<std::string, std::string> tokens;  // "cls_token" -> "[CLS]", ...
};

/// Throws config_error 107.
TokenizerConfig tokenizer_config_from_json(const JsonView& view);

namespace detail {

inline bool file_exists(const FilePath& path) { return ::access(path.c_str(), R_OK) == 0; }

}  // namespace detail

/// The tokenizer in the folder of a model: its tokenizer.json, else vocab.txt (BERT, MPNet) or vocab.json and
/// merges.txt (CLIP; RoBERTa, whose vocabulary has <s>), with its tokenizer_config.json. model_max_length is not
/// applied, as in the published systems.
/// Throws io_error 401 if all of these files are missing, and as their readers
AnyTokenizer read_tokenizer(const FilePath& folder, const TokenizerLimits& limits = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/tokenizer_json.ipp>
#endif
