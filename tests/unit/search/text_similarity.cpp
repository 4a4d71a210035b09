// The similarity of a text and a motion over time.
#include <motionlang/search/text_similarity.hpp>

#include <doctest/doctest.h>

#include <cmath>

#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

/// Two numbers for a window: its mean height of the root and 1. The text "high" is (1, 0), others are (0, 1).
struct Heights final : ml::SearchEncoder {
  ml::IndexModel about{.id = "", .path = "", .text_encoder = "", .width = 2, .fps = 20};
  const ml::IndexModel& model() const override { return about; }
  std::vector<float> encode_texts(std::span<const std::string> texts) const override {
    std::vector<float> out;
    for (const std::string& t : texts) out.insert(out.end(), {t == "high" ? 3.0f : 0.0f, t == "high" ? 0.0f : 2.0f});
    return out;
  }
  std::vector<float> rows_of(const ml::Motion& motion) const override {
    std::vector<float> out;
    for (const auto& p : motion.root) out.push_back(static_cast<float>(p.y));
    return out;
  }
  ml::Index frames(std::span<const float> rows) const override { return std::ssize(rows); }
  std::vector<float> encode_windows(std::span<const float> rows,
                                    std::span<const ml::FrameSlice> windows) const override {
    std::vector<float> out;
    for (const ml::FrameSlice& w : windows) {
      float sum = 0;
      for (ml::Index f = w.first; f < w.first + w.length; ++f) sum += rows[static_cast<std::size_t>(f)];
      out.insert(out.end(), {sum / static_cast<float>(w.length), 1.0f});
    }
    return out;
  }
};

}  // namespace

TEST_CASE("a window around each frame is compared with the text") {
  ml::Motion motion = synthetic::walk({.frames = 60});
  for (std::size_t f = 0; f < 60; ++f) motion.root[f].y = f >= 30 && f < 40 ? 2 : 0.5;
  const Heights encoder;
  const auto high = ml::text_similarity(encoder, "high", motion, 10);
  REQUIRE(high.similarity.size() == 60);
  CHECK(high.fps == 20);
  CHECK(high.similarity[0] == doctest::Approx(0.5 / std::hypot(0.5, 1)));
  CHECK(high.best == 35);  // the window of frames 30 to 39
  CHECK(high.similarity[35] == doctest::Approx(2 / std::hypot(2, 1)));
  CHECK(high.windows[35].first == 30);
  const auto low = ml::text_similarity(encoder, "low", motion, 10);
  CHECK(low.best == 0);
  CHECK(low.similarity[0] == doctest::Approx(1 / std::hypot(0.5, 1)));
  CHECK_THROWS_WITH_AS(ml::text_similarity(encoder, "low", motion, 0), doctest::Contains("101"), ml::config_error);
  motion.root.clear(), motion.local.clear();
  CHECK_THROWS_WITH_AS(ml::text_similarity(encoder, "low", motion, 5), doctest::Contains("has no frames"),
                       ml::numeric_error);
}
