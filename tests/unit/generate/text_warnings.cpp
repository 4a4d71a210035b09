#include <motionlang/generate/text_warnings.hpp>

#include <doctest/doctest.h>

#include <motionlang/compose/timeline_text.hpp>

#include "../../support/word_count_encoder.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;
using Lines = std::vector<std::string>;

namespace {

std::vector<ml::Timeline> timelines(const char* text) { return ml::parse_timelines(text); }

}  // namespace

TEST_CASE("words that a model does not know, and texts that are too long for it") {
  const ml::KnownWords known({"forward", "walk"});
  CHECK(ml::unknown_word_warnings("Walk forwad, dance", known) ==
        Lines{"'Walk forwad, dance': the model never learned the words 'forwad' (did you mean 'forward'?), 'dance'"});
  CHECK(ml::unknown_word_warnings("dance", known) == Lines{"'dance': the model never learned the word 'dance'"});
  CHECK(ml::unknown_word_warnings("\xD0\xB8", known).front().find("reads no word of it") != std::string::npos);
  CHECK(ml::unknown_word_warnings("walk \xD0\xB8", known) ==
        Lines{"'walk \xD0\xB8': the model reads a-z and 0-9, not all of '\xD0\xB8'"});
  CHECK(ml::unknown_word_warnings("walk", known).empty());
  CHECK(ml::unknown_word_warnings("dance", {}).empty());
  CHECK(ml::unknown_word_warnings("", known).empty());

  fake::Model model;
  CHECK(ml::text_warnings(model, "dance").empty());
  model.known = known, model.length = {5, 3};
  CHECK(ml::text_warnings(model, "dance") == Lines{"'dance': the model never learned the word 'dance'",
                                                   "'dance': the model reads the first 3 of its 5 word pieces"});
}

TEST_CASE("a text far from all captions is warned about with those nearest to it, one that is near is not") {
  const auto captions = counted::captions();
  const ml::KnownWords known({"kick", "walk"});
  CHECK(ml::far_text_warnings("kick", captions, known).empty());
  CHECK(ml::far_text_warnings("please sit", captions, known).empty());  // near, although no word of it is listed
  CHECK(ml::far_text_warnings("walk, then kick and sit", captions, known).empty());
  CHECK_FALSE(ml::far_text_warnings("walk, then blorp", captions, known).empty());
  const auto far = ml::far_text_warnings("kicc blorp", captions, known);
  REQUIRE(far.size() == 2);
  CHECK(far[0] == "'kicc blorp': the model never learned the words 'kicc' (did you mean 'kick'?), 'blorp'");
  CHECK(far[1].starts_with("'kicc blorp' is far from all that the model learned; the nearest to it: '"));
  for (const char* caption : {"'walk'", "'kick'", "'sit'"}) CHECK(far[1].find(caption) != std::string::npos);
  CHECK(ml::far_text_warnings("\xD0\xB8", captions, known).front().find("reads no word of it") != std::string::npos);
  CHECK(ml::far_text_warnings("kick \xD0\xB8", captions, known).front().find("not all of") != std::string::npos);
  CHECK(ml::far_text_warnings("blorp", {}, known).empty());
  CHECK(ml::far_text_warnings("", captions, known).empty());

  fake::Model model;
  model.known = known, model.learned = captions;
  CHECK(ml::text_warnings(model, "sit").empty());
  CHECK(ml::text_warnings(model, "blorp").size() == 2);
}

TEST_CASE("a misspelled word of a text that is near is reported with the word that is read") {
  const ml::WordVectors vectors({"kick", "sit", "walk"}, {1, 2, 3, 4, 5, 6}, {0.1f, 0.2f});
  const std::vector<std::string> texts{"walk", "kick", "sit"};
  const std::vector<ml::KnownAction> actions(3);
  const ml::KnownCaptions captions(ml::TextTable::encoded(texts, counted::vectors, vectors), actions, 0.5);
  CHECK(ml::meaning_warnings("kikc", captions, {}) == Lines{"'kikc': 'kikc' is read as 'kick'"});
  CHECK(ml::meaning_warnings("kick", captions, {}).empty());
}

TEST_CASE("a text that is near is warned about if motions for texts like it mostly failed") {
  const auto captions = counted::captions().with_tried({"kick", "sit"}, {0.2, 0.8});
  CHECK(ml::failing_text_warnings("kick", captions) ==
        Lines{"'kick': the model often fails at this; 20 % of the motions that were tried for such texts did what "
              "they say"});
  CHECK(ml::meaning_warnings("kick", captions, {}).size() == 1);
  CHECK(ml::meaning_warnings("sit", captions, {}).empty());
  CHECK(ml::meaning_warnings("walk", captions, {}).empty());
  CHECK(ml::meaning_warnings("blorp", captions, {}).size() == 1);
}

