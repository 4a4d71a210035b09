// SPDX-License-Identifier: MIT
/// TM2T's published model from text to motion. Words are read from both ends, and a recurrent network that attends to
/// them writes motion tokens one by one.
///
///     auto state = m.start(words.encode<B>(texts).tokens);
///     const auto logits = m.step(previous, state).logits;  // (texts, symbols), and so on with what was chosen
///
/// Source  TM2T (Guo et al., ECCV 2022), section 3.3; TM2T networks/modules.py Seq2SeqText2MotModel
/// Differs from the paper: no positions and no mu network, as published
#pragma once

#include <utility>  // move

#include <motionlang/nn/bi_gru.hpp>
#include <motionlang/nn/decoding.hpp>
#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/layer_norm.hpp>
#include <motionlang/nn/leaky_relu.hpp>
#include <motionlang/tensor/gradient.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     a = softmax(W_q h . W_k w / sqrt(width)) W_v w
/// Source  TM2T eq. 5 (queries, keys, values) and TM2T eq. 6
/// Words are a padded tensor, and nothing is masked. The padding after a short text has logit 0 and the bias of W_v as
/// value. So, as published, a text is attended to a little differently beside longer ones.
template <Backend B>
struct WordAttention {
  Linear<B> W_q;
  LinearMap<B> W_k;
  Linear<B> W_v;

  static constexpr auto fields() {
    using M = WordAttention;
    return motionlang::fields("W_q", &M::W_q, "W_k", &M::W_k, "W_v", &M::W_v);
  }
  WordAttention() = default;
  WordAttention(Index query, Index word, Index width, Rng auto& rng)
      : W_q(query, width, rng), W_k(word, width, rng), W_v(word, width, rng) {}

  struct Memory {
    Tensor<B, 3> keys, values;  // (texts, words, width)
  };
  Memory memory(const Tensor<B, 3>& words) const {
    const auto rows = reshape<2>(words, {words.size(0) * words.size(1), words.size(2)});
    // The keys and values of TM2T eq. 5.
    return {reshape<3>(W_k(rows), {words.size(0), words.size(1), W_k.weight.size(0)}), W_v(words)};
  }
  struct Result {
    Tensor<B, 2> weights, attended;  // (texts, words), (texts, width)
  };
  Result operator()(const Tensor<B, 2>& h, const Memory& m) const {
    const ModuleScope scope(*this);
    const Index n = m.keys.size(0), words = m.keys.size(1), width = m.keys.size(2);
    const auto q = reshape<3>(W_q(h), {n, 1, width});
    const auto scores = matmul(q, m.keys, {.transpose_b = true}) * (1 / std::sqrt(static_cast<double>(width)));
    const auto weights = softmax(reshape<2>(scores, {n, words}));  // TM2T eq. 6
    return {weights, reshape<2>(matmul(reshape<3>(weights, {n, 1, words}), m.values), {n, width})};
  }
};

/// One step at a time.
///     early   a = attention(h);   h' = GRU(leaky_relu(LN(W [a, e])), h);   logits = E h'
///     late    h' = GRU(e, h);   a = attention(h');   logits = E W' leaky_relu(LN(W [a, h']))
/// e: the row of the previous token in E.
template <Backend B>
struct AttentiveGruDecoder {
  Embedding<B> input_emb;
  Linear<B> z2init;
  std::vector<GruLayer<B>> gru;
  WordAttention<B> att_layer;
  Linear<B> att_linear_0;
  LayerNorm<B> att_linear_1;
  std::optional<Linear<B>> att_linear_3;  // late

  static constexpr auto fields() {
    using M = AttentiveGruDecoder;
    return motionlang::fields("input_emb", &M::input_emb, "z2init", &M::z2init, "gru", &M::gru, "att_layer",
                              &M::att_layer, "att_linear.0", &M::att_linear_0, "att_linear.1", &M::att_linear_1,
                              "att_linear.3", &M::att_linear_3);
  }
  AttentiveGruDecoder() = default;
  AttentiveGruDecoder(Index symbols, Index word, Index width, Index layers, bool late, Rng auto& rng)
      : input_emb(symbols, width, rng),
        z2init(word, width * layers, rng),
        att_layer(width, word, width, rng),
        att_linear_0(2 * width, width, rng),
        att_linear_1(width) {
    for (Index i = 0; i < layers; ++i) gru.emplace_back(width, width, rng);
    if (late) att_linear_3 = Linear<B>(width, width, rng);
  }

  struct State {
    std::vector<Tensor<B, 2>> hidden;  // of each layer, (texts, width)
    typename WordAttention<B>::Memory memory;
  };
  struct Result {
    Tensor<B, 2> logits;
    typename WordAttention<B>::Result attention;
  };

