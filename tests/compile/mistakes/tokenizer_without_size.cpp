// SPDX-License-Identifier: MIT
// An own tokenizer that does not say how many ids it has: an embedding could not be sized.
// expect: t\.size\(\)
#include <string_view>
#include <vector>

#include <motionlang/text/tokenizer.hpp>

namespace ml = motionlang;

struct Letters {
  std::vector<ml::Index> encode(std::string_view text) const { return {text.begin(), text.end()}; }
#ifndef MISTAKE
  ml::Index size() const { return 256; }
#endif
};
static_assert(ml::Tokenizer<Letters>);
