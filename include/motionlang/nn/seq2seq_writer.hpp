// SPDX-License-Identifier: MIT
/// A transformer that writes one symbol after the other. It reuses what it has computed for a beginning.
///
///     Seq2SeqWriter writer(m, memory);
///     const auto found = beam_search(writer, BeamOptions{.beams = 3});    // memory of one source
///     const auto all = decode_batch(writer, memory.count(), DecodingOptions{.top_k = 10});
#pragma once

#include <motionlang/nn/seq2seq_transformer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A function for nn/decoding.hpp. The model must outlive it.
template <Backend B>
class Seq2SeqWriter {
 public:
  Seq2SeqWriter(const Seq2SeqTransformer<B>& model, const Sequences<B>& memory) : m_(model), sources_(memory.count()) {
    for (const auto& layer : m_.decoder.layer_stack) {
      Cache c;
      c.memory_keys = memory.with(layer.enc_attn.w_ks(memory.rows));
      c.memory_values = layer.enc_attn.w_vs(memory.rows);
      layers_.push_back(std::move(c));
    }
  }

  /// Takes beginnings of one length, equally many for each source, one source after the other. Returns logits of the
  /// next symbol, (beginnings, symbols). Each should be a beginning of the call before, in any place, plus one more
  /// symbol. Throws shape_error 205 for other lengths or numbers, and 203 for a beginning longer than the positions.
  Tensor<B, 2> operator()(const IdSequences& written) {
    const Index n = written.count(), length = written.offsets.longest();
    if (n == 0 || n % sources_ != 0 || length == 0 || !(written.offsets == Offsets::equal(n, length)))
      raise<shape_error>(205, "Seq2SeqWriter: ", n, " beginnings for ", sources_, " sources, the longest is ", length);
    auto parents = find_parents(written, length);
    if (!parents) {
      before_ = {};
      if (length > 1) {
        (*this)(written.without_ends(0, 1));
        parents = find_parents(written, length);
      } else {
        parents.emplace();
      }
    }
    std::vector<Index> last;
    for (Index s = 0; s < n; ++s) last.push_back(written[s].back());
    const Offsets one = Offsets::equal(n, 1), per_source = Offsets::equal(sources_, n / sources_);
    const auto embedded = m_.embed_target(IdSequences{last, one}).rows;
    const auto position = slice(m_.decoder.position_enc.positional_encoding, 0, length - 1, length);
    auto x = embedded * std::sqrt(static_cast<double>(embedded.size(1))) + position;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      const auto& layer = m_.decoder.layer_stack[i];
      Cache& c = layers_[i];
      c.keys = grown(c.keys, *parents, length, {layer.slf_attn.w_ks(x), one});
      c.values = grown(c.values, *parents, length, {layer.slf_attn.w_vs(x), one});
      const auto own = layer.slf_attn.read({x, one}, c.keys, c.values.rows, false);
      x = layer.pos_ffn(layer.enc_attn.read({own, per_source}, c.memory_keys, c.memory_values, false));
    }
    before_ = written;
    return m_.project(x);
  }

 private:
  struct Cache {
    Sequences<B> memory_keys;
    Tensor<B, 2> memory_values;
    Sequences<B> keys, values;  // of the beginnings, which are all of one length
  };

  /// For each beginning, the one of the call before that it continues. Nothing if one has none.
  std::optional<std::vector<Index>> find_parents(const IdSequences& written, Index length) const {
    if (length < 2 || before_.count() == 0 || before_.offsets.length(0) != length - 1) return std::nullopt;
    const Index n = written.count(), now = n / sources_, then = before_.count() / sources_;
    std::vector<Index> out;
    for (Index s = 0; s < n; ++s) {
      const auto wanted = written[s].first(static_cast<std::size_t>(length - 1));
      Index p = s / now * then;
      const Index end = p + then;
      while (p < end && !std::equal(wanted.begin(), wanted.end(), before_[p].begin())) ++p;
      if (p == end) return std::nullopt;
      out.push_back(p);
    }
    return out;
  }
  /// The rows of the parents, each extended by one.
  static Sequences<B> grown(const Sequences<B>& before, std::span<const Index> parents, Index length,
                            const Sequences<B>& added) {
    return length == 1 ? added : concat_tokens(detail::some_sequences(before, parents), added);
  }

  const Seq2SeqTransformer<B>& m_;
  Index sources_;
  std::vector<Cache> layers_;
  IdSequences before_;
};

MOTIONLANG_NAMESPACE_END
