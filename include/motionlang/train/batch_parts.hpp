// SPDX-License-Identifier: MIT
/// Parts of a batch, whose gradients several processes compute, and their sum in an order that does not depend on the
/// number of processes.
///
/// Parts have a fixed number of samples, the last one perhaps fewer. They are the leaves of a binary tree, and a node
/// is the sum of its two halves:
///     ((0 + 1) + (2 + 3)) + ((4 + 5) + 6)
/// Each rank computes parts that follow each other. `sum_of_parts`: the rank of the first leaf of a node adds what the
/// rank of its second half sends. `sum_for_all`: if the numbers of parts and ranks are powers of two, the ranks of both
/// halves of a node each add half of the numbers, in the same tree. A rank then sends less than twice the sum, however
/// many ranks there are, while rank 0 would take one sum in each of log2(ranks) rounds.
///
/// Source   R. Rabenseifner: "Optimization of collective reduction operations" (2004), for `sum_for_all`: recursive
///          halving and doubling
#pragma once

#include <algorithm>  // clamp, count_if, min
#include <bit>        // powers of two
#include <cstdint>    // sizes of messages
#include <cstring>    // memcpy
#include <span>       // messages
#include <utility>    // move
#include <vector>     // sums

#include <motionlang/core/half.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/module.hpp>
#include <motionlang/tensor/sequences.hpp>
#include <motionlang/train/communicator.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Samples first ... last - 1 of a batch.
struct BatchPart {
  Index first = 0, last = 0;

  Index count() const { return last - first; }
  /// These samples of a list of all.
  template <class T>
  std::span<const T> of(const std::vector<T>& all) const {
    return std::span(all).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count()));
  }
  /// Their share of all samples of the batch.
  double share(Index samples) const { return static_cast<double>(count()) / static_cast<double>(samples); }
  /// Their share in the sum of numbers of which each sample of the batch has one.
  double share(std::span<const Index> numbers) const;
};

/// The number of parts with `size` samples each.
inline Index part_count(Index samples, Index size) { return samples / size + (samples % size != 0 ? 1 : 0); }
/// Part number i.
inline BatchPart batch_part(Index i, Index samples, Index size) {
  return {i * size, std::min(samples, (i + 1) * size)};
}
/// The rank that computes part i. Ranks have equal numbers of parts, or one more than others; rank 0 has part 0.
inline Index rank_of_part(Index i, Index parts, Index ranks) { return i * ranks / parts; }

/// A loss with other weights: those of a part, for means over the samples of the part.
template <Backend B>
LossTerms<B> weighted(LossTerms<B> terms, double weight) {
  for (auto& t : terms.terms) t.weight *= weight;
  return terms;
}

/// The sequences of a part of a batch, and the rows of the batch before them.
template <Backend B>
Sequences<B> part_of(const Sequences<B>& batch, const BatchPart& part) {
  if (part.count() == batch.count()) return batch;
  std::vector<Index> lengths;
  for (Index s = part.first; s < part.last; ++s) lengths.push_back(batch.offsets.length(s));
  return {slice(batch.rows, 0, batch.offsets.begin(part.first), batch.offsets.begin(part.last)), Offsets(lengths)};
}

/// Rows first ... first + rows - 1 of the matrix of `width` columns that `rng` draws: the numbers of the whole batch,
/// without those of other samples.
template <Backend B>
Tensor<B, 2> normal_rows(Index first, Index rows, Index width, Philox rng) {
  std::vector<typename B::scalar> values(static_cast<std::size_t>(rows * width));
  rng.normal(std::span(values), static_cast<std::uint64_t>(first * width));
  return Tensor<B, 2>::from(values, {rows, width});
}

/// How sums are written into messages: exactly, or rounded to bfloat16, which is half as long as float. Rounded sums
/// depend on the number of processes. `compute` may set `exact`.
struct SumMessages {
  bool bf16 = false;
  std::size_t exact = 0;  // as many numbers at the front are never rounded
};

