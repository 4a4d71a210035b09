// The captions that a model knows, and the lengths of their actions.
#include <motionlang/text/known_captions.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "../../support/word_count_encoder.hpp"

namespace ml = motionlang;
using Texts = std::vector<std::string>;

namespace {

ml::KnownCaptions known(double nearness = 0.5) {
  const std::vector<std::pair<const char*, ml::KnownAction>> rows{
      {"walk", {3, true, ""}},
      {"walk ahead", {4, true, ""}},
      {"raise the right arm", {2, false, "hold the right arm up"}},
      {"kick", {1, false, "stand still"}},
      {"kick hard", {2, false, "stand still"}},
      {"kick again and again", {6, true, ""}},
  };
  Texts texts;
  std::vector<ml::KnownAction> actions;
  for (const auto& [text, action] : rows) texts.emplace_back(text), actions.push_back(action);
  return {ml::TextTable::encoded(texts, counted::vectors), actions, nearness};
}

}  // namespace

TEST_CASE("captions and their mirror images are known, other texts are not") {
  const auto captions = known();
  CHECK(captions.knows("walk"));
  CHECK(captions.knows("raise the left arm"));
  CHECK_FALSE(captions.knows("moonwalk"));
  const auto near = captions.nearest("raise the left arm", 3);
  REQUIRE(near.size() == 3);
  CHECK(near[0].text == "raise the left arm");
  CHECK(near[0].likeness > 0.99);
  CHECK(near[1].text == "raise the right arm");
  CHECK(known(0).knows("moonwalk"));
  CHECK_FALSE(ml::KnownCaptions().knows("walk"));
  CHECK(ml::KnownCaptions().nearest("walk", 2).empty());
}

TEST_CASE("how long an action takes, and what follows") {
  const auto captions = known();
  const auto kick = captions.action("kick");
  REQUIRE(kick);
  CHECK_FALSE(kick->repeats);
  CHECK(kick->seconds == 1);
  CHECK(kick->then == "stand still");
  const auto walk = captions.action("walk");
  REQUIRE(walk);
  CHECK(walk->repeats);
  CHECK(walk->then.empty());
  CHECK(captions.action("kick again and again")->repeats);
  CHECK(captions.action("raise the left arm")->then == "hold the left arm up");
  CHECK(captions.action("raise the right arm")->then == "hold the right arm up");
  CHECK_FALSE(captions.action("moonwalk"));
  CHECK_ERROR(ml::KnownCaptions(captions.table(), {{}}, 0), "1 action and 0 shares for 6 texts");
}

TEST_CASE("a caption comes before the mirror image of another that is as alike") {
  const Texts texts{"raise the right arm", "raise the left arm"};
  const ml::KnownCaptions both(ml::TextTable::encoded(texts, counted::vectors), {{}, {}}, 0.5);
  for (ml::Index row = 0; row < 2; ++row) {
    const auto meant = both.meant(texts[static_cast<std::size_t>(row)], 1);
    CHECK(meant[0].row == row);
    CHECK_FALSE(meant[0].mirrored);
    const auto also = both.meant(texts[static_cast<std::size_t>(row)], 9);
    REQUIRE(also.size() == 2);
    CHECK(also[1].row == 1 - row);
    CHECK(also[1].mirrored);
  }
}

TEST_CASE("a text that is far from all captions means its beginning, if that is a caption") {
  const auto captions = known();
  for (const char* text : {"kick xylophone", "he kicks the xylophone", "a person is kicking some xylophones"}) {
    CHECK_FALSE(captions.knows(text));
    REQUIRE_MESSAGE(!captions.meant(text, 1).empty(), text);
    CHECK(captions.meant(text, 1)[0].row == 3);
    CHECK(captions.action(text)->then == "stand still");
  }
  CHECK(captions.meant("kicks hard at a xylophone", 1)[0].row == 4);  // the longest one
  CHECK(captions.meant("xylophone kick", 1).empty());
  CHECK(captions.meant("the", 1).empty());
  for (const char* text : {"raises the right arm at xylophones", "raises the left arm at xylophones"})
    CHECK(captions.meant(text, 1)[0].row == 2);
  const auto still = captions.with_captions({"do not sit"}, {{3, true, ""}});
  CHECK(still.meant("don't sit", 1)[0].row == 6);
}

TEST_CASE("the caption that says no more than the text is meant") {
  const Texts texts{"walk and get pushed", "kick"};  // the encoder hears "walk" and "kick"
  const ml::KnownCaptions captions(ml::TextTable::encoded(texts, counted::vectors), {{}, {}}, 0.5);
  const auto meant = captions.meant("walk", 9);
  REQUIRE(meant.size() == 1);
  CHECK(captions.table().texts()[static_cast<std::size_t>(meant[0].row)] == "walk and get pushed");
  const Texts both{"walk and get pushed", "walk", "kick"};
  const ml::KnownCaptions better(ml::TextTable::encoded(both, counted::vectors), {{}, {}, {}}, 0.5);
  REQUIRE(better.meant("walk", 9).size() == 1);
  CHECK(better.meant("walk", 9)[0].row == 1);
}

