// Batches of motions as tokens, and how many symbols a model writes rightly.
#include <doctest/doctest.h>

#include <motionlang/backend/usual.hpp>
#include <motionlang/train/text_motion_texts.hpp>
#include <motionlang/train/tm2t_tokens.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

TEST_CASE("a batch of tokens has the marks; with draws, one in three loses its first or last token") {
  const ml::MotionVocabulary vocabulary{.codes = 100};
  const ml::TokenizedMotions motions{{{{{7, 8, 9}}, {1, 2}}}, {{{{5}}, {3}}}};
  const std::vector<ml::Index> both{0, 1};
  const auto plain = ml::tokenized_batch(motions, vocabulary, both, nullptr);
  CHECK(plain.tokens.ids == std::vector<ml::Index>{100, 7, 8, 9, 101, 100, 5, 101});
  CHECK(plain.words.ids == std::vector<ml::Index>{1, 2, 3});
  CHECK(ml::written_symbols(plain.tokens) == 6);  // all but the start marks

  int whole = 0, without_first = 0, without_last = 0;
  ml::Philox draw{.seed = 1};
  for (int k = 0; k < 300; ++k) {
    const auto drawn = ml::tokenized_batch(motions, vocabulary, both, &draw);
    CHECK(drawn.tokens[1].size() == 3);  // the only token is never dropped
    const auto tokens = drawn.tokens[0];
    whole += tokens.size() == 5 ? 1 : 0;
    without_first += tokens.size() == 4 && tokens[1] == 8 ? 1 : 0;
    without_last += tokens.size() == 4 && tokens[1] == 7 ? 1 : 0;
  }
  CHECK(whole + without_first + without_last == 300);
  CHECK(whole > 170);
  CHECK(without_first > 30);
  CHECK(without_last > 30);
}

TEST_CASE("the share of right symbols is that of the most probable ones") {
  const ml::IdSequences written = ml::IdSequences::from({{2, 0, 1}});  // 2 is the start mark
  const auto logits = [](std::vector<float> values) { return ml::Tensor<B, 2>::from(values, {2, 3}); };
  CHECK(ml::right_symbols(logits({5, 1, 0, 0, 2, 1}), written) == 1);
  CHECK(ml::right_symbols(logits({5, 1, 0, 3, 2, 1}), written) == 0.5);
}

TEST_CASE("a language model is trained only if it is DistilBERT, from its folder") {
  ml::TextTokensConfig text{.encoder = "distilbert", .finetune = true};
  CHECK_NOTHROW(ml::require_finetuned(text, std::filesystem::temp_directory_path()));
  CHECK_ERROR(ml::require_finetuned(text, "cache.npy"), "[motionlang.config.102]");
  text.encoder = "word_pieces";
  CHECK_ERROR(ml::require_finetuned(text, std::filesystem::temp_directory_path()), "text.encoder is 'word_pieces'");
}
