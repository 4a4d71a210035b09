// motionlang figure: pictures of timelines, bodies, tables, moments and words.
#include <doctest/doctest.h>

#include <motionlang/formats/bvh.hpp>

#include "../support/markup.hpp"
#include "../support/synthetic_motion.hpp"
#include "small_workplace.hpp"

TEST_CASE("figure: each kind writes its picture") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  ml::write_file(w / "t.tsv", std::string_view("frames\tfixed\n40\t85\n60\t91\n"));
  ml::write_file(w / "c.tsv", std::string_view("clip\t0\t2\tlegs\twalk | hop on\n"));
  const std::filesystem::path examples = MOTIONLANG_EXAMPLES;
  const auto drawn = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "figure");
    arguments.insert(arguments.end(), {"-o", "f.svg"});
    const Outcome made = w.run(arguments);
    REQUIRE_MESSAGE((made.code == 0 && contains(made.text, "f.svg\n")), made.text);
    const std::string svg = ml::read_file(w / "f.svg");
    CHECK(is_well_formed(svg));
    return svg;
  };
  CHECK(contains(drawn({"timelines", "two.txt"}), "raise both arms"));
  ml::write_file(w / "long.txt", std::string_view("walk forward # 0 # 30 # legs\n"));
  CHECK(drawn({"timelines", "long.txt", "--cut-texts"}) != drawn({"timelines", "long.txt"}));
  const std::string part = drawn({"bodies", "walk.bvh", "--timeline", "two.txt", "--poses", "4"});
  CHECK(occurrences(part, "class=\"pose\"") == 4);
  CHECK(part != drawn({"bodies", "walk.bvh", "--timeline", "two.txt", "--poses", "4", "--colours", "newest"}));
  CHECK(contains(drawn({"curves", "t.tsv"}), ">fixed<"));
  const std::string moments = drawn(
      {"moments", "walk.bvh", "--text", "a person walks", "--truth", "0.5-1.5", "--text", "sit", "--truth", "0-1"});
  CHECK(occurrences(moments, "class='shaded'") == 2);
  CHECK(occurrences(moments, "class='mark'") == 2);
  CHECK(contains(moments, "a person walks"));
  CHECK(contains(drawn({"words", "c.tsv", (examples / "training/captions.tsv").string(), "--most", "5"}), ">c.tsv<"));
  CHECK(contains(ml::read_file(w / "f_verbs.svg"), ">walk<"));
  std::filesystem::create_directories(w / "KIT-ML/texts");
  ml::write_file(w / "KIT-ML/all.txt", std::string_view("00001\n"));
  ml::write_file(w / "KIT-ML/texts/00001.txt",
                 std::string_view("a man walks slowly#a/DET man/NOUN walk/VERB slowly/ADV#0.0#0.0\n"));
  const Outcome phrases = w.run({"figure", "words", "KIT-ML/", "-o", "f.svg"});
  CHECK_MESSAGE(contains(phrases.text, "KIT-ML: 1 text, 4 words, 0 verbs; 1 action phrase"), phrases.text);
}

TEST_CASE("figure: what cannot be drawn") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto refused = [&](std::vector<std::string> arguments, int code, const char* why) {
    arguments.insert(arguments.begin(), "figure");
    const Outcome made = w.run(arguments);
    CHECK_MESSAGE((made.code == code && contains(made.text, why)), made.text);
  };
  refused({"moments", "walk.bvh", "--text", "a", "--text", "b", "--truth", "1-2", "-o", "f.svg"}, 2,
          "--truth has 1 ranges for 2 texts");
  refused({"moments", "walk.bvh", "--text", "a", "--truth", "2-1", "-o", "f.svg"}, 2, "is not a time range");
  refused({"timelines", "two.txt", "-o", "two.txt"}, 2, "is an input");
  refused({"curves", "two.txt", "-o", "f.svg"}, 1, "two.txt:1:");
  refused({}, 2, "");
}