/// The sum of what compute(i) returns for the parts i = 0 ... parts - 1, vectors of one size. Rank 0 has it; others get
/// a part of it or nothing. compute is called in each process for its own parts. Throws shape_error 204 if the sizes of
/// vectors differ, in a process that adds them.
template <Scalar S, class F>
std::vector<S> sum_of_parts(const AnyCommunicator& c, Index parts, const F& compute, const SumMessages& how = {});
/// The same sum, with the same bits, in all processes.
template <Scalar S, class F>
std::vector<S> sum_for_all(const AnyCommunicator& c, Index parts, const F& compute, const SumMessages& how = {});

/// All gradients as one list: for each parameter 1 if the loss depends on it and 0 if not, then the gradients in the
/// order of the parameters, with zeros where there are none.
template <AutodiffBackend A>
void append_gradients(std::vector<typename A::scalar>& out, const std::vector<ModuleTensor<A>>& parameters,
                      const Gradients<A>& gradients);
/// Adds gradients to such a list.
template <AutodiffBackend A>
void add_gradients(std::span<typename A::scalar> list, const std::vector<ModuleTensor<A>>& parameters,
                   const Gradients<A>& gradients);
/// The length of such a list.
template <AutodiffBackend A>
std::size_t gradient_list_size(const std::vector<ModuleTensor<A>>& parameters);
/// The gradients in such a list, or in a sum of some. Parameters on which no loss depends have none. Throws shape_error
/// 205 for a list of another length.
template <AutodiffBackend A>
Gradients<A> listed_gradients(std::span<const typename A::scalar> list, const std::vector<ModuleTensor<A>>& parameters);

namespace detail {

/// Numbers first ... last - 1 of a sum on their way.
template <Scalar S>
class SumPart {
 public:
  SumPart(const SumMessages& how, std::size_t first, std::size_t last)
      : first_(first), last_(last), whole_(how.bf16 ? std::clamp(how.exact, first, last) : last) {}

  std::size_t bytes() const { return (whole_ - first_) * sizeof(S) + (last_ - whole_) * sizeof(std::uint16_t); }
  bool exact() const { return whole_ == last_; }
  /// The bytes to send: these numbers of the sum themselves if none is rounded, else a message that `room` holds.
  std::span<const std::byte> given(std::span<const S> sum, std::vector<std::byte>& room) const {
    if (exact()) return std::as_bytes(own(sum));
    return room = message(sum);
  }
  /// The place where they arrive: the sum itself if none is rounded, else `room`. Then call `store`.
  std::span<std::byte> place(std::span<S> sum, std::vector<std::byte>& room) const {
    if (exact()) return std::as_writable_bytes(own(sum));
    room.resize(bytes());
    return room;
  }
  void store(std::span<S> sum, std::span<const std::byte> room) const {
    if (!exact()) read(room, [&](std::size_t i, S number) { sum[i] = number; });
  }
  std::vector<std::byte> message(std::span<const S> sum) const {
    std::vector<std::byte> out(bytes());
    std::byte* at = out.data();
    if (whole_ > first_) std::memcpy(at, sum.data() + first_, (whole_ - first_) * sizeof(S));
    at += (whole_ - first_) * sizeof(S);
    for (std::size_t i = whole_; i < last_; ++i, at += sizeof(std::uint16_t)) {
      const std::uint16_t rounded = float_to_bfloat16(static_cast<float>(sum[i]));
      std::memcpy(at, &rounded, sizeof rounded);
    }
    return out;
  }
  /// Calls f(i, number) for each.
  template <class F>
  void read(std::span<const std::byte> message, const F& f) const {
    const std::byte* at = message.data();
    for (std::size_t i = first_; i < whole_; ++i, at += sizeof(S)) {
      S number;
      std::memcpy(&number, at, sizeof number);
      f(i, number);
    }
    for (std::size_t i = whole_; i < last_; ++i, at += sizeof(std::uint16_t)) {
      std::uint16_t rounded = 0;
      std::memcpy(&rounded, at, sizeof rounded);
      f(i, static_cast<S>(bfloat16_to_float(rounded)));
    }
  }
  /// Rounds the sum itself to what a reader of the message has.
  void round(std::span<S> sum) const {
    for (std::size_t i = whole_; i < last_; ++i)
      sum[i] = static_cast<S>(bfloat16_to_float(float_to_bfloat16(static_cast<float>(sum[i]))));
  }

