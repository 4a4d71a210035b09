// SPDX-License-Identifier: MIT
// Bodies of tm2t_tokenizer_training.hpp.
#pragma once

#include <algorithm>  // max_element

#include <motionlang/features/guoh3d.hpp>
#include <motionlang/train/tm2t_tokenizer_training.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<ClipWindow> training_windows(const DescribedMotions& data, Index window,
                                                         std::string_view setting) {
  std::vector<Index> lengths;
  for (const DescribedMotion& m : data.training) lengths.push_back(std::ssize(m.rows) / data.width);
  auto out = tm2t_windows(lengths, window);
  if (out.empty())
    raise<config_error>(102, "no motion to train on has more than ", setting, " = ", counted(window, "frame"),
                        lengths.empty()
                            ? std::string()
                            : concat_text("; the longest has ", *std::max_element(lengths.begin(), lengths.end())));
  return out;
}

MOTIONLANG_BODY std::vector<double> tm2t_training_deviation(std::vector<double> std, double bias, bool grouped) {
  const Index joints = (std::ssize(std) + 1) / 12;
  if (!grouped) std = group_means(std::move(std), Guoh3dSlots{joints}.groups());
  return tm2t_deviation(std::move(std), joints, bias);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
