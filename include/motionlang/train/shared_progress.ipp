// SPDX-License-Identifier: MIT
// Bodies of shared_progress.hpp.
#pragma once

#include <algorithm>  // max
#include <cmath>      // llround
#include <cstdint>    // counts
#include <utility>    // exchange, move

#include <motionlang/train/shared_progress.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A message of progress. `total` 0: the work is done.
struct ProgressCounts {
  std::int64_t done = 0, total = 0;
};

}  // namespace detail

MOTIONLANG_BODY SharedProgress::SharedProgress(const AnyCommunicator& all, std::vector<Index> work,
                                               const Progress& caller)
    : all_(all),
      work_(std::move(work)),
      caller_(caller),
      shares_(static_cast<std::size_t>(all.size())),
      finished_(static_cast<std::size_t>(all.size())) {
  if (std::ssize(work_) != all.size())
    raise<config_error>(102, "SharedProgress: the work of ", counted(work_.size(), "rank"), ", there are ", all.size());
}

MOTIONLANG_BODY bool SharedProgress::operator()(Index done, Index total) {
  if (all_.size() == 1) {
    caller_(done, total);
    return true;
  }
  if (all_.rank() > 0) {
    const detail::ProgressCounts own{done, std::max<Index>(1, total)};
    all_.send(std::as_bytes(std::span(&own, 1)), 0);
    return true;
  }
  shares_[0] = static_cast<double>(done) / static_cast<double>(std::max<Index>(1, total));
  receive_arrived();
  report();
  return true;
}

MOTIONLANG_BODY void SharedProgress::finish() {
  if (all_.size() == 1) return;
  if (all_.rank() > 0) {
    const detail::ProgressCounts end;
    all_.send(std::as_bytes(std::span(&end, 1)), 0);
    return;
  }
  shares_[0] = 1;
  while (true) {
    receive_arrived();
    report();
    std::size_t last = 0;  // the rank that is farthest behind
    for (std::size_t r = 1; r < shares_.size(); ++r) {
      if (!finished_[r] && (last == 0 || shares_[r] < shares_[last])) last = r;
    }
    if (last == 0) break;
    receive(last);
  }
}

MOTIONLANG_BODY void SharedProgress::receive(std::size_t rank) {
  detail::ProgressCounts counts;
  all_.receive(std::as_writable_bytes(std::span(&counts, 1)), static_cast<Index>(rank));
  finished_[rank] = counts.total == 0;
  shares_[rank] = counts.total == 0 ? 1 : static_cast<double>(counts.done) / static_cast<double>(counts.total);
}

MOTIONLANG_BODY void SharedProgress::receive_arrived() {
  for (std::size_t r = 1; r < shares_.size(); ++r) {
    while (!finished_[r] && all_.arrived(static_cast<Index>(r))) receive(r);
  }
}

MOTIONLANG_BODY void SharedProgress::report() {
  double done = 0;
  Index whole = 0;
  for (std::size_t r = 0; r < shares_.size(); ++r) {
    done += shares_[r] * static_cast<double>(work_[r]);
    whole += work_[r];
  }
  constexpr Index parts = 1000;
  const auto now = static_cast<Index>(std::llround(done * static_cast<double>(parts)));
  if (whole > 0 && std::exchange(reported_, now) != now) caller_(now, whole * parts);
}

MOTIONLANG_NAMESPACE_END
