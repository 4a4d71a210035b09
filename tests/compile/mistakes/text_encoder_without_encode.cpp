// SPDX-License-Identifier: MIT
// An own text encoder whose function has another name than the concept asks for.
// expect: e\.(template )?encode<B>\(texts\)
#include <motionlang/backend/reference.hpp>
#include <motionlang/text/text_encoder.hpp>

namespace ml = motionlang;

struct BagOfWords {
  template <ml::Backend B>
#ifdef MISTAKE
  ml::TextFeatures<B> embed(std::span<const std::string> texts) const;
#else
  ml::TextFeatures<B> encode(std::span<const std::string> texts) const;
#endif
};
static_assert(ml::TextEncoder<BagOfWords, ml::ReferenceBackend<float>>);