TEST_CASE("misspelled words are heard as words of the captions, if vectors tell which words exist") {
  const Texts texts{"walk", "raise the right arm", "kick hard", "give a handshake"};
  const ml::WordVectors vectors({"arm", "hard", "kick", "raise", "right", "talk", "the", "walk"},
                                {1, 2, 3, 4, 5, 6, 7, 8, 9, 8, 7, 6, 5, 4, 3, 2}, {0.1f, 0.2f});
  const std::vector<ml::KnownAction> actions(4);
  const ml::KnownCaptions captions(ml::TextTable::encoded(texts, counted::vectors, vectors), actions, 0.5);
  CHECK(captions.meant_texts("raise the rigth amr", 1) == Texts{"raise the right arm"});
  CHECK(captions.meant_texts("Kik hard", 1) == Texts{"kick hard"});
  CHECK(captions.nearest("raise the rigth amr", 1)[0].likeness > 0.99);
  const auto wrong = captions.misspelled("The human perfoms a rigth kick");
  REQUIRE(wrong.size() == 2);
  CHECK(wrong[0].word == "perfoms");
  CHECK(wrong[0].read == "performs");
  CHECK(wrong[1].read == "right");
  for (const char* word : {"handstand", "pick", "a", "180", "don't", "kicks", "zylophone"})
    CHECK_MESSAGE(captions.misspelled(word).empty(), word);
  CHECK(captions.meant_texts("zylophone", 1).empty());
  CHECK(captions.meant_texts("talk", 1).empty());  // a word that exists
  CHECK(ml::KnownCaptions(ml::TextTable::encoded(texts, counted::vectors), actions, 0.5).meant("wlak", 1).empty());
}

TEST_CASE("a long text means its longest beginning that is nearly a caption") {
  const auto captions = known();
  CHECK(captions.meant("kick hard, then play the xylophone", 1)[0].row == 4);
  CHECK(captions.meant("kicks the xylophone and walks", 1)[0].row == 3);
}

TEST_CASE("the captions that a text means") {
  const auto captions = known();
  const auto hard = captions.meant("kick hard", 4);
  REQUIRE(hard.size() == 1);  // "kick" is not nearly as alike
  CHECK(hard[0].row == 4);
  CHECK_FALSE(hard[0].mirrored);
  CHECK(captions.meant("raise the left arm", 1)[0].row == 2);
  CHECK(captions.meant("raise the left arm", 1)[0].mirrored);
  CHECK(captions.meant_texts("raise the left arm", 1) == Texts{"raise the left arm"});
  CHECK(captions.meant_texts("kicks the xylophone", 1) == Texts{"kick"});
  CHECK(captions.meant("moonwalk", 9).empty());
  CHECK(captions.meant_texts("moonwalk", 9).empty());
  CHECK(ml::KnownCaptions().meant("walk", 1).empty());
}

TEST_CASE("captions are added, or get another action; all are encoded anew") {
  const auto more =
      known().with_tried({"sit again"}, {0.5}).with_captions({"sit", "kick"}, {{3, false, "sit"}, {9, true, ""}});
  CHECK(more.actions().size() == 7);
  CHECK(more.meant("sit", 1)[0].row == 6);
  CHECK(more.action("sit")->seconds == 3);
  CHECK(more.actions()[3].seconds == 9);
  CHECK(*more.success("sit again") == 0.5);
  Texts all;
  for (std::size_t i = 0; i < 7; ++i) all.push_back(more.table().texts()[i]);
  CHECK(more.table().first(7).mean().front() == ml::TextTable::encoded(all, counted::vectors).mean().front());
  CHECK(ml::KnownCaptions().with_captions({"sit"}, {{}}).empty());
  CHECK_ERROR(known().with_captions({"sit"}, {}), "[motionlang.shape.205] KnownCaptions: 0 actions for 1 text");
}

TEST_CASE("texts that were tried tell at what the model often fails, but it does not know them") {
  const auto captions = known().with_tried({"kick hard", "raise the left arm", "sit"}, {0.25, 0.75, 0});
  CHECK(captions.done() == std::vector<double>{0.25, 0.75, 0});
  CHECK(*captions.success("kick hard") == 0.25);
  CHECK(*captions.success("a person please kick hard") == doctest::Approx(0.25));
  CHECK(*captions.success("raise the right arm") == doctest::Approx(0.75));  // mirrored
  CHECK_FALSE(captions.success("walk"));
  CHECK_FALSE(known().success("kick"));
  CHECK_FALSE(captions.knows("sit"));
  for (const auto& near : captions.nearest("sit", 9)) CHECK(near.text != "sit");
  const auto other = captions.with_tried({"walk"}, {1});
  CHECK(*other.success("walk") == 1);
  CHECK_FALSE(other.success("kick hard"));
}

TEST_CASE("the likeness that divides two lists") {
  CHECK(ml::dividing_likeness({0.6, 0.8, 0.9}, {0.1, 0.2, 0.4}) == doctest::Approx(0.5));
  CHECK(ml::dividing_likeness({0.1, 0.8, 0.9, 1}, {0.2, 0.3, 0.4, 0.5}) == doctest::Approx(0.65));
  CHECK(ml::dividing_likeness({0.3, 0.4}, {0.5, 0.6}) == doctest::Approx(0.3));  // nothing is right about them
  CHECK(ml::dividing_likeness({}, {0.5}) == 0);
  CHECK(ml::dividing_likeness({0.5}, {}) == 0);
}
