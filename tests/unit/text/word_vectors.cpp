// Vectors of words, the forms of words, and an encoder that hears words which it never learned.
#include <doctest/doctest.h>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/text/caption_encoder.hpp>
#include <motionlang/text/heard_words.hpp>
#include <motionlang/text/word_forms.hpp>
#include <motionlang/text/word_vectors.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using ml::Index, ml::HeardWords, ml::WordPiece, ml::WordVectors;
using tensors::same_bits;

namespace {

using Words = std::vector<std::string>;
using Ids = std::vector<Index>;

/// stroll is nearly walk, wave is far from both.
WordVectors vectors() {
  const Words words{"walk", "stroll", "wave"};
  const std::vector<float> numbers{1, 0, 0.9f, 0.1f, 0, -2};
  return WordVectors::rounded(words, numbers);
}

ml::CaptionEncoder<B> encoder(const WordVectors& words) {
  const Words captions{"walk slowly", "walk slowly", "wave", "wave"};
  ml::Philox rng{.seed = 3};
  return {{.width = 8, .heads = 2, .d_ff = 12, .layers = 1, .out = 5, .hidden_words = 0.5},
          WordPiece::of_words(captions),
          rng,
          words};
}

double distance(const ml::Tensor<B, 2>& rows, Index a, Index b) {
  double sum = 0;
  for (Index k = 0; k < rows.size(1); ++k) {
    const double d = rows.span()[static_cast<std::size_t>(a * rows.size(1) + k)] -
                     rows.span()[static_cast<std::size_t>(b * rows.size(1) + k)];
    sum += d * d;
  }
  return sum;
}

}  // namespace

TEST_CASE("vectors are rounded by at most half a step of their column, and words are sorted") {
  const auto table = vectors();
  CHECK(table.words() == Words{"stroll", "walk", "wave"});
  CHECK(table.size() == 3);
  CHECK(table.width() == 2);
  const auto stroll = table.vector(*table.find("stroll"));
  CHECK(stroll[0] == doctest::Approx(0.9).epsilon(0.5 / 127));
  CHECK(std::abs(stroll[1] - 0.1) <= 1.0 / 127);
  CHECK(table.vector(*table.find("wave"))[1] == doctest::Approx(-2));
  CHECK(ml::word_likeness(table.vector(0), table.vector(1)) > 0.99);
  CHECK(ml::word_likeness(table.vector(1), table.vector(2)) == doctest::Approx(0));
  CHECK_ERROR(table.vector(3), "[motionlang.shape.203] WordVectors: row 3 of 3");
  CHECK(table.checksum() == vectors().checksum());
  CHECK(table.checksum() != WordVectors({"a"}, {1}, {1}).checksum());
  CHECK(WordVectors({"a"}, {1}, {1}).checksum() != WordVectors({"a"}, {1}, {2}).checksum());
  CHECK(WordVectors({"a"}, {1}, {1}).checksum() != WordVectors({"b"}, {1}, {1}).checksum());
  CHECK(WordVectors().empty());
  CHECK_FALSE(WordVectors().find("walk"));
}

TEST_CASE("words are found in other forms, and exact words come first") {
  const auto table = vectors();
  for (const char* form : {"strolls", "strolled", "strolling"}) CHECK(table.find(form) == table.find("stroll"));
  CHECK(table.find("waving") == table.find("wave"));
  CHECK_FALSE(table.find("sprint"));
  const auto known = [](const Words& words) {
    return [words](const std::string& w) { return std::find(words.begin(), words.end(), w) != words.end(); };
  };
  CHECK(ml::known_form("hurries", known({"hurry"})) == "hurry");
  CHECK(ml::known_form("hurried", known({"hurry"})) == "hurry");
  CHECK(ml::known_form("hopping", known({"hop"})) == "hop");
  CHECK(ml::known_form("hopping", known({"hop", "hopping"})) == "hopping");
  CHECK(ml::known_form("punches", known({"punch"})) == "punch");
  CHECK(ml::known_form("king", known({"k"})) == "king");  // what is left would be no word
}

