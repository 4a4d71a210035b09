// SPDX-License-Identifier: MIT
/// The words of a text that an encoder with a vocabulary and vectors of words knows nothing about.
///
///     for (const UnknownWord& w : unheard_words(tokenizer, vectors, "a person walsk"))
///       std::cout << w.word << ", like " << w.like << '\n';                             // walsk, like walks
#pragma once

#include <motionlang/text/known_words.hpp>
#include <motionlang/text/word_piece.hpp>
#include <motionlang/text/word_vectors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Words without a piece and without a vector, each once, in the order of the text. Words with other letters than a-z
/// come last. None if there are no vectors: pieces of words do not tell which words the training had.
std::vector<UnknownWord> unheard_words(const WordPiece& pieces, const WordVectors& vectors, std::string_view text);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/unheard_words.ipp>
#endif
