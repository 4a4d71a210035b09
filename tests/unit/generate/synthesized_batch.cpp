#include <motionlang/generate/synthesized_batch.hpp>

#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>

#include "fake_models.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;

namespace {

/// Keeps the timelines that it is asked for, and walks as long as they are.
struct Walker final : ml::MotionModel {
  mutable std::vector<ml::Timeline> asked{};
  double fps() const override { return 40; }
  std::string system() const override { return "a walker"; }

 private:
  std::vector<ml::Motion> make(std::span<const ml::Timeline> all, const ml::GenerateOptions&) const override {
    asked.assign(all.begin(), all.end());
    std::vector<ml::Motion> out;
    for (const ml::Timeline& t : all) out.push_back(synthetic::walk({.frames = static_cast<int>(t.end()), .fps = 40}));
    return out;
  }
};

}  // namespace

TEST_CASE("motions are generated for the texts of a batch, as long as its motions") {
  const ml::MotionFeatures& features = ml::motion_features("smplrifke");
  const Walker model;
  const ml::TextMotionBatch<B> batch{{"walk", "run"},
                                     {ml::Tensor<B, 2>::zeros({40, features.width}), ml::Offsets{30, 10}}};
  auto normalizer = ml::Normalizer<B>::identity(features.width);
  const auto rows = ml::synthesized_batch(model, batch, features, normalizer, 3);
  REQUIRE(model.asked.size() == 2);
  CHECK(model.asked[0].intervals[0].text == "walk");
  CHECK(model.asked[0].end() == 60);  // at 40 frames per second, of 30 at 20
  CHECK(model.asked[1].end() == 20);
  CHECK(rows.count() == 2);
  CHECK(rows.width() == features.width);
  normalizer.std = normalizer.std * 2.0;
  const auto halved = ml::synthesized_batch(model, batch, features, normalizer, 3);
  CHECK(halved.rows.to_vector()[7] == doctest::Approx(rows.rows.to_vector()[7] / 2));
}