  State start(const Tensor<B, 3>& words, const Tensor<B, 2>& sentence) const {
    State out{{}, att_layer.memory(words)};
    const auto all = z2init(sentence);
    const Index width = input_emb.weight.size(1);
    for (Index i = 0; i < std::ssize(gru); ++i) out.hidden.push_back(slice(all, 1, i * width, (i + 1) * width));
    return out;
  }
  Result step(std::span<const Index> previous, State& state) const {
    const auto e = input_emb(previous);
    auto mixed = [&](const Tensor<B, 2>& attended, const Tensor<B, 2>& other) {
      return leaky_relu(att_linear_1(att_linear_0(concat(1, attended, other))));
    };
    Result out;
    if (!att_linear_3) {
      out.attention = att_layer(state.hidden.back(), state.memory);
      out.logits = project(recur(mixed(out.attention.attended, e), state));
    } else {
      const auto h = recur(e, state);
      out.attention = att_layer(h, state.memory);
      out.logits = project((*att_linear_3)(mixed(out.attention.attended, h)));
    }
    return out;
  }

 private:
  Tensor<B, 2> recur(Tensor<B, 2> x, State& state) const { return gru_step<B>(gru, std::move(x), state.hidden); }
  Tensor<B, 2> project(const Tensor<B, 2>& x) const { return linear<B>(x, input_emb.weight, nullptr); }
};

/// Published sizes.
struct Seq2SeqGruConfig {
  Index word = 300, text_hidden = 512, motion_hidden = 1024, layers = 1;
  Index symbols = 1027;
  bool late = false;  // attention after the recurrent network, not before
};

/// The names are those of the published checkpoint.
template <Backend B>
struct Seq2SeqGru {
  BiGruEncoder<B> text_encoder;
  AttentiveGruDecoder<B> motion_decoder_step;

  static constexpr auto fields() {
    using M = Seq2SeqGru;
    return motionlang::fields("text_encoder", &M::text_encoder, "motion_decoder_step", &M::motion_decoder_step);
  }
  /// Input and output share the vectors of the tokens. Files contain them twice.
  std::string copy_of(const std::string& path) const {
    return path == "motion_decoder_step.trg_word_prj.weight" ? "motion_decoder_step.input_emb.weight" : "";
  }

  Seq2SeqGru() = default;
  Seq2SeqGru(const Seq2SeqGruConfig& c, Rng auto& rng)
      : text_encoder(c.word, c.text_hidden, rng),
        motion_decoder_step(c.symbols, 2 * c.text_hidden, c.motion_hidden, c.layers, c.late, rng) {}

  using State = typename AttentiveGruDecoder<B>::State;
  using Step = typename AttentiveGruDecoder<B>::Result;

  /// words: vectors without parts of speech. `longest`: pads as if the longest text had this many words; 0: does not.
  State start(const Sequences<B>& words, Index longest = 0) const {
    const auto read = text_encoder(words);
    return motion_decoder_step.start(to_padded(read.equally_far(), 0, longest), read.ends());
  }
  /// previous: the last token of each text.
  Step step(std::span<const Index> previous, State& state) const { return motion_decoder_step.step(previous, state); }

  /// For each token, the logits of the next one, packed like `inputs`, of which there must be one for each text.
  /// `forced`: the decoder reads the inputs. Otherwise it reads their first token and then its own most probable
  /// tokens. `longest`: as for start.
  Tensor<B, 2> logits(const Sequences<B>& words, const IdSequences& inputs, bool forced, Index longest = 0) const {
    const Index n = inputs.count();
    if (words.count() != n) raise<shape_error>(204, "Seq2SeqGru: ", n, " sequences for ", words.count(), " texts");
    auto state = start(words, longest);
    std::vector<Tensor<B, 2>> steps;
    std::vector<Index> previous(static_cast<std::size_t>(n));
    for (Index t = 0; t < inputs.offsets.longest(); ++t) {
      if (t > 0 && !forced) previous = arg_max(steps.back());
      for (Index s = 0; s < n && (forced || t == 0); ++s) {
        const auto own = inputs[s];
        if (t < std::ssize(own)) previous[static_cast<std::size_t>(s)] = own[static_cast<std::size_t>(t)];
      }
      steps.push_back(step(previous, state).logits);
    }
    PoolVector<Index> pick;
    for (Index s = 0; s < n; ++s) {
      for (Index t = 0; t < inputs.offsets.length(s); ++t) pick.push_back(t * n + s);
    }
    if (steps.empty()) return Tensor<B, 2>::zeros({0, motion_decoder_step.input_emb.weight.size(0)});
    return gather(concat(std::span<const Tensor<B, 2>>(steps), 0), pick);
  }

