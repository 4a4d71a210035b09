// SPDX-License-Identifier: MIT
// Bodies of shared_items.hpp.
#pragma once

#include <motionlang/train/shared_items.hpp>
#include <motionlang/train/shared_progress.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> shared_items(
    const AnyCommunicator& all, Index count,
    const std::function<std::string(Index item, const Progress& of_item)>& compute, const Progress& progress) {
  std::vector<Index> work(static_cast<std::size_t>(all.size()));
  for (Index i = 0; i < count; ++i) ++work[static_cast<std::size_t>(rank_of_item(i, all.size()))];
  const Index own = work[static_cast<std::size_t>(all.rank())];
  SharedProgress of_all(all, std::move(work), progress);
  constexpr Index parts = 1000;  // of an item
  Index done = 0;
  MessageWriter mine;
  for (Index i = 0; i < count; ++i) {
    if (rank_of_item(i, all.size()) != all.rank()) continue;
    const auto of_item = [&](Index part, Index total) {
      return of_all(parts * done + parts * part / total, parts * own);
    };
    mine.text(compute(i, of_item));
    of_all(parts * ++done, parts * own);
  }
  of_all.finish();
  const std::vector<std::string> messages = messages_of_all(all, mine.bytes());
  std::vector<MessageReader> readers(messages.begin(), messages.end());
  std::vector<std::string> out;
  for (Index i = 0; i < count; ++i)
    out.push_back(readers[static_cast<std::size_t>(rank_of_item(i, all.size()))].text());
  return out;
}

MOTIONLANG_BODY std::string named_numbers(const std::map<std::string, double>& numbers) {
  MessageWriter out;
  for (const auto& [name, number] : numbers) out.text(name), out.value(number);
  return out.bytes();
}
MOTIONLANG_BODY void add_named_numbers(std::map<std::string, std::vector<double>>& lists, const std::string& message) {
  for (MessageReader in(message); !in.at_end();) {
    const std::string name = in.text();
    lists[name].push_back(in.value<double>());
  }
}

MOTIONLANG_NAMESPACE_END
