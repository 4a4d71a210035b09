// BLEU, ROUGE-L and CIDEr by hand.
#include <motionlang/metrics/captions.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;
using Pairs = std::vector<ml::CaptionPair>;

namespace {

const ml::CaptionPair the_same{"a man walk forward now", {"a man walk forward now", "b", "c d"}};
const ml::CaptionPair nothing_common{"x y z w", {"a man walk forward"}};

}  // namespace

TEST_CASE("bleu: the same sentence has 1, one without a common word 0") {
  for (const double b : ml::bleu(ml::bleu_counts(the_same))) CHECK(b == Approx(1));
  for (const double b : ml::bleu(ml::bleu_counts(nothing_common))) CHECK(b < 1e-12);
}

TEST_CASE("bleu_counts: clipped by the largest count of one reference, the closest length") {
  const auto c = ml::bleu_counts({"the the the  the", {"the cat the", "the dog on the mat"}});
  CHECK(c.correct == std::array<ml::Index, 4>{2, 0, 0, 0});
  CHECK(c.guess == std::array<ml::Index, 4>{4, 3, 2, 1});
  CHECK(c.length == 4);
  CHECK(c.reference_length == 3);  // 3 and 5 are as close: the shorter
  CHECK(ml::bleu(c)[0] == Approx(0.5));
  auto sum = c;
  sum += ml::bleu_counts({"the cat", {"the cat sat down"}});
  CHECK(sum.correct[1] == 1);
  CHECK(ml::bleu(sum)[0] == Approx(4.0 / 6 * std::exp(1 - 7.0 / 6)));  // 6 words against 7
  CHECK(ml::bleu_counts({"", {"a"}}).guess == std::array<ml::Index, 4>{0, 0, 0, 0});
  CHECK(ml::bleu(ml::bleu_counts({"", {"a"}}))[0] == 0);
}

TEST_CASE("rouge_l: the longest common subsequence") {
  CHECK(ml::rouge_l(the_same) == Approx(1));
  CHECK(ml::rouge_l(nothing_common) == 0);
  // "a b d" of 4 and 5 words: P = 3/4, R = 3/5.
  const double p = 0.75, r = 0.6, b2 = 1.44;
  const ml::CaptionPair pair{" a b c d", {"a x b y d "}};
  CHECK(ml::rouge_l(pair) == Approx((1 + b2) * p * r / (r + b2 * p)));
  CHECK(ml::rouge_l(pair, 1) == Approx(2 * p * r / (p + r)));
  CHECK(ml::rouge_l({"a  b", {"a b"}}, 1) ==
        Approx(2 * (2.0 / 3) / (1 + 2.0 / 3)));  // an empty word between two blanks
  CHECK(ml::rouge_l(Pairs{the_same, nothing_common}) == Approx(0.5));
}

TEST_CASE("cider: what other motions say as well counts less") {
  // Two motions without a common word: every weight is log 2, all four lengths agree.
  const Pairs own{{"a b c d", {"a b c d"}}, {"e f g h", {"e f g h"}}};
  CHECK(ml::cider(own) == Approx(10));
  // A word that all motions have weighs nothing.
  const auto each = ml::cider_of_each(Pairs{{"a", {"a"}}, {"a b", {"a b"}}});
  CHECK(each[0] == 0);
  CHECK(each[1] == Approx(10 * 2.0 / 4));  // the words and the pair of words
  // One bigram less: exp(-1 / 72), and the common words only.
  const auto shorter = ml::cider_of_each(Pairs{{"a b", {"a b c"}}, {"x", {"x"}}});
  CHECK(shorter[0] == Approx(10.0 / 4 * std::exp(-1.0 / 72) * (2 / std::sqrt(6) + 1 / std::sqrt(2))));
  CHECK(ml::cider(Pairs{the_same}) == 0);
}

TEST_CASE("references: three of them, lemmas") {
  CHECK(ml::three_references({"a"}) == std::vector<std::string>{"a", "a", "a"});
  CHECK(ml::three_references({"a", "b"}) == std::vector<std::string>{"a", "b", "a"});
  CHECK(ml::three_references({"a", "b", "c", "d"}) == std::vector<std::string>{"a", "b", "c"});
  CHECK(ml::lemmas(std::vector<ml::TaggedWord>{{"a", "DET"}, {"man", "NOUN"}}) == "a man");
  CHECK_ERROR(ml::three_references({}), "[motionlang.numeric.302]");
}

TEST_CASE("captions: none, and one without a reference") {
  const Pairs none, without{{"a", {}}};
  for (const Pairs& pairs : {none, without}) {
    CHECK_ERROR(ml::corpus_counts(pairs), "[motionlang.numeric.302]");
    CHECK_ERROR(ml::rouge_l(pairs), "[motionlang.numeric.302]");
    CHECK_ERROR(ml::cider(pairs), "[motionlang.numeric.302]");
  }
}
