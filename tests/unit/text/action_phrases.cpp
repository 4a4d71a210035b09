// Action phrases: verbs with the words that belong to them.
#include <motionlang/text/action_phrases.hpp>

#include <doctest/doctest.h>

namespace {

namespace ml = motionlang;

using Words = std::vector<ml::TaggedWord>;
using Phrases = std::vector<std::string>;

TEST_CASE("a phrase is a verb and what follows, up to the next verb, auxiliary, conjunction or mark") {
  CHECK(ml::action_phrases(
            Words{{"a", "DET"}, {"person", "NOUN"}, {"is", "AUX"}, {"walk", "VERB"}, {"forward", "ADV"}}) ==
        Phrases{"walk forward"});
  CHECK(ml::action_phrases(Words{{"he", "PRON"},
                                 {"kick", "VERB"},
                                 {"with", "ADP"},
                                 {"his", "PRON"},
                                 {"left", "ADJ"},
                                 {"leg", "NOUN"},
                                 {"and", "CCONJ"},
                                 {"the", "DET"},
                                 {"man", "NOUN"},
                                 {"fall", "VERB"},
                                 {".", "PUNCT"},
                                 {"slowly", "ADV"}}) == Phrases{"kick with left leg", "fall"});
  CHECK(ml::action_phrases(Words{{"start", "VERB"}, {"run", "VERB"}}) == Phrases{"start", "run"});
  CHECK(ml::action_phrases(Words{{"slowly", "ADV"}, {"walk", ""}}).empty());
}

TEST_CASE("phrases are counted") {
  Phrases phrases{"walk forward", "walk forward", "jump", "kick ball"};
  CHECK(ml::PhraseCounts(phrases).text() ==
        "3 action phrases, 1.33 times on average; 'walk forward' most often, 2 times; 3 less than ten times, 2 once");
  phrases.insert(phrases.end(), 8, "walk forward");
  const ml::PhraseCounts counts(phrases);
  CHECK(counts.times.at("walk forward") == 10);
  CHECK(counts.below(10) == 2);
  CHECK(ml::PhraseCounts(Phrases{}).text().empty());
}

}  // namespace
