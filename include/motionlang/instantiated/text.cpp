// SPDX-License-Identifier: MIT
// Bodies of the headers in text/, compiled once for motionlang::instantiated.
#include <motionlang/text/action_phrases.ipp>
#include <motionlang/text/bag_of_words.ipp>
#include <motionlang/text/bert_tokenizer.ipp>
#include <motionlang/text/clip_tokenizer.ipp>
#include <motionlang/text/glove.ipp>
#include <motionlang/text/heard_words.ipp>
#include <motionlang/text/joined_labels.ipp>
#include <motionlang/text/known_captions.ipp>
#include <motionlang/text/known_words.ipp>
#include <motionlang/text/mirror_caption.ipp>
#include <motionlang/text/roberta_tokenizer.ipp>
#include <motionlang/text/stranger_texts.ipp>
#include <motionlang/text/text_completion.ipp>
#include <motionlang/text/text_repair.ipp>
#include <motionlang/text/text_table.ipp>
#include <motionlang/text/tokenizer.ipp>
#include <motionlang/text/unicode.ipp>
#include <motionlang/text/word_piece.ipp>
#include <motionlang/text/word_vectors.ipp>
