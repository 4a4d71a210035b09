// SPDX-License-Identifier: MIT
/// Motion tokens in files, and the pairs of tokens and words that TM2T is trained on.
///
///    <tokenizer>/<id>.txt     a line for each pass over the clip (five): ids of codes, separated by blanks, no marks
///
/// Source  TM2T (Guo et al., ECCV 2022), section 3.1; tokenize_script.py, data/dataset.py TextMotionTokenDataset.
///         TM2T's script appends to an existing file; here it is replaced.
#pragma once

#include <span>         // tokens
#include <string>       // names
#include <string_view>  // texts
#include <vector>       // tokens

#include <motionlang/datasets/humanml3d_texts.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class GloVe;
class NumpyRandom;
struct MotionVocabulary;

/// The tokens of a clip: one list for each pass, which starts at other frames.
using TokenLines = std::vector<std::vector<Index>>;

/// Throws io_error 403, with the line, for a value that is not an id below `codes`.
TokenLines parse_token_lines(std::string_view text, Index codes = 1024, std::string_view name = "tokens");
/// Throws io_error 401, 403.
TokenLines read_token_lines(const FilePath& path, Index codes = 1024);
/// Laws  parse_token_lines(format_token_lines(x)) equals x without its empty lists
std::string format_token_lines(const TokenLines& lines);

/// A clip or a part of one with its captions.
struct TokenEntry {
  std::string name;  // the id; for a part with its times in seconds: "000123_1.000000_3.400000"
  TokenLines lines;
  std::vector<MotionCaption> captions;
};

struct TokenEntryOptions {
  double tokens_per_second = 5;
  /// As published, each part is cut out of what the part before left over, and training takes what the last one left
  /// over.
  bool cut_again = false;
};

/// The entries of a clip; the whole clip comes last, if it has a caption. Parts without tokens are left out (as
/// published, only those of no length).
std::vector<TokenEntry> token_entries(const std::string& id, std::span<const MotionCaption> captions, TokenLines lines,
                                      const TokenEntryOptions& options = {});

/// One item in three loses its first or last token, so that the model cannot rely on where motions begin.
enum class TokenDrop { none, first, last };
TokenDrop token_drop(NumpyRandom& random);

/// The start mark, the tokens, the end mark. Throws shape_error 207 if a token is to be dropped and there is none.
std::vector<Index> marked_tokens(std::span<const Index> tokens, const MotionVocabulary& vocabulary,
                                 TokenDrop drop = TokenDrop::none);
/// The numbers of "sos", of at most `longest` words, and of "eos".
std::vector<Index> marked_words(const GloVe& glove, std::span<const TaggedWord> words, Index longest = 20);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/motion_tokens.ipp>
#endif
