// SPDX-License-Identifier: MIT
/// The word vectors of the HumanML3D evaluators: three files with one stem ("our_vab").
///
///     stem_data.npy    (words, 300)
///     stem_words.pkl   list of words
///     stem_idx.pkl     word -> row
/// Source  Guo et al. (CVPR 2022), TM2T utils/word_vectorizer.py WordVectorizerV2
#pragma once

#include <motionlang/file/file_path.hpp>
#include <motionlang/text/glove.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Throws io_error 401 to 407; 403 if the files do not fit each other.
GloVe read_glove(const FilePath& stem);

/// Writes the three files.
/// Laws    read_glove then returns the same words in the same rows, with their vectors
/// Throws  io_error 401
void write_glove(const FilePath& stem, const GloVe& glove);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/glove_file.ipp>
#endif
