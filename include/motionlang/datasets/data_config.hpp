// SPDX-License-Identifier: MIT
/// The choice of motions from a data set, and their split.
#pragma once

#include <cstdint>  // seed
#include <string>   // labels
#include <utility>  // names and values
#include <vector>   // labels

#include <motionlang/core/fields.hpp>
#include <motionlang/core/require_value.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct DataConfig {
  double min_seconds = 2, max_seconds = 10;  // for training and validation
  double test_share = 0.2;                   // of the clips, if there are no lists of ids
  double validation_share = 0.05;
  std::uint64_t split_seed = 1;
  bool mirror = false;                 // for training, also mirror clips of a table and their captions
  std::vector<std::string> actions{};  // labels to learn; none: all labels

  void require_sound() const {
    for (const auto& [name, value] : {std::pair("test_share", test_share), {"validation_share", validation_share}})
      require_value(name, value, value >= 0 && value < 1, "0 or more, and less than 1");
    require_value("min_seconds", min_seconds, min_seconds >= 0, "0 or more");
    require_value("max_seconds", max_seconds, max_seconds > 0, "a number above 0");
  }
  static constexpr auto fields() {
    using C = DataConfig;
    return motionlang::fields("min_seconds", &C::min_seconds, "max_seconds", &C::max_seconds, "test_share",
                              &C::test_share, "validation_share", &C::validation_share, "split_seed", &C::split_seed,
                              "mirror", &C::mirror, "actions", &C::actions);
  }
};

MOTIONLANG_NAMESPACE_END
