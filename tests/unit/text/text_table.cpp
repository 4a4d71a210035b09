// A table of texts that finds the nearest to another text.
#include <motionlang/text/text_table.hpp>

#include <doctest/doctest.h>

#include <cmath>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/text/caption_encoder.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using Texts = std::vector<std::string>;

namespace {

/// Legs, arms and a constant by words, so that one can follow which texts are alike. Other words are legs a little.
std::vector<float> vectors(std::span<const std::string> texts) {
  std::vector<float> out;
  for (const std::string& text : texts) {
    float legs = 0, arms = 0;
    for (const std::string& word : ml::WordPiece::words(text)) {
      if (word == "walk" || word == "walks" || word == "stroll" || word == "run") legs += 1;
      if (word == "wave" || word == "arm") arms += 1;
      if (word == "blorp") legs += 0.5f;
    }
    out.insert(out.end(), {legs, arms, 7});
  }
  return out;
}

const Texts captions{"walk", "a person walks slowly", "run", "wave the arm", "wave"};

ml::WordVectors words() {
  const Texts list{"walk", "stroll", "wave", "run"};
  const std::vector<float> numbers{1, 0, 0.8f, 0.6f, 0, -1, 0.6f, -0.8f};
  return ml::WordVectors::rounded(list, numbers);
}

Texts texts_of(const std::vector<ml::NearText>& list) {
  Texts out;
  for (const auto& n : list) out.push_back(n.text);
  return out;
}

}  // namespace

TEST_CASE("the nearest texts say the same, or words like it") {
  const auto table = ml::TextTable::encoded(captions, vectors, words());
  CHECK(table.size() == 5);
  const auto walk = table.nearest("walk", 5);
  REQUIRE(walk.size() == 5);
  CHECK(walk[0].text == "walk");
  CHECK(walk[0].row == 0);
  CHECK(walk[0].likeness == doctest::Approx(1).epsilon(0.01));
  CHECK(walk[1].text == "a person walks slowly");  // says a word like it
  CHECK(walk[2].text == "run");
  CHECK(walk[2].likeness < 0.7);  // the words are 0.6 alike
  CHECK(walk[4].likeness == 0);   // to the other side of the mean
  CHECK(walk[0].said == doctest::Approx(1));
  CHECK(walk[1].said > 0.3);  // says "slowly", too
  CHECK(walk[1].said < 0.7);
  CHECK(walk[4].said < 0.1);
  const auto stroll = table.nearest("stroll", 1);
  CHECK(stroll[0].text == "walk");  // no text says it
  CHECK(stroll[0].likeness == doctest::Approx(0.8).epsilon(0.02));
  CHECK(texts_of(table.nearest("wave", 2)) == Texts{"wave", "wave the arm"});
  CHECK(table.nearest("wave", 99).size() == 5);
  CHECK(table.nearest("wave", 0).empty());
  // No word counts, so that the direction alone does: the cosine of (-0.6, -0.6) and (0.4, -0.6).
  CHECK(table.nearest("the person", 1)[0].likeness == doctest::Approx(0.196).epsilon(0.02));
}

TEST_CASE("an encoder that gives too few numbers, or none, is refused") {
  using Vectors = std::vector<float>;
  CHECK_ERROR(ml::TextTable::encoded(captions, [](auto) { return Vectors(); }), "0 numbers for 5 texts of 1");
  CHECK_ERROR(ml::TextTable::encoded(captions, [](auto) { return Vectors(11); }), "11 numbers for 5 texts of 2");
  CHECK_ERROR(ml::TextTable::encoded(captions, [](auto t) { return Vectors(2 * t.size(), std::nanf("")); }),
              "[motionlang.numeric.301] TextTable: the encoder gives nan for 'walk'");
  int calls = 0;
  const auto other_width = [&](std::span<const std::string> t) {
    return Vectors(t.size() * (calls++ == 0 ? 2 : 3), 1);
  };
  const auto table = ml::TextTable::encoded(captions, other_width);
  CHECK_ERROR(table.with({"walk"}), "3 numbers for 1 text of 2");
}

