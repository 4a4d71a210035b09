// SPDX-License-Identifier: MIT
/// Parts of a batch that meet while they are computed, because a network normalises by the statistics of the whole
/// batch.
///
/// A part stops wherever the network asks for sums over the batch (core/batch_sums.hpp): in each batch norm, in the
/// forward pass and in the backward pass. Once all parts have come that far, their numbers are added in the tree of
/// train/batch_parts.hpp, and all go on. The parts of a process run in threads that take turns. So the sums, and all
/// that follows from them, have the same bits for any number of processes and threads.
///
/// Source   Zhang et al.: "Context encoding for semantic segmentation" (CVPR 2018), section 3: batch norm over devices
#pragma once

#include <algorithm>  // copy
#include <span>       // numbers
#include <utility>    // move
#include <vector>     // sums

#include <motionlang/core/batch_sums.hpp>
#include <motionlang/train/batch_parts.hpp>
#include <motionlang/train/communicator.hpp>
#include <motionlang/train/part_threads.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The tensors that no gradient changes, such as running statistics.
template <AutodiffBackend A>
std::vector<ModuleTensor<A>> untrained(std::vector<ModuleTensor<A>> tensors) {
  std::erase_if(tensors, detail::is_variable<A>);
  return tensors;
}
/// The values of rank 0, in all processes.
template <AutodiffBackend A>
void tensors_of_first(const AnyCommunicator& c, const std::vector<ModuleTensor<A>>& tensors) {
  for (const auto& t : tensors) {
    std::vector<typename A::scalar> values(t.span().begin(), t.span().end());
    numbers_of_first(c, values);
    A::mutable_value(*t.data) = A::inner::from_span(values, t.shape());
  }
}

/// The sum of what compute(i, sums) returns for the parts i = 0 ... parts - 1, in all processes, like sum_for_all. The
/// parts may meet by `sums`. All parts of a process are kept until their last meeting. Then they end one after another.
/// Throws  config_error 102 if parts of this process do not meet equally often; shape_error 204 if they meet with other
///         numbers of sums; what compute throws, after the end of the other parts of this process
template <Scalar S, class F>
std::vector<S> sum_of_meeting_parts(const AnyCommunicator& c, Index parts, PartThreads& threads, const F& compute,
                                    const SumMessages& how = {});

namespace detail {

/// A part of this process.
template <Scalar S>
class MeetingPart final : public BatchSums {
 public:
  MeetingPart(PartThreads& threads, Index number) : threads_(&threads), number_(number) {}

  void add(std::span<double> numbers) const override {
    numbers_ = numbers;
    threads_->pause(number_);
  }
  bool keeps_statistics() const override { return number_ == 0; }

  /// Runs until the next meeting, or until the end of the part, which returns false.
  bool meets() { return meeting_ = threads_->resume(number_); }
  /// Its numbers for the meeting, and the place of their sums.
  std::span<double> numbers() const { return numbers_; }
  /// Runs to the end.
  std::vector<S> finish() {
    if (meeting_) require(!meets());
    return std::move(result);
  }
  static void require(bool as_the_first) {
    if (!as_the_first) raise<config_error>(102, "a part of a batch waits for sums of parts that have ended");
  }

  std::vector<S> result{};

 private:
  PartThreads* threads_;
  Index number_;
  bool meeting_ = true;
  mutable std::span<double> numbers_{};
};

}  // namespace detail

template <Scalar S, class F>
std::vector<S> sum_of_meeting_parts(const AnyCommunicator& c, Index parts, PartThreads& threads, const F& compute,
                                    const SumMessages& how) {
  std::vector<detail::MeetingPart<S>> own;
  Index first = 0;
  for (Index i = 0; i < parts; ++i) {
    const Index rank = rank_of_part(i, parts, c.size());
    if (rank < c.rank()) first = i + 1;
    if (rank == c.rank()) own.emplace_back(threads, i - first);
  }
  const auto part = [&](Index i) -> auto& { return own[static_cast<std::size_t>(i - first)]; };
  struct Stop {
    PartThreads& threads;
    ~Stop() { threads.stop(); }
  } const at_end{threads};
  threads.begin(std::ssize(own), [&](Index k) { part(first + k).result = compute(first + k, part(first + k)); });
  for (;;) {
    bool meet = !own.empty() && own.front().meets();
    if (parts < c.size()) {  // some ranks have no parts
      const bool of_first = answer_of_first(c, meet);
      if (!own.empty()) own.front().require(of_first == meet);
      meet = of_first;
    }
    if (!meet) break;
    for (std::size_t k = 1; k < own.size(); ++k) own[k].require(own[k].meets());
    const auto sums = sum_for_all<double>(c, parts, [&](Index i) {
      const auto numbers = part(i).numbers();
      return std::vector<double>(numbers.begin(), numbers.end());
    });
    for (const auto& p : own) std::copy(sums.begin(), sums.end(), p.numbers().begin());
  }
  return sum_for_all<S>(
      c, parts, [&](Index i) { return part(i).finish(); }, how);
}

MOTIONLANG_NAMESPACE_END
