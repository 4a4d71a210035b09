// The caption encoder, and one as a user would write it.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "../support/small_modules.hpp"
#include "text_encoder_laws.hpp"

namespace ml = motionlang;

namespace {

/// One token for every word and one for the end, each the number of its letters.
struct LettersPerWord {
  template <ml::Backend B>
  ml::TextFeatures<B> encode(std::span<const std::string> texts) const {
    std::vector<typename B::scalar> letters;
    std::vector<ml::Index> lengths;
    for (const std::string& text : texts) {
      const auto words = ml::WordPiece::words(text);
      for (const std::string& w : words) letters.push_back(static_cast<typename B::scalar>(w.size()));
      letters.push_back(0);
      lengths.push_back(std::ssize(words) + 1);
    }
    return {{ml::Tensor<B, 2>::from(letters, {std::ssize(letters), 1}), ml::Offsets(lengths)}};
  }
};

}  // namespace

TEST_CASE_TEMPLATE("laws of text encoders", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>,
                   ml::XtensorBackend<float>, ml::Autodiff<ml::EigenBackend<float>>) {
  laws::text_encoder_laws<B>(modules::Small<ml::CaptionEncoder>::make<B>(ml::Philox{.seed = 1}));
  laws::text_encoder_laws<B>(LettersPerWord{});
}
