// Names that the usage examples of text/ use without declaring them.
#include "usage.hpp"

#include <motionlang/file/json.hpp>
#include <motionlang/systems/tmr.hpp>
#include <motionlang/text/action_phrases.hpp>
#include <motionlang/text/bert.hpp>
#include <motionlang/text/bert_tokenizer.hpp>
#include <motionlang/text/clip_text.hpp>
#include <motionlang/text/clip_tokenizer.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/text/stranger_texts.hpp>
#include <motionlang/text/text_completion.hpp>
#include <motionlang/text/text_table.hpp>
#include <motionlang/text/tokenized_encoder.hpp>
#include <motionlang/text/word_piece_tokens.hpp>
#include <motionlang/text/word_vectors.hpp>
#include <motionlang/weights/glove_file.hpp>
#include <motionlang/weights/stmc_file.hpp>
#include <motionlang/weights/text_network_file.hpp>
#include <motionlang/weights/tokenizer_files.hpp>
#include <motionlang/weights/tokenizer_json.hpp>
#include <motionlang/weights/weight_file.hpp>
#include <motionlang/weights/word_vector_file.hpp>

#include <iostream>

void action_phrases_() {
#include "text/action_phrases.1.inc"
}
void roberta_() {
#include "text/roberta_tokenizer.1.inc"
}
void bert_(const JsonView& config, const WeightFile& weights, const BertTokenizer& tokenizer,
           const std::vector<std::string>& texts) {
#include "text/bert.1.inc"
}
void bert_tokenizer_() {
#include "text/bert_tokenizer.1.inc"
}
void clip_(const WeightFile& weights, const ClipTokenizer& tokenizer, const std::vector<std::string>& texts) {
#include "text/clip_text.1.inc"
}
void clip_tokenizer_(const std::vector<std::string>& texts) {
#include "text/clip_tokenizer.1.inc"
}
void glove_(const std::vector<std::string>& texts) {
#include "text/glove.1.inc"
}
void encoders(const ClipTokenizer& clip_tokenizer, const BertTokenizer& bert_tokenizer, const JsonView& config,
              const WeightFile& weights) {
#include "text/tokenized_encoder.1.inc"
}
void word_pieces(const Tmr<B>& tmr, const std::vector<std::string>& captions, Philox& rng) {
#include "text/word_piece_tokens.1.inc"
}
void text_tables(const CaptionEncoder<B>& encoder, const std::vector<std::string>& captions) {
#include "text/text_table.1.inc"
}
void known_captions_(const std::string& path, const Stmc<B>& stmc) {
  const auto show = [](const std::vector<NearText>&) {};
#include "text/known_captions.1.inc"
}
void completion(const KnownCaptions& captions) {
  const auto offer = [](const std::string&) {};
#include "text/text_completion.1.inc"
}
void word_vectors() {
#include "text/word_vectors.1.inc"
}
void strangers_(const WordPiece& tokenizer, const WordVectors& vectors, Philox& rng) {
#include "text/stranger_texts.1.inc"
}
