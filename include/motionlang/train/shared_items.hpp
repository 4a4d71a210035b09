// SPDX-License-Identifier: MIT
/// Items of a list that several processes share (train/communicator.hpp): each computes some, and all get what was
/// computed for all of them, in the order of the list. It is what one process computes.
///
///     const auto errors = shared_items(all, count, [&](Index i, const Progress&) {
///       MessageWriter out;
///       out.value(error_of(i));
///       return out.bytes();
///     });
///     for (const std::string& message : errors) use(MessageReader(message).value<double>());
#pragma once

#include <functional>  // what is computed
#include <map>         // named numbers
#include <string>      // messages
#include <vector>      // messages

#include <motionlang/core/progress.hpp>
#include <motionlang/train/messages.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The process of an item. Neighbours have different ones, so that long lists of similar items are shared evenly.
inline Index rank_of_item(Index i, Index ranks) { return i % ranks; }

/// compute   is called for the items of this process; it may report its progress in an item
/// progress  counts thousandths of items, of all processes
std::vector<std::string> shared_items(const AnyCommunicator& all, Index count,
                                      const std::function<std::string(Index item, const Progress& of_item)>& compute,
                                      const Progress& progress = {});

/// Numbers with names as a message, and a further one in each list of numbers with its name.
std::string named_numbers(const std::map<std::string, double>& numbers);
void add_named_numbers(std::map<std::string, std::vector<double>>& lists, const std::string& message);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/shared_items.ipp>
#endif
