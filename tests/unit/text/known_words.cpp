#include <doctest/doctest.h>

#include <motionlang/text/known_words.hpp>

namespace ml = motionlang;

TEST_CASE("the words of captions, listed for the metadata and read from there") {
  const std::vector<std::string> captions{"Walk forward", "walk, then jump"};
  const std::string listed = ml::listed_words(captions);
  CHECK(listed == "forward\njump\nthen\nwalk");
  CHECK(ml::known_words({{ml::known_words_entry, listed}}) ==
        std::vector<std::string>{"forward", "jump", "then", "walk"});
  CHECK(ml::known_words({{"license", "MIT"}}).empty());
}

TEST_CASE("words that are not known, each once, with a known one like it") {
  const ml::KnownWords known({"walk", "forward"});
  const auto found = ml::unknown_words("Walk forwad, dance, forwad", known);
  REQUIRE(found.size() == 2);
  CHECK(found[0].word == "forwad");
  CHECK(found[0].like == "forward");
  CHECK(found[1].word == "dance");
  CHECK(found[1].like.empty());
  CHECK(ml::unknown_words("walk", known).empty());
  CHECK(ml::unknown_words("dance", {}).empty());
}

TEST_CASE("words with a vector are known in all of their forms, but never suggested") {
  const std::vector<std::string> words{"forwards", "stroll"};
  const ml::KnownWords known({"forward", "walk"}, ml::WordVectors::rounded(words, std::vector<float>{1, 2}));
  CHECK(known.knows("walk"));
  CHECK(known.knows("stroll"));
  CHECK(known.knows("strolled"));
  CHECK_FALSE(known.knows("walked"));
  CHECK(known.like("forwadrs") == "forward");
  CHECK(known.like("strol").empty());
  std::vector<std::string> twice(2000, "at");  // as many as nearest_name compares
  twice.push_back("walk");
  CHECK(ml::KnownWords(twice).like("wlak") == "walk");
  CHECK(ml::unknown_words("stroll forward, walk", known).empty());
  CHECK(ml::KnownWords().empty());
  CHECK(ml::KnownWords({}, ml::WordVectors::rounded(words, std::vector<float>{1, 2})).empty());
}

TEST_CASE("words that the tokenizer cannot read") {
  CHECK(ml::unreadable_words("walk \xC3\xA9t\xC3\xA9 \xE2\x80\x94 forward") ==
        std::vector<std::string>{"\xC3\xA9t\xC3\xA9"});  // a dash is not a letter
  CHECK(ml::unreadable_words("walk 2 steps").empty());
}
