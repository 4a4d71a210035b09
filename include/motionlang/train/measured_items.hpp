// SPDX-License-Identifier: MIT
/// Items of BABEL, some of which are measured. The training motions are used for blind guesses.
///
///     MeasuredItems items({.data = "amass", .babel = "val.json"}, "smplvelp", "all", split_config(c), sinc_reader(c));
///     items.choose([](const DescribedMotion& m) { return m.texts.size() == 2; });
///     for (const Index i : items.measured()) use(items[i].rows, items[i].texts);
#pragma once

#include <filesystem>   // list of ids
#include <functional>   // which are wanted
#include <set>          // pairs of labels
#include <string>       // parts
#include <string_view>  // features
#include <vector>       // items

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/babel_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class MeasuredItems {
 public:
  /// features  that the model reads
  /// part      training, validation or test; "all": no split, and all items count for training as well
  /// reader    is called for the items of evaluations, in all parts
  /// Throws    what read_babel_motions throws; config_error 103 for an unknown part
  MeasuredItems(const BabelSources& sources, std::string_view features, const std::string& part, DataConfig split,
                const BabelReader& reader, Progress progress = {});

  /// Chooses the items to measure: the wanted ones in the list, or all wanted ones without a list. Throws config_error
  /// 101 if there are none, and io_error 401, 403 for the list.
  void choose(const std::function<bool(const DescribedMotion&)>& wanted, const std::filesystem::path& keys = {});

  const DescribedMotions& data() const { return data_; }
  /// The chosen items: their numbers, and the items themselves.
  const std::vector<Index>& measured() const { return measured_; }
  std::vector<const DescribedMotion*> chosen() const;
  const DescribedMotion& operator[](Index i) const { return data_.part(part_)[static_cast<std::size_t>(i)]; }
  /// The number of the k-th chosen item among the training items; -1 if it is not one.
  Index number_in_training(Index k) const { return part_ == "training" ? measured_[static_cast<std::size_t>(k)] : -1; }
  /// "2 motions of val.json, of 3 keys"
  const std::string& description() const { return description_; }

 private:
  DescribedMotions data_;
  std::string part_, name_, description_;
  std::vector<Index> measured_;
};

/// Finds the items that the published evaluation of SINC keeps: pairs of labels that training lacks in any order,
/// without "stand".
/// Source  thesis B.3.1
class UnseenPairs {
 public:
  explicit UnseenPairs(const std::vector<DescribedMotion>& training);
  bool has(const DescribedMotion& item) const;

 private:
  std::set<std::multiset<std::string>> seen_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/measured_items.ipp>
#endif