 private:
  template <class T>
  std::span<T> own(std::span<T> sum) const {
    return sum.subspan(first_, last_ - first_);
  }

  std::size_t first_, last_, whole_;
};

template <Scalar S, class F>
struct PartSums {
  const AnyCommunicator& communicator;
  Index parts;
  const F& compute;
  const SumMessages& how;

  /// The sum of parts first ... first + width - 1, as far as there are any, on the rank of the first one.
  std::vector<S> operator()(Index first, Index width) const {
    const Index here = communicator.rank(), to = rank_of_part(first, parts, communicator.size());
    if (width == 1) return here == to ? compute(first) : std::vector<S>();
    const Index middle = first + width / 2;
    std::vector<S> sum = (*this)(first, width / 2);
    if (middle >= parts) return sum;
    std::vector<S> other = (*this)(middle, width / 2);
    const Index from = rank_of_part(middle, parts, communicator.size());
    std::vector<std::byte> room;
    if (here == from && from != to) communicator.send(SumPart<S>(how, 0, other.size()).given(other, room), to);
    if (here != to) return {};
    if (from != to) {
      const SumPart<S> part(how, 0, sum.size());
      other.resize(sum.size());
      communicator.receive(part.place(other, room), from);
      part.store(other, room);
    }
    if (other.size() != sum.size())
      raise<shape_error>(204, "sum_of_parts: ", sum.size(), " values beside ", other.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += other[i];
    return sum;
  }
};

template <AutodiffBackend A>
bool is_variable(const ModuleTensor<A>& t) {
  return t.data->node != nullptr && t.data->node->variable;
}

/// The sum of rank 0 in all processes, which need not know its size.
template <Scalar S>
void sum_of_first(const AnyCommunicator& c, std::vector<S>& sum, const SumMessages& how) {
  std::uint64_t sizes[] = {sum.size(), how.exact};
  c.broadcast(std::as_writable_bytes(std::span(sizes)), 0);
  const auto size = static_cast<std::size_t>(sizes[0]);
  const SumPart<S> whole({.bf16 = how.bf16, .exact = static_cast<std::size_t>(sizes[1])}, 0, size);
  sum.resize(size);
  std::vector<std::byte> room;
  if (c.rank() == 0) whole.given(sum, room);
  c.broadcast(whole.place(sum, room), 0);
  whole.store(sum, room);
}

/// Adds the sums of all ranks, whose number is a power of two. In round d = 1, 2, 4, ... the ranks r and r ^ d have the
/// same block of numbers, and each goes on with the sums of one half of it. Then the halves come together again.
template <Scalar S>
void add_halves(const AnyCommunicator& c, std::vector<S>& sum, const SumMessages& how) {
  struct Block {
    std::size_t first, last;
  };
  Block own{0, sum.size()};
  std::vector<Block> others;  // the halves that partners go on with
  for (Index d = 1; d < c.size(); d *= 2) {
    const std::size_t middle = own.first + (own.last - own.first) / 2;
    Block other{middle, own.last};
    own.last = middle;
    if ((c.rank() & d) != 0) std::swap(own, other);
    const SumPart<S> given(how, other.first, other.last), taken(how, own.first, own.last);
    std::vector<std::byte> room, message(taken.bytes());
    c.exchange(given.given(sum, room), message, c.rank() ^ d);
    taken.read(message, [&](std::size_t i, S number) { sum[i] += number; });
    others.push_back(other);
  }
  SumPart<S>(how, own.first, own.last).round(sum);
  for (Index d = c.size() / 2; d > 0; d /= 2) {
    const Block other = others.back();
    others.pop_back();
    const SumPart<S> given(how, own.first, own.last), taken(how, other.first, other.last);
    std::vector<std::byte> out, in;
    c.exchange(given.given(sum, out), taken.place(sum, in), c.rank() ^ d);
    taken.store(sum, in);
    own = {std::min(own.first, other.first), std::max(own.last, other.last)};
  }
}

}  // namespace detail

template <Scalar S, class F>
std::vector<S> sum_of_parts(const AnyCommunicator& c, Index parts, const F& compute, const SumMessages& how) {
  Index width = 1;
  while (width < parts) width *= 2;
  return detail::PartSums<S, F>{c, parts, compute, how}(0, width);
}

template <Scalar S, class F>
std::vector<S> sum_for_all(const AnyCommunicator& c, Index parts, const F& compute, const SumMessages& how) {
  const auto is_power = [](Index n) { return std::has_single_bit(static_cast<std::uint64_t>(n)); };
  if (c.size() == 1) return sum_of_parts<S>(c, parts, compute, how);
  if (parts < c.size() || !is_power(parts) || !is_power(c.size())) {
    auto sum = sum_of_parts<S>(c, parts, compute, how);
    detail::sum_of_first(c, sum, how);
    return sum;
  }
  const Index own = parts / c.size(), first = c.rank() * own;
  const auto own_part = [&](Index i) { return compute(first + i); };
  auto sum = sum_of_parts<S>(AnyCommunicator(), own, own_part);
  detail::add_halves(c, sum, how);
  return sum;
}

template <AutodiffBackend A>
void append_gradients(std::vector<typename A::scalar>& out, const std::vector<ModuleTensor<A>>& parameters,
                      const Gradients<A>& gradients) {
  using S = typename A::scalar;
  out.reserve(out.size() + gradient_list_size<A>(parameters));
  for (const auto& t : parameters) {
    if (detail::is_variable<A>(t)) out.push_back(gradients.find(*t.data) == nullptr ? S(0) : S(1));
  }
  for (const auto& t : parameters) {
    if (!detail::is_variable<A>(t)) continue;
    if (const auto* g = gradients.find(*t.data)) {
      const auto values = A::inner::to_span(*g);
      out.insert(out.end(), values.begin(), values.end());
    } else {
      out.resize(out.size() + static_cast<std::size_t>(t.shape().count()));
    }
  }
}

template <AutodiffBackend A>
void add_gradients(std::span<typename A::scalar> list, const std::vector<ModuleTensor<A>>& parameters,
                   const Gradients<A>& gradients) {
  std::size_t reached = 0;
  auto at = static_cast<std::size_t>(std::count_if(parameters.begin(), parameters.end(), detail::is_variable<A>));
  for (const auto& t : parameters) {
    if (!detail::is_variable<A>(t)) continue;
    if (const auto* g = gradients.find(*t.data)) {
      list[reached] += 1;
      const auto values = A::inner::to_span(*g);
      for (std::size_t i = 0; i < values.size(); ++i) list[at + i] += values[i];
    }
    ++reached, at += static_cast<std::size_t>(t.shape().count());
  }
}

template <AutodiffBackend A>
std::size_t gradient_list_size(const std::vector<ModuleTensor<A>>& parameters) {
  std::size_t size = 0;
  for (const auto& t : parameters) {
    if (detail::is_variable<A>(t)) size += 1 + static_cast<std::size_t>(t.shape().count());
  }
  return size;
}

template <AutodiffBackend A>
Gradients<A> listed_gradients(std::span<const typename A::scalar> list,
                              const std::vector<ModuleTensor<A>>& parameters) {
  if (const std::size_t size = gradient_list_size<A>(parameters); list.size() != size)
    raise<shape_error>(205, "listed_gradients: ", list.size(), " numbers, the parameters need ", size);
  const auto variables = std::count_if(parameters.begin(), parameters.end(), detail::is_variable<A>);
  auto reached = list.first(static_cast<std::size_t>(variables)), values = list.subspan(reached.size());
  typename A::GradientMap out;
  for (const auto& t : parameters) {
    if (!detail::is_variable<A>(t)) continue;
    const auto count = static_cast<std::size_t>(t.shape().count());
    if (reached.front() > 0) out.emplace(t.data->node.get(), A::inner::from_span(values.first(count), t.shape()));
    reached = reached.subspan(1), values = values.subspan(count);
  }
  return Gradients<A>(std::move(out));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/batch_parts.ipp>
#endif
