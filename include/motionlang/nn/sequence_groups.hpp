// SPDX-License-Identifier: MIT
/// Runs a few sequences of a batch at a time through a whole stack of layers, every thread with its own sequences.
#pragma once

#include <algorithm>  // min_element, max_element, copy
#include <span>       // numbers of sequences
#include <utility>    // move

#include <motionlang/core/context.hpp>
#include <motionlang/core/error.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/sort.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The assignment of the first sequences to threads: the thread of each.
using SequenceShares = PoolVector<Index>;
/// Each sequence goes to the thread with the fewest rows so far. Takes as many sequences as give equal shares: no
/// thread has a twentieth more than the mean. The mean is at least 128 rows, from which on it pays to read all weights
/// in every thread. None if there is no such number.
SequenceShares share_sequences(const Offsets& offsets, std::span<const Index> order, Index threads);

/// All sequences, the longest first, which makes shares more equal.
PoolVector<Index> longest_first(const Offsets& offsets);

/// The first sequences with at most this many rows together, but at least one. There must be one.
std::span<const Index> first_group(const Offsets& offsets, std::span<const Index> order, Index rows);

/// Calls put(group) for the sequences of each thread, in groups of at most this many rows. All threads run at once.
template <class F>
void put_shares(const Offsets& offsets, std::span<const Index> order, const SequenceShares& thread_of, Index threads,
                Index rows, const F& put) {
  const auto modules = ModulePath::steps();  // a copy: this thread enters modules itself
  parallel_for(threads, [&](Index thread) {
    const ModulePath::Continued path(modules);
    PoolVector<Index> mine;
    for (std::size_t i = 0; i < thread_of.size(); ++i) {
      if (thread_of[i] == thread) mine.push_back(order[i]);
    }
    for (std::span<const Index> left(mine), group; !left.empty(); left = left.subspan(group.size())) {
      group = first_group(offsets, left, rows);
      put(group);
    }
  });
}

/// The rows f(which) of the sequences `which` (a span of their numbers), where each has the rows `results` of `width`
/// values. f treats each sequence on its own, so it can be called for a few at a time, with at most B::rows_in_cache()
/// rows (a longer one alone). Then the output of one layer is still in the cache when the next reads it. Threads that
/// can share the sequences evenly run through the layers without waiting for each other. They do the rest together. The
/// results are those of all sequences at once. If the backend has no such function, gradients are kept or dropout
/// counts rows, f is called for all at once. Weights that were not prepared are packed for every group.
template <Backend B, class F>
Tensor<B, 2> in_groups(const Offsets& offsets, const Offsets& results, Index width, const Context& context, F f) {
  const auto whole = [&] {
    PoolVector<Index> all;
    for (Index s = 0; s < offsets.count(); ++s) all.push_back(s);
    return f(std::span<const Index>(all));
  };
  if constexpr (requires { B::rows_in_cache(); }) {
    const Index threads = parallel_width(), at_once = B::rows_in_cache();
    const PoolVector<Index> order = longest_first(offsets);
    const bool grouped = offsets.rows() > at_once || !share_sequences(offsets, order, threads).empty();
    if (grouped && !context.dropout) {
      typename B::tensor y(Shape{results.rows(), width});
      const auto put = [&, out = y.data()](std::span<const Index> which) {
        const auto rows = f(which);
        const auto* from = rows.span().data();
        for (Index s : which) {
          const Index n = results.length(s) * width;
          std::copy(from, from + n, out + results.begin(s) * width);
          from += n;
        }
      };
      for (std::span<const Index> left(order); !left.empty();) {
        const SequenceShares shares = share_sequences(offsets, left, threads);
        const auto next = shares.empty() ? first_group(offsets, left, at_once) : left.first(shares.size());
        if (shares.empty())
          put(next);
        else
          put_shares(offsets, next, shares, threads, at_once / threads, put);
        left = left.subspan(next.size());
      }
      return Tensor<B, 2>(std::move(y));
    }
    return whole();
  }
  return whole();
}
/// The same with f(some), where `some` are these sequences of x, and results are as wide as x.
template <Backend B, class F>
Tensor<B, 2> in_groups(const Sequences<B>& x, const Offsets& results, const Context& context, F f) {
  const auto some = [&](std::span<const Index> which) { return f(some_sequences(x, which)); };
  return in_groups<B>(x.offsets, results, x.width(), context, some);
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/nn/sequence_groups.ipp>
#endif
