// SPDX-License-Identifier: MIT
/// Items that a reader of a data set leaves out, with the reasons.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <motionlang/core/error.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class LeftOut {
 public:
  void add(const std::string& why, const std::string& name, Index times = 1) {
    if (times == 0) return;
    Reason& reason = reasons_[why];
    reason.count += times;
    reason.name(name);
  }
  void add(const LeftOut& other) {
    for (const auto& [why, theirs] : other.reasons_) {
      Reason& reason = reasons_[why];
      reason.count += theirs.count;
      for (const std::string& name : theirs.names) reason.name(name);
      reason.more = reason.more || theirs.more;
    }
  }
  /// "5 left out: 3 too short (a, b), 2 without a label (d, e)", with the first names for each reason; or "0 left out".
  std::string text() const {
    Index all = 0;
    for (const auto& [why, reason] : reasons_) all += reason.count;
    const auto text_of = [](const auto& entry) {
      const auto& [why, reason] = entry;
      return concat_text(reason.count, " ", why, " (", join_text(reason.names), reason.more ? ", ...)" : ")");
    };
    return concat_text(all, " left out", all > 0 ? ": " : "", join_text(reasons_, ", ", text_of));
  }

 private:
  struct Reason {
    Index count = 0;
    std::vector<std::string> names{};  // the first ones, each once
    bool more = false;

    void name(const std::string& name) {
      if (std::find(names.begin(), names.end(), name) != names.end()) return;
      if (names.size() < 5)
        names.push_back(name);
      else
        more = true;
    }
  };
  std::map<std::string, Reason> reasons_;
};

MOTIONLANG_NAMESPACE_END
