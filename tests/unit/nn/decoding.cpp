// Decoding with tables instead of models: the most probable symbols, draws with given numbers, filters, ends, beams.
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/decoding.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index, ml::IdSequences;
using B = ml::ReferenceBackend<double>;
using Table = std::vector<std::vector<double>>;

namespace {

/// A model that knows the last symbol only: row i of the table are the probabilities after symbol i.
auto model(const Table& probabilities) {
  return [probabilities](const IdSequences& written) {
    std::vector<double> logits;
    for (Index s = 0; s < written.count(); ++s) {
      for (double p : probabilities.at(static_cast<std::size_t>(written[s].back())))
        logits.push_back(std::log(std::max(p, 1e-30)));
    }
    return ml::Tensor<B, 2>::from(logits, {written.count(), std::ssize(probabilities.front())});
  };
}
constexpr ml::DecodingOptions marks{.begin = 0, .end = 1, .pad = 2, .max_steps = 5};

// symbols: begin, end, padding, a, b
const Table chain{{0, .1, 0, .6, .3}, {0, 1, 0, 0, 0}, {0, 1, 0, 0, 0}, {.05, .3, .05, .2, .4}, {0, .7, 0, .2, .1}};

}  // namespace

TEST_CASE("decode_one: the most probable symbols up to the end or the last step") {
  CHECK(ml::decode_one(model(chain), marks) == std::vector<Index>{0, 3, 4});
  const Table endless{{0, 0, 0, 1, 0}, {}, {}, {0, 0, 0, .4, .6}, {0, 0, 0, .7, .3}};
  CHECK(ml::decode_one(model(endless), marks) == std::vector<Index>{0, 3, 4, 3, 4, 3});
}

TEST_CASE("decode_one: draws follow the numbers, marks are drawn again") {
  // after 0: 0.65 -> a (0.1 to 0.7); after a: 0.02 is the beginning, 0.1 the end, 0.38 the padding, 0.5 is a; 0.9 is b;
  // b: the end
  std::vector<double> numbers{0.65, 0.02, 0.1, 0.38, 0.5, 0.9};
  std::size_t at = 0;
  auto next_number = [&] { return numbers.at(at++); };
  CHECK(ml::decode_one(model(chain), marks, next_number) == std::vector<Index>{0, 3, 3, 4});
  CHECK(at == numbers.size());
  auto with_padding = marks;
  with_padding.redraw_pad = false, with_padding.max_steps = 2, at = 0;
  CHECK(ml::decode_one(model(chain), with_padding, next_number) == std::vector<Index>{0, 3, 2});
  auto narrow = marks;  // only the most probable symbol is left: no choice
  narrow.top_k = 1;
  CHECK(ml::decode_one(model(chain), narrow, [] { return 0.999; }) == std::vector<Index>{0, 3, 4});
  const auto odd = [](const ml::IdSequences&) { return ml::Tensor<B, 2>::from({0, std::nan(""), 0, 1, 0}, {1, 5}); };
  CHECK_ERROR(ml::decode_one(odd, marks), "[motionlang.numeric.301] decoding: a logit is NaN");
  const Table rarely{{1, 0, 0, 1e-18, 0}, {}, {}, {0, 1, 0, 0, 0}};  // less than the last bit of the sum
  CHECK(ml::decode_one(model(rarely), marks, [] { return 0.5; }) == std::vector<Index>{0, 3});
  const Table stuck{{1, 0, 0, 0, 0}};
  CHECK_ERROR(ml::decode_one(model(stuck), narrow, [] { return 0.5; }), "[motionlang.numeric.302]");
}

TEST_CASE("decode_batch: sequences that have ended go on until the last one has; their lengths tell") {
  const auto one = ml::decode_batch(model(chain), 1, marks);
  CHECK(one.ids == std::vector<std::vector<Index>>{{0, 3, 4}});
  CHECK(one.lengths == std::vector<Index>{2});
  CHECK(one.written().ids == std::vector<Index>{3, 4});
  // row 0 draws b at once and ends after it, row 1 stays with a
  auto numbers = [](Index, Index row) { return row == 0 ? 0.95 : 0.1; };
  const auto two = ml::decode_batch(model(chain), 2, marks, numbers);
  CHECK(two.ids[0] == std::vector<Index>{0, 4, 1, 1, 1, 1});
  CHECK(two.ids[1] == std::vector<Index>{0, 3, 3, 3, 3, 3});
  CHECK(two.lengths == std::vector<Index>{1, 5});
  CHECK(two.written().offsets == ml::Offsets{1, 5});
}

TEST_CASE("uniform_of: each number depends on step and row only") {
  const auto u = ml::uniform_of({.seed = 5}), same = ml::uniform_of({.seed = 5});
  CHECK(u(3, 2) == same(3, 2));
  CHECK(u(3, 2) != u(2, 3));
  double sum = 0;
  for (Index i = 0; i < 1000; ++i) sum += u(i, 0);
  CHECK(sum / 1000 == doctest::Approx(0.5).epsilon(0.05));
}

TEST_CASE("top_k_penalty keeps equals of the last one that stays") {
  const auto logits = ml::Tensor<B, 2>::from({1, 5, 3, 3, 2, 9, 9, 0, 0, 0}, {2, 5});
  const auto penalty = ml::top_k_penalty(logits, 2);
  const std::vector<bool> kept{false, true, true, true, false, true, true, false, false, false};
  for (std::size_t i = 0; i < kept.size(); ++i) CHECK((penalty[i] == 0) == kept[i]);
  CHECK(ml::top_k_penalty(logits, 0) == std::vector<double>(10, 0.0));
}

TEST_CASE("beam_search finds what the most probable first symbol hides") {
  // a is likelier at first, but b leads to a sure end
  const Table garden{{0, 0, 0, .55, .45}, {0, 1, 0, 0, 0}, {}, {0, .2, 0, .4, .4}, {0, 1, 0, 0, 0}};
  const auto found = ml::beam_search(model(garden), {.beams = 2, .max_length = 6, .alpha = 0});
  CHECK(found.ids == std::vector<Index>{0, 4, 1});
  CHECK(found.scores[0] == doctest::Approx(std::log(0.45)));
  CHECK(found.lengths[0] == 3);
  for (const auto& beam : found.beams) CHECK(beam.size() == 6);
  CHECK(ml::beam_search(model(garden), {.beams = 1, .max_length = 6}).ids[1] == 3);  // greedy
}

TEST_CASE("beam_search: alpha favours length; without an end the last length is taken") {
  // "a end": 0.5; "b b end": 0.45
  const Table fork{{0, 0, 0, .5, .5}, {0, 1, 0, 0, 0}, {}, {0, 1, 0, 0, 0}, {0, .1, 0, 0, .9}};
  CHECK(ml::beam_search(model(fork), {.beams = 2, .max_length = 8, .alpha = 0}).ids == std::vector<Index>{0, 3, 1});
  const auto longer = ml::beam_search(model(fork), {.beams = 2, .max_length = 5, .alpha = 3});
  CHECK(longer.ids.size() == 5);
  CHECK(longer.lengths == std::vector<Index>{3, 5});
  CHECK_ERROR(ml::beam_search(model(fork), {.beams = 6}), "[motionlang.config.101]");
  CHECK_ERROR(ml::beam_search(model(fork), {.beams = 0}), "[motionlang.config.101]");
}
