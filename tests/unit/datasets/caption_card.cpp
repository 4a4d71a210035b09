// The numbers of a table of captions: clips, seconds with and without overlaps, different captions, verbs.
#include <motionlang/datasets/caption_card.hpp>

#include <limits>

#include <doctest/doctest.h>

namespace ml = motionlang;

TEST_CASE("commands begin with their verbs") {
  CHECK(ml::commanded_verb("walk along") == "walk");
  CHECK(ml::commanded_verb("Swing both arms") == "swing");
  CHECK(ml::commanded_verb("do push-ups") == "do");
  for (const char* other : {"", "a person walks", "walking along", "doing sit-ups", "someone walks", "the figure sits"})
    CHECK(ml::commanded_verb(other).empty());
}

TEST_CASE("segments, clips, seconds and verbs of a table, and of its folders") {
  const auto line = [](const char* clip, double start, double end, std::vector<std::string> texts) {
    ml::ClipLine l;
    l.clip = clip, l.start = start, l.end = end, l.texts = std::move(texts);
    return l;
  };
  const auto card = ml::caption_card(
      {line("a/one", 0, 3, {"walk along", "walk, then sit"}), line("a/one", 2, 5, {"walk along", "a man sits"}),
       line("b/x.glb#Sit", 0, 1.5, {"sit"}), line("b/x.glb#Wave", 0.5, 1, {"wave", "wave hello"}),
       line("whole", 0, std::numeric_limits<double>::infinity(), {"jump"})});
  CHECK(card.all.segments == 5);
  CHECK(card.all.clips.size() == 4);
  CHECK(card.all.captions == 8);
  CHECK(card.captions.size() == 7);
  CHECK(card.all.seconds == doctest::Approx(8));
  CHECK(card.all.without_overlap == doctest::Approx(7));
  CHECK(card.words.contains("then"));
  CHECK(!card.words.contains("walk,"));
  CHECK(card.verbs == std::map<std::string, std::size_t>{{"walk", 2}, {"sit", 1}, {"wave", 1}, {"jump", 1}});
  REQUIRE(card.folders.size() == 3);
  CHECK(card.folders.at("a").without_overlap == doctest::Approx(5));
  CHECK(card.folders.at("b/x.glb").clips.size() == 2);
  CHECK(card.folders.at("b/x.glb").seconds == doctest::Approx(2));
  CHECK(card.folders.at(".").seconds == 0);
}

TEST_CASE("a card as lines: folders, all, the verbs in the order of their number") {
  ml::ClipLine line;
  line.clip = "a/one", line.start = 0, line.end = 90, line.texts = {"walk along", "sit"};
  ml::ClipLine other = line;
  other.clip = "b/two", other.texts = {"sit"};
  const std::string text = ml::describe_card(ml::caption_card({line, other}));
  const std::string a =
      "  a                                                        1 clips      1 segments     1.5 min     1.5 min "
      "without overlaps       2 captions\n";
  CHECK(text.starts_with(a));
  CHECK(text.find("\n  all                                                      2 clips      2 segments     3.0 min") !=
        std::string::npos);
  CHECK(text.ends_with(
      "2 different captions, 3 different words, 2 verbs with the segments that show them:\n  sit 2 walk 1\n"));
}

TEST_CASE("verbs of as many segments are in alphabetical order") {
  ml::ClipLine line;
  line.clip = "a/one", line.start = 0, line.end = 90;
  std::string expected = " ";
  for (char c = 'z'; c >= 'h'; --c) line.texts.emplace_back(3, c);
  for (char c = 'h'; c <= 'z'; ++c) expected += " " + std::string(3, c) + " 1";
  CHECK(ml::describe_card(ml::caption_card({line})).ends_with("show them:\n" + expected + "\n"));
}
