// SPDX-License-Identifier: MIT
/// Writes a sequence symbol by symbol with a model of the next symbol. It takes the most probable symbol, a random one,
/// or the best of several beams. The model is any function from the beginnings written so far to logits of the next
/// symbol:
///
///     // Tensor<B, 2> (rows, symbols)
///     auto next = [&](const IdSequences& written) { return m.next_logits(written, memory); };
///     const auto words = beam_search(next, {.begin = 0, .end = 1, .pad = 4199});
///
/// Source  TM2T (Guo et al., ECCV 2022), networks/transformer.py sample and sample_batch, networks/translator.py
#pragma once

#include <algorithm>  // nth_element, max_element
#include <array>      // one number
#include <cmath>      // exp
#include <vector>     // symbols

#include <motionlang/core/rng.hpp>
#include <motionlang/tensor/arg_max.hpp>
#include <motionlang/tensor/id_sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct DecodingOptions {
  Index begin = 0, end = 1, pad = 2;
  Index max_steps = 50;
  Index top_k = 0;         // samples only from this many most probable symbols; 0: all
  bool redraw_pad = true;  // decode_one never samples the padding either
};

/// Adds -1e30 to all logits of a row except the top_k largest and their equals; 0 or less: keeps all. (rows, symbols).
/// Throws numeric_error 301 for a logit that is NaN.
template <Backend B>
std::vector<typename B::scalar> top_k_penalty(const Tensor<B, 2>& logits, Index top_k) {
  using S = typename B::scalar;
  for (const S x : logits.span()) {
    if (std::isnan(x)) raise<numeric_error>(301, "decoding: a logit is NaN");
  }
  std::vector<S> out(static_cast<std::size_t>(logits.count()));
  const Index width = logits.size(1);
  if (top_k < 1 || top_k >= width) return out;
  const auto numbers = logits.span();
  for (Index r = 0; r < logits.size(0); ++r) {
    const auto row = numbers.subspan(static_cast<std::size_t>(r * width), static_cast<std::size_t>(width));
    std::vector<S> sorted(row.begin(), row.end());
    const auto kth = sorted.begin() + top_k - 1;
    std::nth_element(sorted.begin(), kth, sorted.end(), std::greater<>());
    for (Index i = 0; i < width; ++i) {
      if (row[static_cast<std::size_t>(i)] < *kth) out[static_cast<std::size_t>(r * width + i)] = S(-1e30);
    }
  }
  return out;
}

namespace detail {

/// The probabilities of each row, without those that the filter removes.
template <Backend B>
std::vector<std::vector<double>> next_probabilities(const Tensor<B, 2>& logits, Index top_k) {
  const auto penalty = top_k_penalty(logits, top_k);
  const auto numbers = logits.span();
  const auto width = static_cast<std::size_t>(logits.size(1));
  std::vector<std::vector<double>> out(static_cast<std::size_t>(logits.size(0)), std::vector<double>(width));
  for (std::size_t r = 0; r < out.size(); ++r) {
    const auto row = numbers.subspan(r * width, width);
    const auto largest = static_cast<double>(*std::max_element(row.begin(), row.end()));
    double sum = 0;
    for (std::size_t i = 0; i < width; ++i)
      sum += out[r][i] = penalty[r * width + i] < 0 ? 0 : std::exp(static_cast<double>(row[i]) - largest);
    for (double& p : out[r]) p /= sum;
  }
  return out;
}
inline Index most_probable(std::span<const double> p) { return std::max_element(p.begin(), p.end()) - p.begin(); }

/// The first symbol whose cumulative share is greater than u. Throws numeric_error 302 if all shares are 0.
Index draw(std::span<const double> p, double u);

}  // namespace detail

/// Writes one sequence. The result begins with the start mark and has no end mark; the end is written when it is the
/// most probable symbol.
/// next   takes one beginning
/// uniform()  a value of [0, 1) for each draw, or nullptr: the most probable symbol is taken. If a mark is drawn, it is
/// drawn again
/// Throws numeric_error 301 for a logit that is NaN, 302 if only marks can be drawn
template <class Next, class Uniform = std::nullptr_t>
std::vector<Index> decode_one(Next&& next, const DecodingOptions& o, Uniform&& uniform = nullptr) {
  std::vector<Index> out{o.begin};
  for (Index step = 0; step < o.max_steps; ++step) {
    auto p = detail::next_probabilities(next(IdSequences::one(out)), o.top_k).at(0);
    Index id = detail::most_probable(p);
    if (id == o.end) break;
    if constexpr (!std::is_same_v<std::remove_cvref_t<Uniform>, std::nullptr_t>) {
      auto marks = [&](Index i) { return i == o.begin || i == o.end || (o.redraw_pad && i == o.pad); };
      double allowed = 0;
      for (Index i = 0; i < std::ssize(p); ++i) allowed += marks(i) ? 0 : p[static_cast<std::size_t>(i)];
      if (!(allowed > 0)) raise<numeric_error>(302, "decode_one: after ", out.size(), " symbols only marks can follow");
      for (int draws = 1; marks(id = detail::draw(p, uniform())); ++draws) {
        if (draws < 1000) continue;  // nearly only marks: without them, the others have the same shares
        for (Index i = 0; i < std::ssize(p); ++i) p[static_cast<std::size_t>(i)] *= marks(i) ? 0 : 1;
      }
    }
    out.push_back(id);
  }
  return out;
}

