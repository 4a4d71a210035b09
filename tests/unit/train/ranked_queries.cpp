// The nearest motions of texts, and the page that shows them.
#include <motionlang/train/ranked_queries.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "../../support/markup.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

/// Four texts and motions on a circle, at these angles in degrees.
ml::LatentTable table(const std::vector<double>& texts, const std::vector<double>& motions) {
  const auto add = [](std::vector<float>& to, double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    to.insert(to.end(), {static_cast<float>(3 * std::cos(angle)), static_cast<float>(3 * std::sin(angle))});
  };
  ml::LatentTable out;
  out.width = 2;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    out.texts.push_back("text " + std::to_string(i));
    add(out.text, texts[i]);
    add(out.motion, motions[i]);
  }
  return out;
}
std::vector<ml::DescribedMotion> part_of(std::size_t motions) {
  std::vector<ml::DescribedMotion> out(motions);
  for (std::size_t i = 0; i < motions; ++i) out[i].id = "clip" + std::to_string(i);
  return out;
}

}  // namespace

TEST_CASE("the nearest motions come first, with ranks and similarities of their texts") {
  // text 0 is nearest to motion 1, then to its own; text 2 to its own
  const auto latents = table({0, 90, 180, 270}, {60, 10, 190, 280});
  const std::vector<float> sentences{1, 0, 0.6f, 0.8f, -1, 0, 0, 1};
  const auto queries =
      ml::ranked_queries(latents, ml::Rows<float>(sentences, 2), part_of(4), {.queries = 2, .motions = 3});
  REQUIRE(queries.size() == 2);
  CHECK((queries[0].text == "text 0" && queries[1].text == "text 2"));
  CHECK((queries[0].rank == 2 + 0 && queries[1].rank == 1));
  REQUIRE(queries[0].motions.size() == 3);
  const auto& first = queries[0].motions[0];
  CHECK((first.id == "clip1" && first.text == "text 1" && !first.own && first.number == 1));
  CHECK(first.similarity == doctest::Approx((1 + std::cos(10 * std::numbers::pi / 180)) / 2));
  CHECK(first.text_similarity == doctest::Approx(0.8));
  const auto& second = queries[0].motions[1];
  CHECK((second.id == "clip0" && second.own && second.text_similarity == doctest::Approx(1)));
  CHECK((queries[1].motions[0].own && queries[1].motions[0].id == "clip2"));
  CHECK(ml::ranked_queries(latents, ml::Rows<float>(sentences, 2), part_of(4)).size() == 4);
  CHECK_ERROR(ml::ranked_queries(latents, ml::Rows<float>(sentences, 2), part_of(3)), "[motionlang.shape.204]");
}
