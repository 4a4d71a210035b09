// Names that the usage examples of nn/, vae/ and search/ use without declaring them.
#include "usage.hpp"

#include <motionlang/nn/conv_stack.hpp>
#include <motionlang/nn/decoding.hpp>
#include <motionlang/nn/seq2seq_gru.hpp>
#include <motionlang/nn/seq2seq_transformer.hpp>
#include <motionlang/nn/seq2seq_writer.hpp>
#include <motionlang/nn/transformer_encoder.hpp>
#include <motionlang/search/motion_index_file.hpp>
#include <motionlang/search/motion_search.hpp>
#include <motionlang/search/vector_graph.hpp>
#include <motionlang/search/vector_scan.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

void stack(Philox& rng) {
#include "nn/conv_stack.1.inc"
}
void decode(const Seq2SeqTransformer<B>& m, const Sequences<B>& memory) {
#include "nn/decoding.1.inc"
}
void gru(const Seq2SeqGru<B>& m, const GloVe& words, const std::vector<std::string>& texts,
         const std::vector<Index>& previous) {
#include "nn/seq2seq_gru.1.inc"
}
void transformer(const Seq2SeqTransformer<B>& m, const IdSequences& tokens, const IdSequences& words) {
#include "nn/seq2seq_transformer.1.inc"
}
void write(const Seq2SeqTransformer<B>& m, const Sequences<B>& memory) {
#include "nn/seq2seq_writer.1.inc"
}
void constant() {
#include "nn/transformer_encoder.1.inc"
}
void tokens_of(const MotionTokenizer<B>& tokenizer, const Sequences<B>& normalized) {
#include "vae/motion_tokenizer.1.inc"
}
void index_file(const EncodedClip& clip){
#include "search/motion_index_file.1.inc"
} std::span<const float> vector_of(const char* text);
void search_motions(const MotionIndex& index) {
#include "search/motion_search.1.inc"
}
void graph(const MotionIndex& index, const MotionIndex& more) {
#include "search/vector_graph.1.inc"
}
void scan(std::span<const float> rows, std::span<const float> query) {
#include "search/vector_scan.1.inc"
}
