// SPDX-License-Identifier: MIT
/// The progress of work that several processes share (train/communicator.hpp): rank 0 reports that of all.
///
///     SharedProgress progress(all, {3, 2}, caller);                     // rank 0 has three motions to make
///     use(generate_motions(*model, own_part, {.progress = progress}));  // in every process
///     progress.finish();
///
/// The others send their counts and do not wait. Rank 0 waits, before it reports a step, until each other rank has done
/// the share of its own work that rank 0 had done before the step. So rank 0 is at most a step ahead of the slowest
/// one. The last motion of the slowest process is the end of the bar.
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
  /// The next share that a rank sends.
  double received(std::size_t rank);
  /// A rank has done this share of its work; reported if it is another one than before.
  void note(std::size_t rank, double share);
  void report() const;

  AnyCommunicator all_;
  std::vector<Index> work_;
  Progress caller_;
  std::vector<double> shares_;  // of the work of each rank that is done, as far as rank 0 knows
  std::vector<bool> finished_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/shared_progress.ipp>
#endif
