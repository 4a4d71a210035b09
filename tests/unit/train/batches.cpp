// Batches of motions, the statistics that normalise them, and retrieval over the latents of a whole part.
#include <doctest/doctest.h>

#include <motionlang/backend/reference.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/train/feature_statistics.hpp>
#include <motionlang/train/motion_batch.hpp>
#include <motionlang/train/retrieval_evaluation.hpp>
#include <motionlang/train/text_motion_batch.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

TEST_CASE("motions are normalised by the statistics of all frames") {
  // The second feature never changes: its deviation counts as 1.
  const std::vector<ml::DescribedMotion> motions{{"a", "a", {1, 5, 3, 5}, {}}, {"b", "b", {5, 5}, {}}};
  const auto statistics = ml::statistics_of<B>(motions, 2);
  CHECK(statistics.mean.to_vector() == std::vector<float>{3, 5});
  CHECK(statistics.std.to_vector() == std::vector<float>{2, 1});
  ml::MotionBatch<B> batch(statistics);
  batch.add(motions[0].rows);
  batch.add(motions[0].rows, {1, 1});
  batch.add(motions[1].rows);
  const auto x = batch.normalized();
  CHECK(x.offsets == ml::Offsets{2, 1, 1});
  CHECK(x.rows.to_vector() == std::vector<float>{-1, 0, 0, 0, 0, 0, 1, 0});
}

TEST_CASE("statistics of a folder stand in for those of the motions") {
  const TemporaryFolder folder;
  const std::vector<float> mean{1, 2}, deviation{3, 4};
  ml::write_npy(folder / "Mean.npy", ml::NpyArray::of(std::span<const float>(mean), {2}));
  ml::write_npy(folder / "Std.npy", ml::NpyArray::of(std::span<const float>(deviation), {2}));
  ml::DescribedMotions data{2, 20, {{"a", "a", {1, 5, 3, 5}, {}}}, {}, {}};
  CHECK(ml::statistics_of<B>(folder.path, data).std.to_vector() == deviation);
  CHECK(ml::statistics_of<B>(std::filesystem::path(), data).mean.to_vector() == std::vector<float>{2, 5});
  CHECK_ERROR(ml::statistics_of<B>(folder.path, 3), "[motionlang.io.407]");
  CHECK_ERROR(ml::statistics_of<B>(folder / "nowhere", 2), "[motionlang.io.401]");
}

TEST_CASE("retrieval by the protocols that the number of motions allows, beside chance") {
  constexpr ml::Index n = 40;
  ml::LatentTable table;
  table.width = n;
  std::vector<float> sentences;
  ml::RetrievalOptions options;
  for (ml::Index i = 0; i < n; ++i) {
    table.texts.push_back("text " + std::to_string(i));
    options.ids.push_back(std::to_string(i));
    for (ml::Index j = 0; j < n; ++j) {
      const float one = i == j ? 1.0f : 0.0f;
      table.text.push_back(one), table.motion.push_back(one), sentences.push_back(one);
    }
  }
  ml::LatentTable made = table;  // every motion made for the next text
  std::rotate(made.motion.begin(), made.motion.begin() + n, made.motion.end());
  const auto results = ml::retrieval_results(table, &made, ml::Rows<float>(sentences, n), options);
  REQUIRE(results.size() == 4);
  for (const ml::RetrievalResult& r : results) {
    CHECK(r.recorded.text_to_motion.recall[0] == 100);
    CHECK(r.recorded.motion_to_text.median_rank == 1);
    REQUIRE(r.made);
    CHECK(r.made->text_to_motion.recall[0] == 0);
    CHECK(r.chance.text_to_motion.recall[0] > 0);
    CHECK(r.chance.text_to_motion.recall[0] < 20);
  }
  const std::string lines = ml::retrieval_results_table(results);
  CHECK(std::ranges::count(lines, '\n') == 2 + 4 * 3);
  CHECK(lines.find("\n  all                     100.00 100.00 100.00 100.00 100.00    1.00    100.00 ") !=
        std::string::npos);
  CHECK(lines.find("\n  batches of 32           100.00") < lines.rfind("\n    generated               0.00"));
  // Without a whole batch there is no protocol of batches.
  table.texts.resize(20), options.ids.resize(20);
  table.text.resize(20 * n), table.motion.resize(20 * n), sentences.resize(20 * n);
  const auto fewer = ml::retrieval_results(table, nullptr, ml::Rows<float>(sentences, n), options);
  CHECK(fewer.size() == 3);
  CHECK(!fewer.front().made);
}