TEST_CASE("a word that nobody knows is far from all texts, wherever the encoder puts it") {
  const auto table = ml::TextTable::encoded(captions, vectors, words());
  CHECK(table.nearest("blorp", 1)[0].likeness < 0.02);
  const double known = table.nearest("walk slowly", 1)[0].likeness, half = table.nearest("walk blorp", 1)[0].likeness;
  CHECK(known > 0.9);
  CHECK(half < 0.6);
  CHECK(half > 0.1);
  // without vectors of words only the same words are alike
  CHECK(ml::TextTable::encoded(captions, vectors).nearest("stroll", 1)[0].likeness < 0.02);
}

TEST_CASE("rows can be left out, and several texts are asked together") {
  const auto table = ml::TextTable::encoded(captions, vectors, words());
  CHECK(table.nearest("walk", 1, [](ml::Index row) { return row != 0; })[0].text == "a person walks slowly");
  const Texts asked{"wave", "walk"};
  const auto both = table.nearest(asked, 1, [](ml::Index text, ml::Index row) { return text == 0 || row == 2; });
  REQUIRE(both.size() == 2);
  CHECK(both[0][0].text == "wave");
  CHECK(both[1][0].text == "run");
}

TEST_CASE("what was stored gives the same table") {
  const auto table = ml::TextTable::encoded(captions, vectors, words());
  const ml::TextTable again(table.texts(), {table.codes().begin(), table.codes().end()},
                            {table.mean().begin(), table.mean().end()}, vectors, words());
  for (const char* text : {"walk", "wave", "stroll"}) {
    const auto a = table.nearest(text, 5), b = again.nearest(text, 5);
    for (std::size_t i = 0; i < 5; ++i) {
      CHECK(a[i].row == b[i].row);
      CHECK(a[i].likeness == b[i].likeness);
    }
  }
  CHECK_ERROR(ml::TextTable({"walk"}, {1, 2}, {1, 2, 3}, vectors), "2 numbers for 1 text of 3");
  const ml::TextTable narrow({"walk"}, {1, 2}, {0, 0}, vectors);
  CHECK_ERROR(narrow.nearest("walk", 1), "[motionlang.shape.205]");
  CHECK(ml::TextTable().empty());
  CHECK(ml::TextTable().nearest("walk", 3).empty());
}

TEST_CASE("texts are added at the end, and left out there") {
  const auto table = ml::TextTable::encoded(captions, vectors, words());
  const auto more = table.with({"raise the arm", "stroll"});
  REQUIRE(more.size() == 7);
  CHECK(more.nearest("raise", 1)[0].text == "raise the arm");
  CHECK(more.nearest("stroll", 1)[0].row == 6);
  CHECK(std::equal(more.mean().begin(), more.mean().end(), table.mean().begin()));
  const auto first = more.first(5);
  CHECK(first.texts() == captions);
  CHECK(std::equal(first.codes().begin(), first.codes().end(), table.codes().begin(), table.codes().end()));
  CHECK(first.nearest("stroll", 1)[0].likeness == table.nearest("stroll", 1)[0].likeness);
  CHECK_ERROR(table.first(6), "the first 6 of 5");
  CHECK(ml::TextTable().with({"walk"}).empty());
  CHECK(ml::TextTable().first(0).empty());
}

TEST_CASE("an encoder of captions gives the vectors") {
  using B = ml::EigenBackend<float>;
  ml::Philox rng{.seed = 3};
  const ml::CaptionEncoder<B> encoder({.width = 8, .heads = 2, .d_ff = 12, .layers = 1, .out = 5},
                                      ml::WordPiece::of_words(captions, 1), rng);
  const auto table = ml::TextTable::encoded(captions, ml::text_vectors(encoder));
  CHECK(std::ssize(table.mean()) == 5);
  for (const std::string& caption : captions) CHECK(table.nearest(caption, 1)[0].text == caption);
}
