// Vectors of texts that are not trained, from an encoder or from a cache.
#include <doctest/doctest.h>

#include <motionlang/backend/reference.hpp>
#include <motionlang/weights/text_states.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

TEST_CASE("word pieces need no states, DistilBERT needs them") {
  CHECK(ml::reads_pieces({.encoder = "word_pieces"}, ""));
  CHECK(!ml::reads_pieces({.encoder = "distilbert"}, "folder"));
  CHECK_ERROR(ml::reads_pieces({.encoder = "word_pieces"}, "folder"),
              "`text_encoder` is for text.encoder = distilbert");
  CHECK_ERROR(ml::reads_pieces({.encoder = "distilbert"}, ""), "[motionlang.config.102]");
  CHECK_ERROR(ml::reads_pieces({.encoder = "gpt"}, ""), "[motionlang.config.103] text.encoder 'gpt'");
}

TEST_CASE("a cache gives the states of the texts that it has") {
  const TemporaryFolder folder;
  ml::EmbeddingCache cache(2);
  const std::vector<float> walk{1, 2, 3, 4}, sit{5, 6};
  cache.add("walk", walk);
  cache.add("sit", sit);
  cache.write(folder.path, "states");
  const auto states = ml::text_states<B>(folder / "states.npy");
  const std::vector<std::string> one{"sit"}, both{"sit", "walk"}, other{"sit", "jump"};
  CHECK(states(one).count() == 1);
  const auto found = states(both);
  CHECK(found.count() == 2);
  CHECK(std::vector<float>(found.find("walk").begin(), found.find("walk").end()) == walk);
  CHECK(ml::token_states<B>(folder / "states.npy", both).width() == 2);
  CHECK_ERROR(states(other), "[motionlang.config.103]");
}

TEST_CASE("wordings of the same frames become the same unit vector") {
  ml::DescribedMotions data{1, 20, {}, {}, {}};
  data.training.push_back({"a", "a", {0, 0}, {{"walk slowly", {0, 2}}, {"stroll", {0, 2}}}});
  data.training.push_back({"b", "b", {0, 0}, {{"sit down", {0, 2}}}});
  const auto vectors = ml::sentence_vectors<B>("", data);
  CHECK(vectors.count() == 3);
  const auto of = [&](const char* text) {
    const auto row = vectors.find(text);
    return std::vector<float>(row.begin(), row.end());
  };
  CHECK(of("walk slowly") == of("stroll"));
  CHECK(of("walk slowly") != of("sit down"));
  double length = 0;
  for (const float x : of("stroll")) length += static_cast<double>(x * x);
  CHECK(length == doctest::Approx(1));
}