TEST_CASE("of captions with the same words the first is shown") {
  const std::vector<std::string> texts{"walk", "a person can walk", "the walk", "kick", "kick again"};
  const std::vector<ml::KnownAction> actions(texts.size());
  const ml::KnownCaptions captions(ml::TextTable::encoded(texts, counted::vectors), actions, 0.9);
  const auto far = ml::far_text_warnings("walk blorp", captions, {});
  REQUIRE(far.size() == 1);
  CHECK(far[0].find("'walk', 'kick") != std::string::npos);
}

TEST_CASE("texts that outlast their action") {
  const auto captions = counted::captions();
  CHECK(ml::outlasting_text_warnings(timelines("sit # 0 # 8\nwalk # 8 # 16\n"), captions, 20) ==
        Lines{"'sit' takes about 2 s; in 8 s a model may repeat it. It could end earlier, before 'sit quietly'"});
  CHECK(ml::outlasting_text_warnings(timelines("sit # 0 # 3.5\n"), captions, 20).empty());
  CHECK(ml::outlasting_text_warnings(timelines("sit # 0 # 8\n"), {}, 20).empty());
  CHECK(ml::divided_text_notes("sit", {{{"sit", 0, 40, ml::BodyParts::all()}, {"rest", 40, 60, ml::BodyParts::all()}}},
                               20) == Lines{"'sit': 2 s of 'sit', then 1 s of 'rest'"});
  CHECK(ml::divided_text_notes("sit", {{{"sit", 0, 40, ml::BodyParts::all()}}}, 20).empty());

  fake::Model model;
  model.diffusion_steps = 10, model.learned = captions;
  const auto count = [&](const char* text, const ml::GenerateOptions& options = {}) {
    return ml::timeline_warnings(model, timelines(text), options).size();
  };
  CHECK(count("sit # 0 # 8\n") == 1);
  CHECK(count("kick # 0 # 8\n") == 0);  // cut_texts ends it
  CHECK(count("kick # 0 # 8\n", {.cut_texts = false}) == 1);
}

TEST_CASE("texts that others hide, and texts that take more than they need") {
  CHECK(ml::hidden_text_warnings(timelines("walk # 0 # 3 # legs\nrun # 1 # 2 # legs\nhop # 1 # 2 # legs\n"),
                                 {.source = "moves.txt"}) ==
        Lines{"moves.txt:2:1: 'run' moves nothing: other texts take all its body parts"});
  CHECK(ml::hidden_text_warnings(timelines("walk # 0 # 3 # legs\nrun # 1 # 2 # legs\n")).empty());
  CHECK(ml::whole_body_warnings(timelines("walk # 0 # 3\nwave with the right hand # 1 # 2\n")) ==
        Lines{"timeline:2:1: 'wave with the right hand' moves the whole body, also while 'walk' lasts; with '# right "
              "arm' it would leave that the rest"});
  CHECK(ml::whole_body_warnings(timelines("walk # 0 # 3\nwave with the right hand # 1 # 2 # right arm\n")).empty());
}

TEST_CASE("texts of several actions, and long texts") {
  const auto several = timelines("walk, then turn # 0 # 2\n");
  CHECK(
      ml::several_action_warnings(several, {.in_turn = "--in-turn"}) ==
      Lines{"'walk, then turn' is made as one text, of which a model may do a part; --in-turn makes its 2 actions one "
            "after the other"});
  CHECK(ml::in_turn_notes(several, 20) == Lines{"'walk, then turn': 2 s for 'walk', then 'turn'"});
  CHECK(ml::several_action_warnings(timelines("walk # 0 # 2\n")).empty());
  CHECK(ml::in_turn_notes(timelines("walk # 0 # 2\n"), 20).empty());
  CHECK(ml::long_text_warnings(timelines("walk # 0 # 17\n"), 20) ==
        Lines{"'walk': 17 s are made in parts of at most 8 s, which is what models learn from"});
  CHECK(ml::long_text_warnings(timelines("walk # 0 # 8\n"), 20).empty());
}

TEST_CASE("a model gets the warnings that concern it") {
  const auto long_and_several = timelines("walk, then turn # 0 # 17\n");
  fake::Model model;
  const auto count = [&](const ml::GenerateOptions& options = {}, bool in_turn = false) {
    return ml::timeline_warnings(model, long_and_several, options, in_turn).size();
  };
  CHECK(count() == 0);  // no diffusion model
  model.diffusion_steps = 10;
  CHECK(count() == 1);  // its words are not known: long only
  model.known = ml::KnownWords({"walk"});
  CHECK(count() == 2);
  CHECK(count({.cut_texts = false}) == 1);
  CHECK(count({}, true) == 1);
  model.actions = true;
  CHECK(count() == 1);
}
