// The report of a timeline for editors: texts, times, parts, and each warning with the texts that it is about.
#include <motionlang/generate/timeline_report.hpp>

#include <doctest/doctest.h>

#include <motionlang/file/json.hpp>

#include "fake_models.hpp"

namespace ml = motionlang;
using nlohmann::json;

namespace {

json report(const ml::MotionModel& model, const char* text) { return json::parse(ml::timeline_report(model, text)); }

}  // namespace

TEST_CASE("texts with their times in seconds and their parts") {
  const fake::Model model;
  const json r = report(model, "walk # 1 # 4.2 # legs\nwave # 2.125 # 3 # right arm # left arm\nstand # 4 # 6\n");
  CHECK(r["fps"] == 20);
  CHECK(r["seconds"] == 5);  // from the first start
  CHECK(r["texts"] == json::parse(R"([
    {"text": "walk", "start": 0.0, "end": 3.2, "parts": ["legs"]},
    {"text": "wave", "start": 1.125, "end": 2.0, "parts": ["left arm", "right arm"]},
    {"text": "stand", "start": 3.0, "end": 5.0, "parts": ["whole body"]}])"));
  CHECK(r["warnings"] == json::array());
}

TEST_CASE("a warning has the numbers of its texts, and does not repeat their place") {
  fake::Model model;
  model.known = ml::KnownWords({"walk"}), model.diffusion_steps = 5;
  const json r = report(model,
                        "dance # 0 # 2 # legs\n"
                        "walk # 2 # 4\n"
                        "dance # 2 # 4 # head\n"
                        "walk # 2 # 4\n");
  REQUIRE(r["warnings"].size() == 2);
  CHECK(r["warnings"][0]["texts"] == json{0, 2});  // once for both
  CHECK(r["warnings"][0]["message"] == "'dance': the model never learned the word 'dance'");
  CHECK(r["warnings"][1]["texts"] == json{1});
  CHECK(r["warnings"][1]["message"] == "'walk' moves nothing: other texts take all its body parts");
}

TEST_CASE("a text that cannot be read is an error with its place") {
  const fake::Model model;
  CHECK_THROWS_WITH_AS(ml::timeline_report(model, "walk # 0\nsit # 1 # 2\n"), doctest::Contains("timeline:1:"),
                       ml::timeline_error);
  CHECK_THROWS_AS(ml::timeline_report(model, ""), ml::timeline_error);
  CHECK_THROWS_AS(ml::timeline_report(model, "walk # 0 # 1\n\nsit # 0 # 1\n"), ml::timeline_error);  // two
}

TEST_CASE("known texts for an editor") {
  const std::vector<ml::KnownText> texts{{"walk", {3, true, ""}}, {"sit down", {2.5, false, "sit"}}};
  CHECK(ml::known_texts_report(texts) ==
        R"([{"text":"walk","seconds":3.0,"repeats":true},{"text":"sit down","seconds":2.5,"repeats":false}])");
  CHECK(ml::known_texts_report({}) == "[]");
}
