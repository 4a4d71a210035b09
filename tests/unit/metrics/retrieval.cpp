// Ranks, recall and protocols on tables that can be counted by hand; moments.
#include <limits>
#include <random>

#include <motionlang/metrics/retrieval.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;
using enum ml::RetrievalDirection;
using ml::Index;
using Table = std::vector<double>;

TEST_CASE("retrieval_ranks: both directions, ties share their places") {
  const Table s{0.9, 0.1, 0.2,  //
                0.8, 0.5, 0.5,  //
                0.3, 0.7, 0.3};
  const ml::Rows table(s, 3);
  CHECK(ml::retrieval_ranks(table, text_to_motion) == Table{0, 1.5, 1.5});
  CHECK(ml::retrieval_ranks(table, motion_to_text) == Table{0, 1, 1});
  // Texts 1 and 2 mean the same: the closest of their motions counts.
  const std::vector<std::uint8_t> alike{1, 0, 0, 0, 1, 1, 0, 1, 1};
  CHECK(ml::retrieval_ranks(table, text_to_motion, alike) == Table{0, 1.5, 0});
  CHECK(ml::retrieval_ranks(table, motion_to_text, alike) == Table{0, 0, 0});
}

TEST_CASE("retrieval: a perfect table, a reversed one, one where all are equal") {
  constexpr Index n = 8;
  Table perfect(n * n), worst(n * n);
  for (Index i = 0; i < n; ++i)
    perfect[static_cast<std::size_t>(i * n + i)] = 1, worst[static_cast<std::size_t>(i * n + i)] = -1;
  const auto best = ml::retrieval_table(ml::Rows(perfect, n)).text_to_motion;
  CHECK(best.recall == std::array<double, 5>{100, 100, 100, 100, 100});
  CHECK(best.median_rank == 1);
  const auto last = ml::retrieval_table(ml::Rows(worst, n)).motion_to_text;
  CHECK(last.recall == std::array<double, 5>{0, 0, 0, 0, 100});
  CHECK(last.median_rank == n);
  const auto equal = ml::retrieval_table(ml::Rows(Table(n * n), n)).text_to_motion;  // every rank is 3.5
  CHECK(equal.recall == std::array<double, 5>{0, 0, 0, 100, 100});
  CHECK(equal.median_rank == 4.5);
}

TEST_CASE("retrieval: chance finds k of n") {
  constexpr Index n = 200;
  std::mt19937 words(3);
  Table noise;
  for (Index i = 0; i < n * n; ++i) noise.push_back(std::uniform_real_distribution<double>()(words));
  const auto m = ml::retrieval_table(ml::Rows(noise, n)).text_to_motion;
  CHECK(m.recall[4] == Approx(5).epsilon(0.5));  // 10 of 200
  CHECK(m.median_rank == Approx(100).epsilon(0.15));
}

TEST_CASE("texts_alike: above twice the threshold less one, and always itself") {
  const std::vector<double> sentences{1, 0, 0.95, 0.3122498999199199, 0, 1};
  CHECK(ml::texts_alike(ml::Rows(sentences, 2), 0.95) == std::vector<std::uint8_t>{1, 1, 0, 1, 1, 0, 0, 0, 1});
  CHECK(ml::texts_alike(ml::Rows(sentences, 2), 1.0)[0] == 1);
}

TEST_CASE("guo_batches: NumPy's shuffle with seed 0, the rest is dropped") {
  const auto batches = ml::guo_batches(10, 4);
  REQUIRE(batches.size() == 2);
  CHECK(batches[0] == std::vector<Index>{2, 8, 4, 9});
  CHECK(batches[1] == std::vector<Index>{1, 6, 7, 3});
  CHECK(ml::guo_batches(4384).size() == 137);
  const Index h3d[] = {2724, 3920, 1646, 775, 4283, 639, 1262, 2699}, kit[] = {449, 85, 613, 310, 299, 14, 331, 632};
  for (std::size_t i = 0; i < 8; ++i) {  // as the published code draws them
    CHECK(ml::guo_batches(4384)[0][i] == h3d[i]);
    CHECK(ml::guo_batches(786)[0][i] == kit[i]);
  }
  CHECK_ERROR(ml::guo_batches(10, 0), "[motionlang.config.101]");
}

