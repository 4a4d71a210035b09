// Texts that no motion shows.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include <motionlang/text/stranger_texts.hpp>

namespace ml = motionlang;
using ml::WordPiece, ml::WordVectors;

namespace {

using Words = std::vector<std::string>;

WordPiece pieces() { return WordPiece::of_words(Words{"walk slowly", "walk slowly", "once"}); }
/// stroll is nearly walk; budget and senate are far from it.
WordVectors vectors() {
  const Words words{"walk", "stroll", "budget", "senate"};
  const std::vector<float> numbers{1, 0, 0.9f, 0.1f, 0, -2, -0.5f, -1};
  return WordVectors::rounded(words, numbers);
}

}  // namespace

TEST_CASE("strangers are words far from those of captions") {
  const ml::StrangerTexts strangers(pieces(), vectors());
  CHECK(strangers.words() == Words{"budget", "senate"});
  const auto texts = strangers.draw(300, ml::Philox{.seed = 1});
  REQUIRE(texts.size() == 300);
  CHECK(texts == strangers.draw(300, ml::Philox{.seed = 1}));
  CHECK(texts != strangers.draw(300, ml::Philox{.seed = 2}));
  int known = 0, people = 0;
  const Words allowed{"a", "person", "someone", "man", "woman", "budget", "senate"};
  for (const std::string& text : texts) {
    const auto words = WordPiece::words(text);
    CHECK((!words.empty() && words.size() <= 6));
    known += std::ranges::all_of(words, [&](const auto& w) { return std::ranges::count(allowed, w) > 0; }) ? 1 : 0;
    people += text.starts_with("a ") || text.starts_with("someone ") ? 1 : 0;
    for (const std::string& w : words) CHECK((w != "walk" && w != "stroll" && w != "slowly"));
  }
  CHECK((known > 150 && known < 250));    // a third is invented
  CHECK((people > 100 && people < 200));  // half of them
}

TEST_CASE("a disturbed text keeps its words, in order, and gets one or two others") {
  const ml::StrangerTexts strangers(pieces(), vectors());
  const Words links{"a", "at", "with", "on", "the", "in", "like"};
  std::set<std::string> different;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const std::string text = strangers.disturb("Walk once slowly", ml::Philox{.seed = seed});
    different.insert(text);
    Words kept, added;
    for (const std::string& w : WordPiece::words(text)) {
      if (w == "budget" || w == "senate")
        added.push_back(w);
      else if (std::ranges::count(links, w) == 0)
        kept.push_back(w);
    }
    CHECK(kept == Words{"walk", "once", "slowly"});
    CHECK((added.size() == 1 || added.size() == 2));
  }
  CHECK(different.size() > 20);
}

TEST_CASE("without vectors, strangers are made of words that do not exist") {
  const ml::StrangerTexts strangers(pieces());
  CHECK(strangers.words().empty());
  const auto texts = strangers.draw(50, ml::Philox{.seed = 1});
  CHECK(std::set<std::string>(texts.begin(), texts.end()).size() > 45);
}
