// Queries in everyday words: the rules by which a result is right.
#include <doctest/doctest.h>

#include <motionlang/search/query_bench.hpp>

#include "../../support/check_error.hpp"
#include "../../support/speed_encoder.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

using Texts = std::vector<std::string>;

/// Clips of these speeds, with captions.
ml::MotionIndex index_of(const std::vector<std::pair<float, Texts>>& clips) {
  ml::MotionIndex out(SpeedEncoder().model());
  for (const auto& [speed, captions] : clips) {
    ml::EncodedClip c{.clip = {.path = "clip", .captions = captions}, .vector = {speed, 1}};
    for (std::size_t i = 0; i < captions.size(); ++i) c.caption_vectors.insert(c.caption_vectors.end(), {speed, 1});
    out.add(std::move(c));
  }
  return out;
}

}  // namespace

TEST_CASE("a table of queries: phrases, comments, and queries that nothing shows") {
  const TemporaryFolder folder;
  const auto read = [&](std::string_view text) {
    ml::write_file(folder / "queries.tsv", text);
    return ml::read_queries(folder / "queries.tsv");
  };
  CHECK(read("# comment\nGo for a walk\twalk | stroll  along\n\nfly\n") ==
        std::vector<ml::MotionQuery>{{"Go for a walk", {"walk", "stroll along"}}, {"fly", {}}});
  CHECK_ERROR(read("walk\twalk\n?\twalk\n"), "queries.tsv:2: a query without words");
  CHECK_ERROR(read("walk\twalk | \n"), "[motionlang.io.403]");
  CHECK_ERROR(ml::read_queries(folder / "none.tsv"), "[motionlang.io.401]");
}

TEST_CASE("a caption says a phrase in other forms of its words, one after the other") {
  CHECK(ml::says("A man is waving", "wave"));
  CHECK(ml::says("she sits down slowly", "sit down"));
  CHECK_FALSE(ml::says("down she sits", "sit down"));
  CHECK_FALSE(ml::says("the site", "sit"));
  CHECK_FALSE(ml::says("walk", ""));
}

TEST_CASE("at least half of the captions have to say it") {
  const ml::MotionQuery query{"jog a bit", {"run", "jog"}};
  CHECK(ml::shows({"running", "a man jogs"}, query));
  CHECK(ml::shows({"running", "dash ahead"}, query));
  CHECK_FALSE(ml::shows({"running", "dash", "speed"}, query));
  CHECK_FALSE(ml::shows({}, query));
  CHECK_FALSE(ml::shows({"run"}, {"fly", {}}));
}

TEST_CASE("the first result among clips with captions is judged; nothing shown is right where nothing is asked for") {
  SpeedEncoder encoder;
  const auto index = index_of({{1, {"walk ahead"}}, {3, {"run ahead"}}, {5, {}}});
  const std::vector<ml::MotionQuery> queries{
      {"slowly 1", {"walk"}}, {"quickly 3", {"run"}}, {"quicker 5", {"fly"}}, {"nothing 9", {}}};
  auto answers = ml::answer_queries(index, encoder, queries);
  REQUIRE(answers.size() == 4);
  CHECK(answers[0].right);
  CHECK(answers[1].right);
  CHECK(answers[1].found.captions.front() == "run ahead");
  CHECK_FALSE(answers[2].right);
  CHECK(answers[2].found.captions.front() == "run ahead");  // 5 has no captions
  CHECK_FALSE(answers[3].right);                            // something is shown
  encoder.scale = {.shares = {0, 1}, .cosines = {-1, 1}, .least = 0.999999};
  answers = ml::answer_queries(index, encoder, queries);
  CHECK(answers[1].right);
  CHECK_FALSE(answers[3].shown);
  CHECK(answers[3].right);
  CHECK_ERROR(ml::answer_queries(index_of({{1, {"Walk 1"}}}), encoder, {{"walk, 1", {"walk"}}}),
              "[motionlang.config.102] answer_queries: 'walk, 1' is a caption of a clip");
  CHECK_ERROR(ml::answer_queries(index_of({{1, {}}}), encoder, queries), "[motionlang.config.101]");
}

TEST_CASE("answers are lines, and the numbers of right ones") {
  std::vector<ml::QueryAnswer> answers(3);
  ml::IndexedClip walk;
  walk.captions = {"a man walks"};
  answers[0] = {.query = {"go for a walk", {"walk"}}, .found = walk, .score = 0.5, .right = true};
  answers[1] = {.query = {"sit", {"sit"}}, .found = walk, .score = 0.25};
  answers[2] = {.query = {"fly", {}}, .found = {}, .score = 0.125, .shown = false, .right = true};
  CHECK(ml::describe_query_answers(answers) ==
        "right 0.5000  go for a walk                                \"a man walks\"\n"
        "wrong 0.2500  sit                                          \"a man walks\"\n"
        "right 0.1250  fly                                          no clip shows this\n"
        "the first result is right for 1 of 2 queries\n"
        "no clip shows this is the answer to 1 of 1 queries that nothing shows\n");
  CHECK(ml::describe_query_answers({}).empty());
}
