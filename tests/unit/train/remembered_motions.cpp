// Recordings of a training set as motions that a model remembers.
#include <motionlang/train/remembered_motions.hpp>

#include <doctest/doctest.h>

#include <algorithm>  // count, find

#include "../../support/check_error.hpp"
#include "../../support/training_set.hpp"
#include "../../support/word_count_encoder.hpp"

namespace ml = motionlang;

TEST_CASE("recordings become motions of their captions") {
  const ml::TrainingSet& data = captioned::training_set();
  const auto memory = ml::remembered_motions(counted::captions(), data);
  CHECK(memory.motions().size() == data.segments().size());
  const auto& texts = memory.captions().table().texts();
  for (const std::string known : {"walk", "kick", "sit"}) CHECK(std::count(texts.begin(), texts.end(), known) == 1);
  for (std::size_t i = 0; i < data.segments().size(); ++i) {
    const auto& s = data.segments()[i];
    CHECK(memory.motions()[i].frames() == s.action);
    for (const std::string& caption : s.captions) {
      const auto row = std::find(texts.begin(), texts.end(), caption) - texts.begin();
      REQUIRE(row < std::ssize(texts));
      const ml::RememberedMotion wanted{row, static_cast<ml::Index>(i)};
      CHECK(std::count(memory.remembered().begin(), memory.remembered().end(), wanted) == 1);
    }
  }
}

TEST_CASE("words choose the recordings") {
  const ml::TrainingSet& data = captioned::training_set();
  const std::string word = data.segments()[0].captions[0];
  const std::vector<std::string> words{word};
  const auto chosen = data.saying(words);
  REQUIRE(!chosen.empty());
  CHECK(chosen.size() < data.segments().size());
  CHECK(ml::remembered_motions(counted::captions(), data, words).motions().size() == chosen.size());
  CHECK(data.saying({}).size() == data.segments().size());
  const std::vector<std::string> unknown{"fly"};
  CHECK_ERROR(ml::remembered_motions(counted::captions(), data, unknown), "no caption has \"fly\"");
  CHECK_ERROR(ml::remembered_motions({}, data),
              "[motionlang.config.102] remembered_motions: the model knows no caption");
}