  /// The function that decode_batch calls. The state follows the steps, so beginnings must grow by one token at a time.
  auto next(State& state) const {
    return [this, &state](const IdSequences& written) {
      std::vector<Index> last;
      for (Index s = 0; s < written.count(); ++s) last.push_back(written[s].back());
      return step(last, state).logits;
    };
  }
};

/// Randomly written sequences through which gradients flow.
template <Backend B>
struct GumbelSample {
  Tensor<B, 3> one_hot;        // (sequences, 1 + steps, symbols), the mark of the beginning first
  std::vector<Index> lengths;  // tokens after it

  /// The rows that count, with the mark of the beginning.
  Sequences<B> rows() const {
    std::vector<Index> with_begin;
    for (Index n : lengths) with_begin.push_back(n + 1);
    return from_padded(one_hot, std::span<const Index>(with_begin));
  }
};
struct GumbelOptions {
  Index begin = 1024, end = 1025;
  Index max_steps = 55, top_k = 0;
  double tau = 1;
  Index longest = 0;  // pads the words as if the longest text had this many; 0: does not
};

/// g = -log(-log u) for uniform values u: the arg max of logits + g is distributed by their softmax. (rows, symbols)
/// first  of these rows in what the generator draws
template <Backend B>
Tensor<B, 2> gumbel_noise(Index rows, Index symbols, Philox& rng, Index first = 0) {
  std::vector<typename B::scalar> g(static_cast<std::size_t>(rows * symbols));
  std::vector<double> u(g.size());
  rng.uniform<double>(u, static_cast<std::uint64_t>(first * symbols));
  for (std::size_t i = 0; i < g.size(); ++i)
    g[i] = static_cast<typename B::scalar>(-std::log(-std::log(std::clamp(u[i], 1e-12, 1 - 1e-12))));
  return Tensor<B, 2>::from(g, {rows, symbols});
}

/// The numbers that gumbel_noise draws for a batch in one step after the other. A part of the batch needs some rows.
struct GumbelNoise {
  Philox rng;
  Index sequences = 0, symbols = 0;  // of the batch, of a row

  template <Backend B>
  Tensor<B, 2> rows(Index step, Index first, Index count) const {
    const Index blocks = (sequences * symbols + 3) / 4;  // of four numbers that Philox draws at once
    Philox own = rng;
    own.position += static_cast<std::uint64_t>(step * blocks);
    return gumbel_noise<B>(count, symbols, own, first);
  }
};

///     y = softmax((logits + g) / tau),   row = onehot(arg max y) - sg(y) + y
/// The next token is the arg max, and no gradient flows through that choice. Start and end marks are never written. A
/// sequence ends if the end is the most probable symbol, and continues until the last one has ended.
/// noise(step)  (sequences, symbols), see gumbel_noise
/// Source       Jang, Gu, Poole, "Categorical reparameterization with Gumbel-softmax" (ICLR 2017), section 2.2;
///              TM2T networks/modules.py gumbel_sample
/// Differs      from TM2T, whose code fails if all sequences end at once: here each is then the start mark only
template <Backend B, class Noise>
GumbelSample<B> gumbel_sample(const Seq2SeqGru<B>& m, const Sequences<B>& words, const GumbelOptions& o,
                              Noise&& noise) {
  const Index n = words.count(), symbols = m.motion_decoder_step.input_emb.weight.size(0);
  auto state = m.start(words, o.longest);
  std::vector<Index> previous(static_cast<std::size_t>(n), o.begin);
  GumbelSample<B> out{{}, std::vector<Index>(previous.size(), o.max_steps)};
  std::vector<Tensor<B, 2>> steps{one_hot<B>(previous, symbols)};
  for (Index t = 0; t < o.max_steps; ++t) {
    const auto logits = m.step(previous, state).logits;
    auto penalty = top_k_penalty(logits, o.top_k);
    const auto best = arg_max(logits);
    for (std::size_t s = 0; s < best.size(); ++s) {
      if (best[s] == o.end) out.lengths[s] = std::min(out.lengths[s], t);
      for (Index mark : {o.begin, o.end})
        penalty.at(s * static_cast<std::size_t>(symbols) + static_cast<std::size_t>(mark)) = -1e30f;
    }
    if (std::all_of(out.lengths.begin(), out.lengths.end(), [&](Index length) { return length < o.max_steps; })) break;
    const auto y = softmax((logits + Tensor<B, 2>::from(penalty, {n, symbols}) + noise(t)) * (1 / o.tau));
    previous = arg_max(y);
    steps.push_back(one_hot<B>(previous, symbols) - stop_gradient(y) + y);
  }
  const Index length = std::ssize(steps);
  const auto by_step = reshape<3>(concat(std::span<const Tensor<B, 2>>(steps), 0), {length, n, symbols});
  out.one_hot = permute(by_step, {1, 0, 2});
  return out;
}

MOTIONLANG_NAMESPACE_END
