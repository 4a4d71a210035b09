// The caption encoder, published networks behind a tokenizer, tables of pieces and words, and one as a user would write
// it.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include <motionlang/text/bert.hpp>
#include <motionlang/text/clip_text.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/text/tokenized_encoder.hpp>
#include <motionlang/text/word_piece_tokens.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

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

  const std::vector<std::string> captions{"walk forward", "raise both arms", "sit down", "walk and sit down"};
  const auto pieces = ml::WordPiece::learn(captions, 40);
  ml::Philox rng{.seed = 2};
  const ml::BertConfig bert{.vocabulary = 40, .width = 8, .heads = 2, .d_ff = 12, .layers = 1, .positions = 64};
  const ml::ClipTextConfig clip{
      .vocabulary = 40, .width = 8, .heads = 2, .d_ff = 12, .layers = 1, .context = 64, .out = 5};
  laws::text_encoder_laws<B>(ml::TokenizedEncoder(pieces, ml::DistilBert<B>(bert, rng)));
  laws::text_encoder_laws<B>(
      ml::TokenizedEncoder(pieces, ml::Mpnet<B>(bert, rng), {.pooling = ml::Pooling::mean, .normalize = true}));
  laws::text_encoder_laws<B>(ml::TokenizedEncoder(pieces, ml::ClipText<B>(clip, rng), {.pooling = ml::Pooling::end}));
  laws::text_encoder_laws<B>(ml::TokenizedEncoder(pieces, ml::Bert<B>(bert, rng), {.pooling = ml::Pooling::first}));
  laws::text_encoder_laws<B>(ml::TokenizedEncoder(pieces, ml::Roberta<B>(bert, rng), {.pooling = ml::Pooling::first}));
  const ml::BertTokenizer words(
      {"[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]", "walk", "sit", "arms", "raise", "##s", "!"});
  laws::text_encoder_laws<B>(
      ml::AnyTextEncoder<B>{ml::AnyTokenizer(words), ml::AnyTextNetwork<B>{ml::Bert<B>(bert, rng)}, {}});
}