TEST_CASE("retrieve: protocols choose their pairs") {
  // Latents on a circle: text i and motion i at the same angle, except the pair "c".
  const std::vector<double> texts{1, 0, 0, 1, -1, 0}, motions{1, 0, 0, 1, 0, 1};
  const ml::Rows x(texts, 2), y(motions, 2);
  ml::RetrievalOptions options{.batch = 2, .ids = {"c", "a", "b"}, .nsim_ids = {"a", "missing", "c"}};
  using enum ml::RetrievalProtocol;
  const auto all = ml::retrieve(normal, x, y);
  CHECK(all.text_to_motion.queries == 3);
  CHECK(all.text_to_motion.recall[0] == 100);  // text "c" is as far from two motions
  CHECK(all.motion_to_text.recall[0] == Approx(200.0 / 3));
  CHECK(ml::retrieve(nsim, x, y, options).text_to_motion.queries == 2);
  CHECK(ml::retrieve(nsim, x, y, options).text_to_motion.recall[0] == 100);
  CHECK(ml::retrieve(guo, x, y, options).text_to_motion.queries == 2);
  // With one sentence for all, any motion is right.
  const std::vector<double> same{1, 1, 1};
  CHECK(ml::retrieve(threshold, x, y, ml::Rows(same, 1), options).motion_to_text.recall[0] == 100);

  options.batch = 4;
  CHECK_ERROR(ml::retrieve(guo, x, y, options), "[motionlang.numeric.302]");
  options.nsim_ids = {"missing"};
  CHECK_ERROR(ml::retrieve(nsim, x, y, options), "[motionlang.numeric.302]");
  options.ids = {"a", "a", "b"};
  CHECK_ERROR(ml::retrieve(guo, x, y, options), "[motionlang.config.103]");
  options.ids = {"a"};
  CHECK_ERROR(ml::retrieve(guo, x, y, options), "[motionlang.shape.204]");
  CHECK_ERROR(ml::retrieve(threshold, x, y), "[motionlang.shape.204]");
  CHECK_ERROR(ml::retrieve(normal, x, y.slice(0, 2)), "[motionlang.shape.204]");
  CHECK_ERROR(ml::retrieve(normal, x.slice(0, 0), y.slice(0, 0)), "[motionlang.numeric.302]");
}

TEST_CASE("retrieval: wrong tables, NaN, no queries") {
  const Table six(6), bad{1, std::numeric_limits<double>::quiet_NaN(), 0, 1};
  CHECK_ERROR(ml::retrieval_ranks(ml::Rows(six, 3), text_to_motion), "[motionlang.shape.205]");
  CHECK_ERROR(ml::retrieval_ranks(ml::Rows(bad, 2), text_to_motion), "[motionlang.numeric.301]");
  const std::vector<std::uint8_t> alike(3);
  CHECK_ERROR(ml::retrieval_ranks(ml::Rows(Table(4), 2), text_to_motion, alike), "[motionlang.shape.204]");
  CHECK_ERROR(ml::retrieval_metrics({}), "[motionlang.numeric.302]");
}

TEST_CASE("named and rounded: TMR's keys and places") {
  ml::RetrievalTable table;
  table.text_to_motion.recall[4] = 33.335;  // a little less in binary
  table.motion_to_text.median_rank = 7.25;
  const auto names = named(ml::rounded(table));
  REQUIRE(names.size() == 14);
  CHECK(names[0].first == "t2m/R01");
  CHECK(names[4] == std::pair<std::string, double>{"t2m/R10", 33.34});
  CHECK(names[12] == std::pair<std::string, double>{"m2t/MedR", 7.25});
}

TEST_CASE("dissimilar_subset: the least similar pair, then the smallest sums, ties by id") {
  const std::vector<double> e{1, 0, 0.6, 0.8, 0, 1, -1, 0, 0, -1};
  const ml::Rows sentences(e, 2);
  const std::vector<std::string> ids{"d", "b", "c", "a", "e"};
  // The pairs (a, d) and (c, e) are opposite: a comes first. Then sums with a and d are 0 for b, c and e: b.
  CHECK(ml::dissimilar_subset(sentences, ids, 3) == std::vector<Index>{3, 0, 1});
  CHECK(ml::dissimilar_subset(sentences, ids, 4) == std::vector<Index>{3, 0, 1, 4});
  CHECK_ERROR(ml::dissimilar_subset(sentences, ids, 1), "[motionlang.config.101]");
  CHECK_ERROR(ml::dissimilar_subset(sentences, ids, 6), "[motionlang.config.101]");
  CHECK_ERROR(ml::dissimilar_subset(sentences, std::vector<std::string>{"a"}, 2), "[motionlang.shape.204]");
}

TEST_CASE("moments: windows, the best of them, overlap in time") {
  const auto windows = ml::moment_windows(5, 4, 2);
  CHECK(windows == std::vector<ml::FrameSlice>{{0, 2}, {0, 4}, {2, 3}});
  CHECK(ml::moment_windows(3, 1).size() == 3);
  CHECK(ml::best_moment(windows, std::vector<double>{0.1, 0.7, 0.7}) == ml::FrameSlice{0, 4});
  CHECK(ml::temporal_iou({0, 4}, {2, 3}) == Approx(0.4));
  CHECK(ml::temporal_iou({0, 2}, {2, 3}) == 0);
  CHECK(ml::temporal_iou({3, 5}, {3, 5}) == 1);
  CHECK(ml::temporal_iou({}, {}) == 0);
  const std::vector<ml::FrameSlice> found{{0, 4}, {0, 2}}, wanted{{2, 3}, {2, 3}};
  CHECK(ml::localisation_accuracy(found, wanted) == 0.5);
  CHECK(ml::localisation_accuracy(found, wanted, 0.41) == 0);
  CHECK_ERROR(ml::moment_windows(5, 0), "[motionlang.config.101]");
  CHECK_ERROR(ml::best_moment(windows, std::vector<double>{1}), "[motionlang.shape.204]");
  CHECK_ERROR(ml::best_moment({}, {}), "[motionlang.numeric.302]");
  CHECK_ERROR(ml::localisation_accuracy({}, {}), "[motionlang.numeric.302]");
}