TEST_CASE("a table that does not hold together is refused") {
  const Words one{"a"};
  const std::vector<float> endless{std::numeric_limits<float>::infinity()}, tiny{1e-44f};
  CHECK_ERROR(WordVectors::rounded(one, endless), "[motionlang.numeric.301] WordVectors: number 0 of 'a' is inf");
  CHECK(WordVectors::rounded(one, tiny).codes().front() >= 0);  // too small for a step of its own
  CHECK_ERROR(WordVectors({"b", "a"}, {1, 2}, {1}, "table"), "[motionlang.config.107] table: word 1 is 'a' behind 'b'");
  CHECK_ERROR(WordVectors({"a", "a"}, {1, 2}, {1}, "table"), "[motionlang.config.107]");
  CHECK_ERROR(WordVectors({"a", "b"}, {1, 2, 3}, {1}, "table"), "[motionlang.shape.205] table: 3 numbers for 2 words");
  CHECK_ERROR(WordVectors({"a"}, {1}, {std::numeric_limits<float>::infinity()}, "table"), "scale 0 is inf");
}

TEST_CASE("each word is its piece, [UNK] with a vector, or letters") {
  const auto pieces = WordPiece::of_words(Words{"walk slowly", "walk slowly", "once"});
  CHECK(pieces.find("walk"));
  CHECK(pieces.find("slowly"));
  CHECK_FALSE(pieces.find("once"));  // said once only
  const auto table = vectors();
  const Words texts{"walk stroll slowly so", ""};
  const auto heard = ml::heard_words(pieces, table, texts, 16);
  const Index none = HeardWords::no_vector, unknown = WordPiece::unknown_id;
  Ids so{};
  pieces.append_word(so, "so");
  CHECK(so.size() == 2);  // s, ##o
  CHECK(heard.ids == Ids{0, *pieces.find("walk"), unknown, *pieces.find("slowly"), so[0], so[1], 1, 0, 1});
  CHECK(heard.rows == Ids{none, *table.find("walk"), *table.find("stroll"), none, none, none, none, none, none});
  CHECK(heard.lengths == Ids{7, 2});
  const auto cut = ml::heard_words(pieces, table, texts, 4);
  CHECK(cut.ids == Ids{0, *pieces.find("walk"), unknown, 1, 0, 1});
  CHECK(cut.rows == Ids{none, *table.find("walk"), *table.find("stroll"), none, none, none});
  CHECK_ERROR(ml::heard_words(pieces, table, texts, 1), "[motionlang.config.101]");
}

TEST_CASE("hidden words keep their vectors, and the others their pieces") {
  const auto pieces = WordPiece::of_words(Words{"walk slowly", "walk slowly"});
  auto heard = ml::heard_words(pieces, vectors(), Words{"walk slowly"}, 16);
  const auto rows = heard.rows;
  ml::Philox rng{.seed = 1};
  ml::hide_words(heard, 1, rng);
  CHECK(heard.ids == Ids{0, WordPiece::unknown_id, *pieces.find("slowly"), 1});
  CHECK(heard.rows == rows);
}

TEST_CASE("an unknown word is heard where its vector is") {
  const Words texts{"stroll", "walk", "wave", "xyz", "stroll slowly", "xyz slowly"};
  const auto deaf = encoder({})(texts);
  CHECK(same_bits(ml::slice(deaf, 0, 0, 1), ml::slice(deaf, 0, 3, 4)));  // both are [UNK]: no caption has their letters
  auto hears = encoder(vectors());
  CHECK(hears.vector_projection->weight.shape() == ml::Shape{8, 2});
  // without embeddings of their own, words are their vectors
  hears.embedding.weight = hears.embedding.weight * 0.0;
  const auto rows = hears(texts);
  CHECK(distance(rows, 0, 1) < 0.05 * distance(rows, 0, 2));
  CHECK(same_bits(ml::slice(rows, 0, 0, 1), hears(Words{"strolling"})));
}

TEST_CASE("training hides words by the generator of the context, and the projection learns") {
  using A = ml::Autodiff<B>;
  const auto model = ml::convert<A>(encoder(vectors()));
  const Words texts{"walk walk walk walk walk walk walk walk"};
  const auto out = model(texts, {.dropout = ml::Philox{.seed = 4}});
  CHECK(same_bits(ml::Tensor<B, 2>(A::value(out.data())),
                  ml::Tensor<B, 2>(A::value(model(texts, {.dropout = ml::Philox{.seed = 4}}).data()))));
  const auto gradients = ml::backward(ml::mean(ml::square(out)));
  const auto* g = gradients.find(model.vector_projection->weight.data());
  REQUIRE(g != nullptr);
  const auto numbers = B::to_span(*g);
  CHECK(std::any_of(numbers.begin(), numbers.end(), [](float x) { return x != 0; }));
}
