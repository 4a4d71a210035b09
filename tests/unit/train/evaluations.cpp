// Data of evaluations: entries with their texts, pairs that training lacks, long motions of several clips.
#include <doctest/doctest.h>

#include <algorithm>

#include <motionlang/backend/usual.hpp>
#include <motionlang/train/guo_evaluation.hpp>
#include <motionlang/train/measured_items.hpp>
#include <motionlang/train/moment_evaluation.hpp>
#include <motionlang/train/recognition.hpp>
#include <motionlang/train/text_entries.hpp>
#include <motionlang/view/loss_curves.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

namespace {

ml::DescribedMotion described(const std::string& id, std::vector<std::pair<std::string, ml::FrameSlice>> texts,
                              ml::Index frames, float value) {
  ml::DescribedMotion out{id, id, std::vector<float>(static_cast<std::size_t>(2 * frames), value), {}};
  for (auto& [text, slice] : texts) out.texts.push_back({text, slice});
  return out;
}

}  // namespace

TEST_CASE("texts about the same frames are one entry") {
  const std::vector<ml::DescribedMotion> part{
      described("a", {{"walk", {0, 10}}, {"a person walks", {0, 10}}, {"turn", {4, 6}}}, 10, 1),
      described("b", {{"sit", {0, 5}}}, 5, 2)};
  const auto entries = ml::text_entries(part, "test");
  REQUIRE(entries.size() == 3);
  std::size_t texts = 0;
  for (const ml::TextEntry& e : entries) {
    texts += e.texts.size();
    CHECK(e.texts.size() == (e.motion == &part[0] && e.frames.length == 10 ? 2u : 1u));
    CHECK(ml::entry_rows(e, 1, 2, 2).size() == 4);
    CHECK(ml::entry_rows(e, 1, 2, 2).front() == (e.motion == &part[0] ? 1.0f : 2.0f));
  }
  CHECK(texts == 4);
  CHECK_ERROR(ml::text_entries({}, "test"), "[motionlang.config.101]");
}

TEST_CASE("pairs of labels that training lacks, in whatever order, without 'stand'") {
  const ml::UnseenPairs unseen({described("a", {{"walk", {}}, {"wave", {}}}, 1, 0)});
  CHECK(!unseen.has(described("b", {{"wave", {}}, {"walk", {}}}, 1, 0)));
  CHECK(unseen.has(described("c", {{"wave", {}}, {"wave", {}}}, 1, 0)));
  CHECK(unseen.has(described("d", {{"walk", {}}, {"turn", {}}}, 1, 0)));
  CHECK(!unseen.has(described("e", {{"walk", {}}, {"stand", {}}}, 1, 0)));
}

TEST_CASE("clips of different texts are joined, with the stretch of each") {
  std::vector<ml::DescribedMotion> motions;
  for (int i = 0; i < 4; ++i)
    motions.push_back(described("clip" + std::to_string(i), {{"text" + std::to_string(i % 3), {2, 3 + i}}}, 10,
                                static_cast<float>(i)));
  const auto joined = ml::join_random_clips(motions, 2, 3, ml::Philox{.seed = 1});
  REQUIRE(joined.texts.size() == 3);
  CHECK(std::set<std::string>(joined.texts.begin(), joined.texts.end()).size() == 3);
  ml::Index at = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(joined.stretches[i].first == at);
    const float value = joined.rows[static_cast<std::size_t>(2 * at)];
    CHECK(joined.stretches[i].length == 3 + static_cast<ml::Index>(value));  // of the clip with these rows
    CHECK(joined.texts[i] == "text" + std::to_string(static_cast<int>(value) % 3));
    at += joined.stretches[i].length;
  }
  CHECK(std::ssize(joined.rows) == 2 * at);
  CHECK(ml::join_random_clips(motions, 2, 5, ml::Philox{.seed = 1}).texts.size() == 3);  // there are no more texts
  CHECK(ml::join_random_clips(motions, 2, 3, ml::Philox{.seed = 1}).rows == joined.rows);
}

TEST_CASE("tables have a column for each measure, and '-' for what is not measured") {
  const ml::MomentFigures moments{{{0, 10}, {10, 10}},
                                  {{"1 s", {{0, 10}, {14, 10}}}, {"a random window", {{5, 10}, {0, 10}}}}};
  CHECK(ml::moments_table(moments) ==
        "  windows                    0.1     0.2     0.3     0.4     0.5     0.6     0.7\n"
        "  1 s                     100.00  100.00  100.00  100.00   50.00   50.00   50.00\n"
        "  a random window          50.00   50.00   50.00    0.00    0.00    0.00    0.00\n");

  const std::string recognised =
      ml::recognition_table({{"accuracy_gt", {0.9, 0.92}}, {"fid_gen", {1.5, 1.5}}, {"diversity_gt", {7, 7}}});
  CHECK(recognised.find("\n  recorded                  91.00 +-1.96 -            7.00 +-0.00  -           \n") !=
        std::string::npos);
  CHECK(recognised.find("\n  generated                 -            1.50 +-0.00  -            -           \n") !=
        std::string::npos);
  CHECK(std::ranges::count(recognised, '\n') == 6);

  ml::GuoFigures figures;
  for (const char* row : {"recorded", "recorded, of other texts", "generated"}) figures.values[row]["R@1"] = {0.5, 0.5};
  figures.values["generated"]["FID"] = {2, 4};  // 3 +- 1.96 / sqrt(2)
  const std::string judged = ml::guo_table(figures);
  CHECK(judged.find(
            "\n  generated                0.500 +-0.000     -                 -                 3.000 +-1.386 ") !=
        std::string::npos);
  CHECK(judged.find("\n  recorded                 0.500 +-0.000     -                 -                 - ") !=
        std::string::npos);
}

TEST_CASE("a sequence with several texts: each is a stretch of it") {
  const auto sequence = described("s", {{"walk", {0, 6}}, {"wave", {4, 3}}}, 10, 1);
  const auto joined = ml::as_joined(sequence);
  CHECK(joined.rows == sequence.rows);
  CHECK(joined.texts == std::vector<std::string>{"walk", "wave"});
  CHECK(joined.stretches[1] == ml::FrameSlice{4, 3});
}

TEST_CASE("accuracy and FID of motions of several lengths are two panels of curves") {
  const std::vector<ml::DurationResult> results{{40, {0.5, 0.7}, {3, 5}}, {60, {1, 1}, {1.5, 0.5}}};
  const auto panels = ml::parse_curves(ml::duration_table(results));
  REQUIRE(panels.size() == 2);
  CHECK(panels[0].title == "accuracy %");
  CHECK(panels[0].axis == "frames");
  CHECK(panels[0].curves.at(0).steps == std::vector<double>{40, 60});
  CHECK(panels[0].curves.at(0).values == std::vector<double>{60, 100});
  CHECK(panels[1].title == "FID");
  CHECK(panels[1].curves.at(0).values == std::vector<double>{4, 1});
}
