// SPDX-License-Identifier: MIT
/// Vocabularies of tokenizers as plain text: vocab.txt of BERT, merges.txt, bpe_simple_vocab_16e6.txt(.gz) of CLIP.
/// weights/tokenizer_json.hpp reads the JSON files.
///
/// Source  google-research/bert tokenization.py, openai/CLIP clip/simple_tokenizer.py, which read these files
#pragma once

#include <motionlang/file/file_path.hpp>
#include <motionlang/text/bert_tokenizer.hpp>
#include <motionlang/text/clip_tokenizer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One piece on each line; its id is the number of the line, from 0.
/// Throws io_error 403, with the line, for a piece that is empty, duplicated or not UTF-8
std::vector<std::string> parse_vocabulary(std::string_view text, std::string_view name = "vocab.txt");
/// Throws io_error 401 and as parse_vocabulary.
std::vector<std::string> read_vocabulary(const FilePath& path);

namespace detail {

/// Parses "a b". Throws io_error 403 with the place.
std::pair<std::string, std::string> parse_merge(std::string_view line, std::string_view name, Index number);

}  // namespace detail

/// Two symbols with a blank between on each line, in the order of their rank, up to the first empty line. A line that
/// begins with "#version", or in OpenAI's file with "\"bpe_simple_vocab", is a comment.
/// most    the largest number of lines to read
/// Throws  io_error 403, with the line, for a line of another form or a duplicated pair
BytePairMerges parse_merges(std::string_view text, std::string_view name = "merges.txt",
                            std::size_t most = static_cast<std::size_t>(-1));
/// Throws io_error 401 and as parse_merges and gunzip.
BytePairMerges read_merges(const FilePath& path, std::size_t most = static_cast<std::size_t>(-1));

/// The number of merges that CLIP takes from bpe_simple_vocab_16e6.txt; the file has 262,144.
inline constexpr std::size_t clip_merges = 48894;

/// CLIP's tokenizer from OpenAI's file, packed or not. Throws as read_merges, and as the constructor of ClipTokenizer.
inline ClipTokenizer read_clip_tokenizer(const FilePath& path, const ClipTokenizerOptions& options = {}) {
  return ClipTokenizer(read_merges(path, clip_merges), options, path.string());
}

/// BERT's tokenizer from vocab.txt. Throws as read_vocabulary, and as the constructor of BertTokenizer.
inline BertTokenizer read_bert_tokenizer(const FilePath& path, BertTokenizerOptions options = {}) {
  return BertTokenizer(read_vocabulary(path), std::move(options), path.string());
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/tokenizer_files.ipp>
#endif
