// Texts that a model knows for what somebody began to write.
#include <motionlang/text/text_completion.hpp>

#include <doctest/doctest.h>

#include "../../support/word_count_encoder.hpp"

namespace ml = motionlang;

namespace {

std::vector<std::string> offered(const std::string& begun, ml::Index count = 10) {
  const std::vector<std::string> texts{"turn left and walk", "walk", "walk backwards", "walk ahead", "kick", "walk"};
  const std::vector<ml::KnownAction> actions{{1}, {2}, {3}, {4}, {5, false}, {6}};
  const ml::KnownCaptions captions({ml::TextTable::encoded(texts, counted::vectors), actions, 0.5});
  std::vector<std::string> out;
  for (const ml::KnownText& t : ml::known_texts(captions.with_tried({"kick high"}, {0.5}), begun, count))
    out.push_back(t.text + " " + std::to_string(static_cast<int>(t.action.seconds)));
  return out;
}

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("texts that begin so come first, then those with the words, each once") {
  CHECK(offered("wal", 4) == Texts{"walk 2", "walk backwards 3", "walk ahead 4", "turn left and walk 1"});
  CHECK(offered("Walk  B", 1) == Texts{"walk backwards 3"});
  CHECK(offered("walk left", 1) == Texts{"turn left and walk 1"});
  CHECK(offered("", 2) == Texts{"turn left and walk 1", "walk 2"});
  CHECK(offered("walk", 2) == Texts{"walk 2", "walk backwards 3"});
}

TEST_CASE("others follow by their meaning, and texts that were only tried do not") {
  const Texts kicks = offered("please kick", 3);
  REQUIRE(!kicks.empty());
  CHECK(kicks.front() == "kick 5");
  CHECK(offered("kick") == offered("kick", 99));
  for (const std::string& text : offered("kick", 99)) CHECK(text.find("high") == std::string::npos);
  CHECK(offered("walk", 0).empty());
  CHECK(ml::known_texts({}, "walk", 3).empty());
}
