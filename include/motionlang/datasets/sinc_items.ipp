// SPDX-License-Identifier: MIT
// Bodies of sinc_items.hpp.
#pragma once

#include <utility>  // move

#include <motionlang/datasets/sinc_items.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SincItems::SincItems(std::vector<SincItem> items, const BodyPartTable& table)
    : items_(std::move(items)), table_(&table) {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const SincItem& item = items_[i];
    if (item.labels.empty()) raise<config_error>(101, "SincItems: item ", i, " has no label");
    if (is_single(item)) singles_[item.labels.front()].push_back(static_cast<Index>(i));
    if (item.source != SincSource::simultaneous) not_simultaneous_.push_back(static_cast<Index>(i));
  }
}

MOTIONLANG_BODY std::vector<Index> SincItems::partners(Index k) const {
  const SincParts& own = table_->parts(at(k).labels.front());
  std::vector<Index> out;
  for (const std::string& label : table_->labels()) {
    const auto found = singles_.find(label);
    if (found == singles_.end() || !are_compatible(own, table_->parts(label))) continue;
    out.insert(out.end(), found->second.begin(), found->second.end());
  }
  return out;
}

MOTIONLANG_BODY const SincItem& SincItems::at(Index k) const {
  if (k < 0 || k >= std::ssize(items_)) raise<config_error>(101, "SincItems: no item ", k, " of ", items_.size());
  return items_[static_cast<std::size_t>(k)];
}

MOTIONLANG_NAMESPACE_END
