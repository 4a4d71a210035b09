// The caption encoder: width, length, dropout. Its laws are in tests/laws.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/text/caption_encoder.hpp>

#include "../../support/tensors.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using tensors::same_bits;

TEST_CASE("one row for each caption; long captions are cut; dropout needs a generator") {
  const std::vector<std::string> texts{"walk forward", "wave", ""};
  ml::Philox rng{.seed = 1};
  const ml::CaptionEncoder<B> encoder({.width = 8, .heads = 2, .d_ff = 12, .layers = 1, .out = 5, .longest = 6},
                                      ml::WordPiece::learn(texts, 50), rng);
  const auto rows = encoder(texts);
  CHECK(rows.shape() == ml::Shape{3, 5});
  CHECK_FALSE(same_bits(ml::slice(rows, 0, 0, 1), ml::slice(rows, 0, 1, 2)));

  const std::vector<std::string> long_texts{"wave wave wave wave wave wave", "wave wave wave wave wave wave walk"};
  const auto cut = encoder(long_texts);
  CHECK(same_bits(ml::slice(cut, 0, 0, 1), ml::slice(cut, 0, 1, 2)));  // the difference is behind the sixth piece

  const auto dropped = encoder(texts, {.dropout = ml::Philox{.seed = 1}});
  CHECK_FALSE(same_bits(dropped, rows));
  CHECK(same_bits(encoder(texts, {.dropout = ml::Philox{.seed = 1}}), dropped));
}