/// Several sequences at once. All have the same number of symbols, of which the first `lengths` after the start mark
/// count.
struct Decoded {
  std::vector<std::vector<Index>> ids;
  std::vector<Index> lengths;

  /// The symbols that count, without the marks.
  IdSequences written() const;
};

/// next     takes `count` beginnings of one length
/// uniform(step, row)  a value of [0, 1), or nullptr: the most probable symbols are taken. Marks are never drawn; if
/// the end is the most probable symbol, it is written. A sequence that has ended continues until the last one has
/// ended; nothing is written in that step
/// Throws   numeric_error 302 if only marks could be drawn
template <class Next, class Uniform = std::nullptr_t>
Decoded decode_batch(Next&& next, Index count, const DecodingOptions& o, Uniform&& uniform = nullptr) {
  const auto n = static_cast<std::size_t>(count);
  Decoded out{std::vector<std::vector<Index>>(n, {o.begin}), std::vector<Index>(n, o.max_steps)};
  for (Index step = 0; step < o.max_steps; ++step) {
    auto p = detail::next_probabilities(next(IdSequences::from(out.ids)), o.top_k);
    std::vector<Index> best;
    for (std::size_t r = 0; r < n; ++r) {
      best.push_back(detail::most_probable(p[r]));
      if (best[r] == o.end) out.lengths[r] = std::min(out.lengths[r], step);
    }
    if (std::all_of(out.lengths.begin(), out.lengths.end(), [&](Index length) { return length < o.max_steps; })) break;
    for (std::size_t r = 0; r < n; ++r) {
      Index id = best[r];
      if constexpr (!std::is_same_v<std::remove_cvref_t<Uniform>, std::nullptr_t>) {
        if (id != o.end) {
          for (Index mark : {o.begin, o.end, o.pad}) p[r].at(static_cast<std::size_t>(mark)) = 0;
          id = detail::draw(p[r], uniform(step, static_cast<Index>(r)));
        }
      }
      out.ids[r].push_back(id);
    }
  }
  return out;
}
/// The uniform values of decode_batch from a generator. Each depends only on its step and row.
inline auto uniform_of(const Philox& rng) {
  return [rng](Index step, Index row) {
    std::array<double, 1> u{};
    rng.split(static_cast<std::uint64_t>(step)).split(static_cast<std::uint64_t>(row)).uniform<double>(u);
    return u[0];
  };
}

struct BeamOptions {
  Index begin = 0, end = 1, pad = 2;
  Index beams = 2, max_length = 30;  // with the marks
  double alpha = 0.7;                // larger values favour longer sequences
};
struct BeamSearch {
  std::vector<Index> ids;                 // the answer, with the marks
  std::vector<std::vector<Index>> beams;  // (beams, max_length), padded
  std::vector<double> scores;             // sums of log probabilities
  std::vector<Index> lengths;             // up to the first end
  std::vector<std::size_t> order{};       // of the beams, the answer first
};

namespace detail {

/// Throws config_error 101 for invalid options.
void require_beams(const BeamOptions& o);
/// Continues all beams by the best symbols; p are the probabilities of the next symbol.
void continue_beams(BeamSearch& found, const std::vector<std::vector<double>>& p, const BeamOptions& o);
bool all_ended(const BeamSearch& found, const BeamOptions& o);
/// Computes lengths, order and answer.
void order_beams(BeamSearch& found, const BeamOptions& o);

}  // namespace detail

///     answer = arg max of score / length^alpha over the beams
/// Each beam is continued by its most probable symbols, and the best of all continuations are kept, until all have
/// ended. As published, beams that have ended are continued, too, and lose score.
/// next    takes 1 or `beams` beginnings of one length
/// Source  TM2T networks/translator.py translate_sentence; the length penalty of Wu et al. (2016) without its constants
/// Throws  config_error 101 for invalid options
template <class Next>
BeamSearch beam_search(Next&& next, const BeamOptions& o) {
  detail::require_beams(o);
  BeamSearch out{{}, {{o.begin}}, {0}, {}};
  for (Index length = 1; length < o.max_length; ++length) {
    detail::continue_beams(out, detail::next_probabilities(next(IdSequences::from(out.beams)), 0), o);
    // As published, the first step is not checked, so at least two symbols are written.
    if (length > 1 && detail::all_ended(out, o)) break;
  }
  detail::order_beams(out, o);
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/nn/decoding.ipp>
#endif
