// The text form of timelines: what is read, what is refused and where, what is written.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/timeline.hpp>
#include <motionlang/compose/timeline_text.hpp>

namespace ml = motionlang;
using enum ml::BodyPart;

namespace {

ml::BodyParts parts(std::initializer_list<ml::BodyPart> list) {
  ml::BodyParts out;
  for (ml::BodyPart p : list) out = out.with(p);
  return out;
}

/// The message of the timeline_error, without its family.
std::string refusal(std::string_view text, const ml::TimelineTextOptions& options = {}) {
  try {
    ml::parse_timelines(text, options);
    return "accepted";
  } catch (const ml::timeline_error& e) {
    return std::string(e.what()).substr(std::string("[motionlang.timeline.").size());
  }
}

constexpr std::string_view example =  // in the form of STMC's demo files
    "stroll along a wall # 0.0 # 5.5 # legs\n"
    "crouch quickly # 5.5 # 8.0 # legs # spine\n"
    "scratch the chin # 2.25 # 6.5 # right arm # head\n"
    "\n"
    "swim on the floor # 1.0 # 4.0 # legs # left arm # right arm\n";

}  // namespace

TEST_CASE("the example of the specification") {
  const auto timelines = ml::parse_timelines(example, {.fps = 20});
  REQUIRE(timelines.size() == 2);
  CHECK(timelines[0].intervals == std::vector<ml::Interval>{{"stroll along a wall", 0, 110, parts({legs})},
                                                            {"crouch quickly", 110, 160, parts({legs, spine})},
                                                            {"scratch the chin", 45, 130, parts({right_arm, head})}});
  CHECK(timelines[1].intervals ==
        std::vector<ml::Interval>{{"swim on the floor", 0, 60, parts({legs, left_arm, right_arm})}});
  CHECK(timelines[0].end() == 160);
}

TEST_CASE("spaces, synonyms, repeated parts, signs") {
  const auto t = ml::parse_timeline("\t walk  slowly #+0.5#1e0 #left leg# right leg #  legs\nnod#-0.5#0.99#neck#torso");
  CHECK(t.intervals ==
        std::vector<ml::Interval>{{"walk  slowly", 20, 30, parts({legs})}, {"nod", 0, 29, parts({head, spine})}});
  CHECK(ml::parse_timeline("# 0 # 1").intervals == std::vector<ml::Interval>{{"", 0, 20, ml::BodyParts::all()}});
  CHECK(ml::parse_timeline("\xEF\xBB\xBFwave # 0 # 1 # left hand").intervals.front().text == "wave");
}

TEST_CASE("line ends of all systems; lines of spaces are blank") {
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const std::string e = end;
    const std::string text = e + "  " + e + "a # 0 # 1" + e + "b # 0 # 2" + e + " \t" + e + e + "c # 0 # 3";
    const auto timelines = ml::parse_timelines(text);
    REQUIRE(timelines.size() == 2);
    CHECK(timelines[0].intervals.size() == 2);
    CHECK(timelines[1].intervals.front().text == "c");
    CHECK(ml::parse_timelines(text + e + e).size() == 2);
  }
}

