// SPDX-License-Identifier: MIT
// Bodies of measured_items.hpp.
#pragma once

#include <motionlang/file/id_list.hpp>
#include <motionlang/train/measured_items.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY MeasuredItems::MeasuredItems(const BabelSources& sources, std::string_view features,
                                             const std::string& part, DataConfig split, const BabelReader& reader,
                                             Progress progress)
    : part_(part == "all" ? "training" : part),
      name_(part == "all" ? sources.babel.string() : "the " + part + " part") {
  if (part == "all") split.test_share = split.validation_share = 0;
  data_ = read_babel_motions(
      sources, std::string(features), split,
      [&](const BabelSequence& s, Index frames, const SpellingTable& spelling, bool) {
        return reader(s, frames, spelling, false);
      },
      progress);
  data_.part(part_);  // throws for an unknown part
}

MOTIONLANG_BODY void MeasuredItems::choose(const std::function<bool(const DescribedMotion&)>& wanted,
                                           const std::filesystem::path& keys) {
  std::set<std::string> named;
  if (!keys.empty()) {
    const auto ids = read_ids(keys);
    named = {ids.begin(), ids.end()};
  }
  measured_.clear();
  for (Index i = 0; i < std::ssize(data_.part(part_)); ++i) {
    const DescribedMotion& m = (*this)[i];
    if (wanted(m) && (keys.empty() || named.contains(m.id))) measured_.push_back(i);
  }
  const std::string of_keys = keys.empty() ? "" : ", of " + counted(named.size(), "key");
  if (measured_.empty()) raise<config_error>(101, name_, " has no motions to measure", of_keys);
  description_ = counted(measured_.size(), "motion") + " of " + name_ + of_keys;
}

MOTIONLANG_BODY std::vector<const DescribedMotion*> MeasuredItems::chosen() const {
  std::vector<const DescribedMotion*> out;
  for (const Index i : measured_) out.push_back(&(*this)[i]);
  return out;
}

namespace detail {

inline std::multiset<std::string> label_pair(const DescribedMotion& m) {
  const auto labels = labels_of(m);
  return {labels.begin(), labels.end()};
}

}  // namespace detail

MOTIONLANG_BODY UnseenPairs::UnseenPairs(const std::vector<DescribedMotion>& training) {
  for (const DescribedMotion& m : training) seen_.insert(detail::label_pair(m));
}
MOTIONLANG_BODY bool UnseenPairs::has(const DescribedMotion& item) const {
  const auto pair = detail::label_pair(item);
  return !pair.contains("stand") && !seen_.contains(pair);
}

MOTIONLANG_NAMESPACE_END
