// BERTScore of embeddings along the axes.
#include <motionlang/metrics/bert_score.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;
using ml::Index;

namespace {

/// Tokens 0 (start), the words, 1 (end); word k stands along axis k.
struct Sentence {
  explicit Sentence(const std::vector<Index>& words) {
    ids = {0};
    ids.insert(ids.end(), words.begin(), words.end());
    ids.push_back(1);
    for (const Index id : ids) {
      rows.resize(rows.size() + 8, 0);
      rows[rows.size() - 8 + static_cast<std::size_t>(id)] = 3;
    }
  }
  ml::BertSentence<double> view() const { return {ids, ml::Rows(rows, 8)}; }
  std::vector<Index> ids;
  std::vector<double> rows;
};

}  // namespace

TEST_CASE("bert_score: rare words weigh more, start and end nothing") {
  const Sentence a({2, 3}), b({2, 4}), empty({});
  ml::BertWeights weights;
  for (const Sentence* s : {&a, &b, &b}) weights.add(s->ids);
  CHECK(weights(0) == 0);
  CHECK(weights(2) == 0);
  CHECK(weights(3) == Approx(std::log(2)));
  CHECK(weights(7) == Approx(std::log(4)));
  const Sentence c({3, 4, 4});  // 3 is not in b: weights log 2, log 4/3, log 4/3
  const auto s = ml::bert_score(c.view(), b.view(), weights);
  const double rare = std::log(2), common = std::log(4.0 / 3);
  CHECK(s.precision == Approx(2 * common / (rare + 2 * common)));
  CHECK(s.recall == Approx(1));
  CHECK(s.f == Approx(2 * s.precision / (1 + s.precision)));
  CHECK(ml::bert_score(empty.view(), b.view(), weights).recall == 0);
  CHECK(ml::bert_score(a.view(), empty.view(), weights).f == 0);
  CHECK(ml::bert_score(Sentence({2}).view(), b.view(), weights).precision == 0);  // no weight at all
}

TEST_CASE("bert_score: beside padding no token is less than unlike") {
  Sentence a({3}), c({4});  // all tokens of one the opposite of all of the other
  for (std::size_t i = 0; i < a.rows.size(); ++i) a.rows[i] = i % 8 == 5 ? -1 : 0, c.rows[i] = i % 8 == 5 ? 1 : 0;
  ml::BertWeights weights;
  weights.add(std::vector<Index>{7});
  CHECK(ml::bert_score(a.view(), c.view(), weights).precision == Approx(-1));
  CHECK(ml::bert_score(a.view(), c.view(), weights, {.reference = 3}).precision ==
        Approx(-1));  // as long as the longest
  const auto beside_longer = ml::bert_score(a.view(), c.view(), weights, {.reference = 4});
  CHECK(beside_longer.precision == 0);
  CHECK(beside_longer.recall == Approx(-1));
  CHECK(ml::bert_score(a.view(), c.view(), weights, {.candidate = 4}).recall == 0);
}

TEST_CASE("bert_score: the best of each figure, with a baseline") {
  const Sentence a({2, 3}), b({4, 5}), c({2, 3});
  ml::BertWeights weights;
  for (const Sentence* s : {&a, &b}) weights.add(s->ids);
  const std::vector<ml::BertSentence<double>> references{b.view(), a.view()};
  const std::span<const ml::BertSentence<double>> both = references;
  CHECK(ml::bert_score(c.view(), both, weights).f == Approx(1));
  CHECK(ml::bert_score(c.view(), both.first(1), weights, {0.5, 0.5, 0.8}).f == Approx(-4));
  CHECK_ERROR(ml::bert_score(c.view(), both.first(0), weights), "[motionlang.numeric.302]");
  CHECK_ERROR(ml::bert_score({{0, 1}, a.view().embeddings}, a.view(), weights), "[motionlang.shape.204]");
}