TEST_CASE("every mistake is found, with line and column") {
  const ml::TimelineTextOptions file{.name = "mtt.txt"};
  CHECK(refusal("walk # 0.0 # 2.0\n\nwave", file) == "501] mtt.txt:3:5: expected 'text # start # end # body parts'");
  CHECK(refusal("wave # 0.0", file).starts_with("501] mtt.txt:1:11: "));
  CHECK(refusal("wave # a # 2.0 # legs", file) == "502] mtt.txt:1:8: 'a' is not a time in seconds");
  CHECK(refusal("wave # 0 # 2.0s", file).starts_with("502] mtt.txt:1:12: '2.0s'"));
  CHECK(refusal("wave # 0 # ", file).starts_with("502] mtt.txt:1:11: ''"));
  CHECK(refusal("gr\xC3\xBC\xC3\x9F"
                "en # 0 # nan",
                file)
            .starts_with("502] mtt.txt:1:14: "));  // columns are characters
  for (const char* time : {"inf", "-inf", "1e10", "1e400", "0x10", "++1", "+-1", "1,5", "1 2", "--1"}) {
    CHECK_MESSAGE(refusal(ml::concat_text("wave # 0 # ", time)).starts_with("502]"), time);
  }
  CHECK(refusal("ok # 0 # 1\r\nwave # 0.0 # 2.0 # legs # right foot", file) ==
        "503] mtt.txt:2:27: 'right foot' is not a body part (left arm, right arm, legs, head, spine)");
  CHECK(refusal("wave # 0.0 # 2.0 # right arm #", file).starts_with("503] mtt.txt:1:31: ''"));
  CHECK(refusal("wave # 0.0 # 2.0 # Legs", file).starts_with("503]"));
  CHECK(refusal("wave # 2 # 1 # legs", file) ==
        "504] mtt.txt:1:12: the interval 2 to 1 s is empty or ends before it starts");
  CHECK(refusal("wave # 1 # 1").starts_with("504]"));
  // at 20 fps
  CHECK(refusal("wave # 1.01 # 1.02", file) == "504] mtt.txt:1:15: the interval 1.01 to 1.02 s has no frame");
  CHECK(refusal("", file) == "507] mtt.txt: no line");
  CHECK(refusal(" \n\n\t\n").starts_with("507]"));
  CHECK(refusal("a # -4e7 # -3e7\nb # 3e7 # 4e7", file).starts_with("502] mtt.txt:2:1: a timeline that lasts "));
  CHECK(refusal("w\xE4lk # 0 # 1", file) == "501] mtt.txt:1:1: the text is not UTF-8");
  CHECK_THROWS_WITH_AS(ml::parse_timeline("a # 0 # 1\n\n b # 0 # 1"),
                       doctest::Contains("[motionlang.timeline.509] timeline:3:2: 2 timelines where one is expected"),
                       ml::timeline_error);
  CHECK_THROWS_WITH_AS(ml::parse_timelines("a # 0 # 1", {.fps = 0}), doctest::Contains("[motionlang.config.101]"),
                       ml::config_error);
}

TEST_CASE("intervals without a frame are taken when asked to, as by the published reader") {
  const auto t = ml::parse_timeline("a # 0 # 2\nb # 1 # 1\nc # 2 # 1", {.as_published = true});
  CHECK(t.intervals[1].start == 20);
  CHECK(t.intervals[1].end == 20);
  CHECK(t.intervals[2].end == 20);
}

TEST_CASE("frames are truncated in double precision, and seconds come back to the same frames") {
  CHECK(ml::frame_at(2.999, 20) == 59);
  CHECK(ml::frame_at(-0.99, 20) == -19);
  CHECK(ml::frame_at(0.29, 100) == 28);  // 100 * 0.29 = 28.999999999999996
  CHECK_THROWS_WITH_AS(ml::frame_at(1e9, 20), doctest::Contains("[motionlang.config.101]"), ml::config_error);
  for (double fps : {20.0, 30.0, 12.5, 59.94, 120.0, 7.3}) {
    ml::Timeline t;
    for (ml::Index f = 0; f < 3000; ++f) t.intervals.push_back({"x", f, 3 * f + 1, {}});
    CHECK(ml::to_frames(ml::to_seconds(t, fps), fps) == t);
  }
}

TEST_CASE("lists of single texts") {
  CHECK(ml::is_text_list("dance like a crab # 4.0\n\nbow deeply#2.35\n"));
  CHECK_FALSE(ml::is_text_list(example));
  CHECK_FALSE(ml::is_text_list("\n"));
  CHECK(ml::parse_text_list("dance like a crab # 4.0\n\nbow deeply#2.35\n") ==
        std::vector<ml::TimedText>{{"dance like a crab", 80}, {"bow deeply", 47}});
  const auto throws = [](std::string_view text, const char* message) {
    CHECK_THROWS_WITH_AS(ml::parse_text_list(text, {.name = "list"}), doctest::Contains(message), ml::timeline_error);
  };
  throws("a # 1\nb", "[motionlang.timeline.501] list:2:2: ");
  throws("a # 1 # 2", "[motionlang.timeline.503] list:1:9: '2' is not a body part");
  throws("a # x", "[motionlang.timeline.502] list:1:5: ");
  throws("a # 1e9", "[motionlang.timeline.502]");
  throws("a # 0.04", "[motionlang.timeline.504] list:1:5: ");
  throws("", "[motionlang.timeline.507]");
}

