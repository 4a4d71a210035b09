// Texts as bags of words, and word pieces as token vectors.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/text/bag_of_words.hpp>
#include <motionlang/text/word_piece_tokens.hpp>

namespace ml = motionlang;
using B = ml::EigenBackend<double>;

namespace {

const std::vector<std::string> captions{"a person walks", "a person walks", "a person runs",
                                        "a person walks and waves"};

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double total = 0;
  for (std::size_t i = 0; i < a.size(); ++i) total += a[i] * b[i];
  return total;
}

}  // namespace

TEST_CASE("bag of words: the same words are the same, words of every text count for little") {
  const ml::BagOfWords bag(captions);
  CHECK(bag.width() == 7);  // a, and, person, runs, walks, waves, any other
  CHECK(dot(bag.vector("a person walks"), bag.vector("Person: walks a!")) == doctest::Approx(1));
  CHECK(dot(bag.vector("a person walks"), bag.vector("a person runs")) < 0.01);
  CHECK(dot(bag.vector("a person walks"), bag.vector("a person walks and waves")) > 0.2);
  CHECK(dot(bag.vector("jumps"), bag.vector("hops")) == doctest::Approx(1));  // neither is known
  CHECK(dot(bag.vector(""), bag.vector("")) == 0);
  // ln(4 / 4) + 1/100 for "a" and "person" in three different texts, ln(4 / 2) + 1/100 for "runs" in one
  const auto runs = bag.vector("a person runs");
  CHECK(runs[3] / runs[0] == doctest::Approx((std::log(2.0) + 0.01) / 0.01));
  const auto rows = bag.encode<B>(captions).tokens.rows;
  CHECK(rows.shape() == ml::Shape{4, 7});
  CHECK(rows.span()[2 * 7 + 3] == runs[3]);
}

TEST_CASE("word piece tokens with vectors: an unknown word is its vector, and training hides known ones") {
  const std::vector<std::string> words{"walk", "stroll", "wave"}, texts{"walk", "stroll", "wave", "xyz"};
  const std::vector<float> numbers{1, 0, 0.9f, 0.1f, 0, -2};
  ml::Philox rng{.seed = 3};
  ml::WordPieceTokens<B> tokens(ml::WordPiece::of_words(std::vector<std::string>{"walk wave", "walk wave"}), 4, rng,
                                ml::WordVectors::rounded(words, numbers), 1);
  REQUIRE(tokens.vector_projection);
  const auto rows = tokens(texts).tokens;
  const ml::Index word = 1;  // the row behind that of the beginning
  const auto vector = (*tokens.vector_projection)(
      ml::word_rows<B>(ml::heard_words(tokens.tokenizer, tokens.vectors, texts, 64), tokens.vectors));
  for (ml::Index k = 0; k < 4; ++k) {
    const double of_walk = tokens.embedding.weight.at(*tokens.tokenizer.find("walk"), k),
                 of_unknown = tokens.embedding.weight.at(ml::WordPiece::unknown_id, k);
    CHECK(rows[0].at(word, k) == doctest::Approx(of_walk + vector.at(1, k)));
    CHECK(rows[1].at(word, k) == doctest::Approx(of_unknown + vector.at(4, k)));
    // hidden words have no piece of their own
    const auto hidden = tokens(texts, {.dropout = ml::Philox{.seed = 1}}).tokens;
    CHECK(hidden[0].at(word, k) == doctest::Approx(of_unknown + vector.at(1, k)));
    CHECK(hidden[1].at(word, k) == rows[1].at(word, k));
  }
}

TEST_CASE("word piece tokens: a row of the table for each piece") {
  ml::Philox rng{.seed = 3};
  const ml::WordPieceTokens<B> tokens(ml::WordPiece::learn(captions, 60), 4, rng);
  CHECK(tokens.width() == 4);
  const auto both = tokens.encode<B>(captions).tokens;
  CHECK(both.count() == 4);
  const auto ids = tokens.tokenizer.encode(captions[3]);
  CHECK(both.offsets.length(3) == std::ssize(ids));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (ml::Index k = 0; k < 4; ++k)
      CHECK(both[3].at(static_cast<ml::Index>(i), k) == tokens.embedding.weight.at(ids[i], k));
  }
  static_assert(ml::TextEncoder<ml::WordPieceTokens<B>, B> && ml::TextEncoder<ml::BagOfWords, B>);
}
