// Data of evaluations: entries with their texts, pairs that training lacks, long motions of several clips.
#include <doctest/doctest.h>

#include <motionlang/train/measured_items.hpp>
#include <motionlang/train/moment_evaluation.hpp>
#include <motionlang/train/text_entries.hpp>

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
