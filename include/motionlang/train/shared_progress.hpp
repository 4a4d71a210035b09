// SPDX-License-Identifier: MIT
/// The progress of work that several processes share (train/communicator.hpp): rank 0 reports that of all.
///
///     SharedProgress progress(all, {3, 2}, caller);                     // rank 0 has three motions to make
///     use(generate_motions(*model, own_part, {.progress = progress}));  // in every process
///     progress.finish();
///
/// The others send their counts and do not wait. With each step of its own, rank 0 reports what has arrived from the
/// others until then, and does not wait for more. It waits for them at the end only, and reports their last steps.
#pragma once

#include <vector>  // shares

#include <motionlang/core/progress.hpp>
#include <motionlang/train/communicator.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class SharedProgress {
 public:
  /// work    of each rank, in any unit; 0 for a rank that has nothing to do
  /// caller  of rank 0 is called, with counts of thousandths; alone, it gets the counts themselves
  SharedProgress(const AnyCommunicator& all, std::vector<Index> work, const Progress& caller);

  /// A part of the own work is done. Throws `cancelled` in rank 0 if the caller wants it.
  bool operator()(Index done, Index total);
  /// All processes call it once, behind their work and before other messages. Rank 0 waits until all are done.
  void finish();

 private:
  /// Takes the next message of a rank, which it waits for.
  void receive(std::size_t rank);
  /// Takes the messages that have arrived.
  void receive_arrived();
  /// Calls the caller, unless it knows the counts.
  void report();

  AnyCommunicator all_;
  std::vector<Index> work_;
  Progress caller_;
  std::vector<double> shares_;  // of the work of each rank that is done, as far as rank 0 knows
  std::vector<bool> finished_;
  Index reported_ = -1;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/shared_progress.ipp>
#endif