TEST_CASE("lists of single texts with body parts: all of them move the whole body") {
  const std::vector<ml::TimedText> wanted{{"wave", 40}, {"bow", 47}, {"turn", 20}};
  const std::string list = "wave # 2.0 # right hand # head\n\nbow#2.35#torso\nturn # 1\n";
  CHECK(ml::is_text_list(list));
  CHECK(ml::parse_text_list(list) == wanted);
  CHECK(ml::is_text_list("wave # 2.0 # legs"));
  CHECK_FALSE(ml::is_text_list("wave # 2.0 # legs", {.as_published = true}));  // no line of two fields
  CHECK_FALSE(ml::is_text_list("wave # 2.0 # legs\nbow # 1 # 2"));
  CHECK_FALSE(ml::is_text_list("wave # 2.0 # wings"));
  CHECK(ml::parse_text_list("wave # 2.0 # wings #", {.as_published = true}) ==
        std::vector<ml::TimedText>{{"wave", 40}});
  CHECK_THROWS_WITH_AS(ml::parse_text_list("wave # 2.0 # wings", {.name = "list"}),
                       doctest::Contains("[motionlang.timeline.503] list:1:14: 'wings' is not a body part"),
                       ml::timeline_error);
}

TEST_CASE("writing has the published form and is read back") {
  const auto timelines = ml::parse_timelines_in_seconds(example);
  const std::string text = ml::write_timelines(timelines);
  CHECK(text ==
        "stroll along a wall # 0.0 # 5.5 # legs\n"
        "crouch quickly # 5.5 # 8.0 # legs # spine\n"
        "scratch the chin # 2.25 # 6.5 # head # right arm\n"
        "\n"
        "swim on the floor # 0.0 # 3.0 # left arm # legs # right arm\n"
        "\n");
  CHECK(ml::parse_timelines_in_seconds(text) == timelines);
  const auto line = [](double t) { return ml::write_timeline({{{"x", 0.0, t, {}}}}); };
  CHECK(line(1e-5) == "x # 0.0 # 1e-05\n\n");
  CHECK(line(0.0001) == "x # 0.0 # 0.0001\n\n");
  CHECK(line(3.0300000000000002) == "x # 0.0 # 3.0300000000000002\n\n");
  CHECK(line(100000) == "x # 0.0 # 100000.0\n\n");
  CHECK(line(1e16) == "x # 0.0 # 1e+16\n\n");
  for (const char* bad : {"a # b", "a\nb", "a\r"}) {
    CHECK_THROWS_WITH_AS(ml::write_timeline({{{bad, 0.0, 1.0, {}}}}), doctest::Contains("[motionlang.timeline.510]"),
                         ml::timeline_error);
  }
}

TEST_CASE("baselines of timelines of every size") {
  const auto one = [](std::string_view text) {
    return ml::write_timeline(ml::one_text(ml::parse_timelines_in_seconds(text, {.as_published = true}).front()));
  };
  CHECK(one("a # 1 # 2 # legs") == "a # 0.0 # 1.0 # legs\n\n");
  CHECK(one("a # 0 # 6 # legs\nb # 6 # 12 # head") == "a and then b # 0.0 # 9.8 # head # legs\n\n");
  // STMC mtt/create_baselines.py: "T0 and then T1 while T2", parts = union
  CHECK(one("a # 0 # 1 # legs\nb # 1 # 2 # head\nc # 0 # 2 # spine\nd # 0 # 3 # left arm\ne # 1 # 2 # legs") ==
        "a and then b while c # 0.0 # 3.0 # head # left arm # legs # spine\n\n");
  CHECK(ml::one_text({}).intervals.empty());
  const auto track = ml::single_track(
      ml::parse_timelines_in_seconds("a # 0 # 1\nb # 2 # 3\nc # 2.5 # 3 # head", {.as_published = true})[0]);
  CHECK(ml::write_timeline(track) == "a # 0.0 # 1.0\nb # 2.0 # 2.5\nb while c # 2.5 # 3.0 # head\n\n");
}
