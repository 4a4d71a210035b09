// SPDX-License-Identifier: MIT
/// Threads: a small pool of them and `parallel_for`, how many are used, and what threads of a program may share.
///
/// How many   processor_count() threads calculate (core/processors.hpp: what the process is given, in a container too),
///            at most 256. set_thread_count(n) changes that for the whole process. The results are the same bits
/// From several threads of a program at once
///   may be shared    everything that is const: models, tensors, skeletons, indices, text encoders. Copying a handle of
///                    the same tensor, and using it, too. One call calculates in the pool at a time, others wait for it
///   may not          what is written: a tensor that is assigned to, a generator that draws, an AdamW that steps, a
///                    KeptMotion that is filled. Give each thread its own, or a lock. A Context counts its masks: one
///                    for each call
///   Autodiff         variables may be shared; operations behind a loss belong to the thread that calls `backward`
///   at rest          set_thread_count and set_product_precision (backend/precision.hpp): while no work is running
///
/// Work is split into tasks that never share a sum, and the result of a task does not depend on who runs it: one thread
/// and many give the same bits. Workers spin after a task (20,000 pauses: 0.2 to 1 millisecond, by the processor) and
/// then sleep, so that the many short regions of a transformer layer cost well below a microsecond each (on few cores)
/// while an idle program costs nothing.
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

/// Number of the thread that runs a task of `parallel_for`: 0 ... thread_count()-1, different for those that run at
/// once.
int thread_number();

/// Changes the number of threads for the whole process. Not while work is running. Throws config_error 101.
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
inline constexpr Index worth_a_thread = 16384;  // numbers
}

/// Calls f(first, last) for pieces of 0 ... count-1, in one piece what is not worth two threads (`cost` numbers per
/// element). Of elements of many numbers, such as rows, every thread has as many: in the next region it finds what it
/// wrote in its cache. Pieces of single numbers begin at the same places for any number of threads: vectors and what is
/// left beside them are the same.
template <class F>
void parallel_ranges(Index count, Index cost, const F& f) {
  const Index grain = std::max<Index>(1, detail::worth_a_thread / std::max<Index>(1, cost));
  const Index pieces = (count + grain - 1) / grain, threads = parallel_width();
  if (cost < 64 || pieces <= 1 || threads == 1)
    return parallel_for(pieces, [&](Index i) { f(i * grain, std::min(count, (i + 1) * grain)); });
  const Index equal = std::min(count, (pieces + threads - 1) / threads * threads);
  parallel_for(equal, [&](Index i) { f(count * i / equal, count * (i + 1) / equal); });
}

/// Calls f(first, last) for pieces of the columns 0 ... width-1 of a matrix of this many rows: for what goes through
/// the rows in their order. Pieces begin at multiples of 16, so that whole vectors are the same for any number of
/// threads.
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
