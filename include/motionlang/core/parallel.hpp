// SPDX-License-Identifier: MIT
/// A small pool of threads, `parallel_for`, the number of threads, and the rules for objects that threads share.
///
/// How many   processor_count() threads compute (core/processors.hpp: the limit of this process, also in a container),
///            at most 256. set_thread_count(n) changes that for the whole process. The results have the same bits
/// Objects and several threads of a program
///   may be shared    everything that is const: models, tensors, skeletons, indices, text encoders. Threads may
///                    copy and use handles of the same tensor. The pool serves one call at a time; other calls wait
///   may not          objects that change: a tensor that is assigned to, a generator that draws, an AdamW that steps, a
///                    KeptMotion that is filled. Give each thread its own, or a lock. A Context counts its masks, so
///                    each call needs its own
///   Autodiff         variables may be shared; operations behind a loss belong to the thread that calls `backward`
///   at rest          set_thread_count and set_product_precision (backend/precision.hpp): while no work is running
///
/// Work is split into tasks that never share a sum, and the result of a task does not depend on the thread. So one
/// thread and many give the same bits. Workers spin after a task (20,000 pauses: 0.2 to 1 millisecond, by the
/// processor) and then sleep. So the many short regions of a transformer layer cost well below a microsecond each (on
/// few cores), and an idle program costs nothing.
#pragma once

#include <algorithm>  // clamp

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Runs task(context, i) for i = 0 ... count-1 on all threads and returns when all are done.
void run_tasks(Index count, void (*task)(const void*, Index), const void* context);

}  // namespace detail

/// Threads that `parallel_for` uses, the caller included: processor_count(), at most 256, unless set.
int thread_count();

/// Threads that `parallel_for` uses here: one inside a task.
int parallel_width();

/// Number of the thread that runs a task of `parallel_for`: 0 ... thread_count()-1. Tasks that run at the same time
/// have different numbers.
int thread_number();

/// Changes the number of threads for the whole process. Do not call it while work is running. Throws config_error 101.
void set_thread_count(int threads);

/// Calls f(i) for i = 0 ... count-1, in any order, on all threads. f must not depend on the order. Exceptions reach the
/// caller (the first one). Inside a task it runs serially.
template <class F>
void parallel_for(Index count, const F& f) {
  if (count <= 0) return;
  detail::run_tasks(
      count, [](const void* g, Index i) { (*static_cast<const F*>(g))(i); }, &f);
}

namespace detail {
inline constexpr Index worth_a_thread = 16384;  // values
}

/// Calls f(first, last) for pieces of 0 ... count-1. Work that is too small for two threads is one piece (`cost` values
/// per element). For large elements, such as rows, every thread gets the same share in each region, which is then still
/// in its cache. Pieces of single values begin at the same places for any number of threads, so full vectors and
/// remainders are the same.
template <class F>
void parallel_ranges(Index count, Index cost, const F& f) {
  const Index grain = std::max<Index>(1, detail::worth_a_thread / std::max<Index>(1, cost));
  const Index pieces = (count + grain - 1) / grain, threads = parallel_width();
  if (cost < 64 || pieces <= 1 || threads == 1)
    return parallel_for(pieces, [&](Index i) { f(i * grain, std::min(count, (i + 1) * grain)); });
  const Index equal = std::min(count, (pieces + threads - 1) / threads * threads);
  parallel_for(equal, [&](Index i) { f(count * i / equal, count * (i + 1) / equal); });
}

/// Calls f(first, last) for pieces of the columns 0 ... width-1 of a matrix with this many rows. It is for functions
/// that go through the rows in their order. Pieces begin at multiples of 16, so that whole vectors are the same for any
/// number of threads.
template <class F>
void parallel_columns(Index rows, Index width, const F& f) {
  const Index pieces = rows * width < detail::worth_a_thread ? 1 : std::clamp<Index>(width / 64, 1, parallel_width());
  const auto begin = [&](Index i) { return i == pieces ? width : width * i / pieces / 16 * 16; };
  parallel_for(pieces, [&](Index i) { f(begin(i), begin(i + 1)); });
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/parallel.ipp>
#endif
