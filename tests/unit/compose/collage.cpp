// Crops, stitching and the denoising step, with denoisers whose answer is known. Five features, one for each body part.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/compose/collage.hpp>

#include <map>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using enum ml::BodyPart;
using ml::BodyParts, ml::Index, ml::Offsets;
using tensors::distance, tensors::normal, tensors::same_bits;

namespace {

using B = ml::EigenBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using Text = ml::TextFeatures<B>;
using Values = std::vector<double>;

const auto layout = ml::FeatureLayout::from_owner("five", 5, [](Index i) { return ml::BodyPart(i); });

/// Remembers what it was called with. The answer: its input, or for every frame the five numbers of the text.
struct Known {
  bool says_text = false;
  ml::DenoiserTraits properties{};
  mutable std::vector<Offsets> seen{};
  mutable std::vector<Index> steps{};
  mutable Index padded_tokens = 0;

  static constexpr auto fields() { return ml::fields(); }
  ml::DenoiserTraits traits() const { return properties; }
  ml::Sequences<B> operator()(const ml::Sequences<B>& x, std::span<const Index> t, const Text& text) const {
    seen.push_back(x.offsets);
    steps.assign(t.begin(), t.end());
    padded_tokens = text.padded_tokens;
    return says_text ? x.with(ml::repeat_for_rows(text.tokens.rows, x.offsets)) : x;
  }
};
static_assert(ml::Denoiser<Known, B>);
/// One that takes frames with several texts.
struct KnownUses : Known {
  mutable Offsets uses{};
  using Known::operator();
  ml::Sequences<B> operator()(const ml::Sequences<B>& x, const Offsets& times, std::span<const Index> t,
                              const Text& text) const {
    uses = times;
    auto y = (*this)(ml::repeat_sequences(x, times), t, text);
    seen.back() = x.offsets;
    return y;
  }
};

/// One row for each text: its number in all features.
Text texts(const Values& numbers) {
  return Text::pooled(Matrix::from(numbers, {std::ssize(numbers), 1}) * Matrix::full({1, 5}, 1));
}

/// 1 moves everything for 20 frames, then 2; between 5 and 15 the left arm belongs to 3.
const ml::Timeline timeline{{{"one", 0, 20, BodyParts::all()},
                             {"two", 20, 30, BodyParts::all()},
                             {"three", 5, 15, BodyParts{}.with(left_arm)}}};

template <class D>
ml::Collage<B, D> collage(const D& denoiser, const ml::PlanOptions& options = {}, double guidance = 2.5,
                          const ml::Timeline& t = timeline, Index rows_at_once = ml::usual_rows_at_once) {
  auto plan = ml::plan_timelines(std::span(&t, 1), options);
  return {denoiser, std::move(plan), layout, texts({1, 2, 3}), texts({0}), guidance, rows_at_once};
}

constexpr ml::PlanOptions hard_cuts{.overlap = 0, .extend = false, .transition_crops = false};

}  // namespace

TEST_CASE("a denoiser that changes nothing changes nothing, however the timeline is cut") {
  const Known same;
  for (Index overlap : {0, 1, 4, 7, 40}) {
    const auto c = collage(same, {.overlap = overlap});
    const auto x = normal<B, 2>({30, 5}, 1);
    CHECK(distance(c.step(x, 3).x0, x) < 1e-14);
  }
}

TEST_CASE("with hard cuts every part is that of its owner") {
  const Known says{.says_text = true};
  const auto x0 = collage(says, hard_cuts, 1).step(Matrix::zeros({30, 5}), 0).x0;
  for (Index frame = 0; frame < 30; ++frame) {
    for (Index part = 0; part < 5; ++part) {
      const bool third = frame >= 5 && frame < 15 && ml::BodyPart(part) == left_arm;
      CHECK(x0.span()[static_cast<std::size_t>(5 * frame + part)] == (third ? 3 : frame < 20 ? 1 : 2));
    }
  }
}

TEST_CASE("around a cut both texts are added and the transition is subtracted") {
  const Known says{.says_text = true};
  const auto x0 = collage(says, {.overlap = 4}, 1).step(Matrix::zeros({30, 5}), 0).x0;
  const auto leg = [&](std::size_t frame) { return x0.span()[5 * frame + 2]; };
  CHECK(leg(17) == 1);
  CHECK(leg(18) == 1 + 2 - 0);
  CHECK(leg(21) == 1 + 2 - 0);
  CHECK(leg(22) == 2);
  const auto guided = collage(says, {.overlap = 4}, 3).step(Matrix::zeros({30, 5}), 0).x0;
  CHECK(guided.span()[2] == 3);  // 0 + 3 (1 - 0)
}

TEST_CASE(
    "one call per step, the longest first; crops without a text go through the network once, and without guidance "
    "nothing goes twice") {
  const Known guided, plain;
  collage(guided, {.overlap = 4}).step(Matrix::zeros({30, 5}), 7);
  CHECK(guided.seen.size() == 1);
  // three texts with and without, three transitions
  CHECK(guided.seen.back() == Offsets{22, 22, 14, 14, 12, 12, 4, 4, 4});
  CHECK(guided.steps == std::vector<Index>(9, 7));
  collage(plain, {.overlap = 4}, 1).step(Matrix::zeros({30, 5}), 7);
  CHECK(plain.seen.back() == Offsets{22, 14, 12, 4, 4, 4});
  auto pause = timeline;
  pause.intervals[1].text = "";
  collage(guided, {.overlap = 4}, 2.5, pause).step(Matrix::zeros({30, 5}), 7);
  CHECK(guided.seen.back() == Offsets{22, 22, 14, 14, 12, 4, 4, 4});
  collage(guided, {.overlap = 0}).step(Matrix::zeros({30, 5}), 7);
  CHECK(guided.seen.back() == Offsets{20, 20, 10, 10, 10, 10});  // transitions without frames are left out
}

TEST_CASE("a denoiser that takes several texts gets frames once for those with and without text") {
  const Known one_by_one{.says_text = true};
  const KnownUses several{one_by_one};
  const auto x = normal<B, 2>({30, 5}, 4);
  const auto expected = collage(one_by_one, {.overlap = 4}).step(x, 7);
  CHECK(same_bits(collage(several, {.overlap = 4}).step(x, 7).x0, expected.x0));
  CHECK(several.seen.back() == Offsets{22, 14, 12, 4, 4, 4});
  CHECK(several.uses == Offsets{2, 2, 2, 1, 1, 1});
}

TEST_CASE("no more rows at once than wanted, but one crop at least; the answer is the same") {
  const auto x = normal<B, 2>({30, 5}, 4);
  const auto answer = [&](const Known& d, Index rows) {
    const auto c = collage(d, {.overlap = 4}, 2.5, timeline, rows);
    CHECK(c.batch_rows() == 108);
    d.seen.clear();
    return c.step(x, 7);
  };
  const Known says{.says_text = true};
  const auto whole = answer(says, 0);
  CHECK(says.seen == std::vector<Offsets>{{22, 22, 14, 14, 12, 12, 4, 4, 4}});
  const std::map<Index, std::vector<Offsets>> batches{{108, {{22, 22, 14, 14, 12, 12, 4, 4, 4}}},
                                                      {107, {{22, 22, 14, 14, 12, 12, 4, 4}, {4}}},
                                                      {40, {{22}, {22, 14}, {14, 12, 12}, {4, 4, 4}}},
                                                      {1, {{22}, {22}, {14}, {14}, {12}, {12}, {4}, {4}, {4}}}};
  for (const auto& [rows, expected] : batches) {
    const auto divided = answer(says, rows);
    CHECK(says.seen == expected);
    CHECK(same_bits(divided.cond, whole.cond));
    CHECK(same_bits(divided.null, whole.null));
    CHECK(same_bits(divided.x0, whole.x0));
  }
  CHECK_ERROR(answer(says, -1), "[motionlang.config.101] Collage: -1 rows at once");
}

TEST_CASE(
    "where a sequence depends on the others, there are the two calls of the published code: all crops, and all without "
    "texts") {
  const auto calls = [](ml::BatchMates mates, const Text& words) {
    const Known d{.properties = {.mates = mates}};
    const ml::Collage<B, Known> c(d, ml::plan_timelines(std::span(&timeline, 1)), layout, words, texts({0}), 2.5, 1);
    c.step(Matrix::zeros({30, 5}), 0);
    CHECK(d.padded_tokens == words.padded_tokens);
    return d.seen.size();
  };
  const Text longer{{Matrix::zeros({4, 5}), Offsets{1, 2, 1}}};
  CHECK(calls(ml::BatchMates::none, texts({1, 2, 3})) == 9);
  CHECK(calls(ml::BatchMates::none, longer) == 9);
  CHECK(calls(ml::BatchMates::longest_text, texts({1, 2, 3})) == 9);
  CHECK(calls(ml::BatchMates::longest_text, longer) == 2);
  Text padded = longer;  // wherever it is, a text has as many places
  padded.padded_tokens = 3;
  CHECK(calls(ml::BatchMates::longest_text, padded) == 9);
  padded.padded_tokens = 1;
  CHECK(calls(ml::BatchMates::longest_text, padded) == 2);
  CHECK(calls(ml::BatchMates::all, texts({1, 2, 3})) == 2);
}

TEST_CASE("texts that begin and end together share their unconditional crop, equal texts the other as well") {
  using enum ml::BodyPart;
  const auto crops_of = [&](const std::vector<std::string>& words) {
    const ml::Timeline together{{{words[0], 0, 20, BodyParts{}.with(legs)},
                                 {words[1], 0, 20, BodyParts{}.with(left_arm)},
                                 {words[2], 0, 12, BodyParts{}.with(right_arm)}}};
    const Known d{.says_text = true};
    const auto c = collage(d, {.overlap = 4}, 3, together);
    const auto x0 = c.step(Matrix::zeros({20, 5}), 0).x0;
    CHECK(x0.span()[std::size_t(legs)] == 3);  // 0 + 3 (text - 0)
    return std::pair(d.seen.back(), x0.span()[std::size_t(left_arm)]);
  };
  // two of 20 frames, their shared one; one of 14 and its own; the transition at 12
  CHECK(crops_of({"one", "two", "three"}) == std::pair(Offsets{20, 20, 20, 14, 14, 4}, 6.0));
  CHECK(crops_of({"one", "one", "three"}) == std::pair(Offsets{20, 20, 14, 14, 4}, 3.0));
}

TEST_CASE("a layout that does not give each number to one body part is refused") {
  const Known says{.says_text = true};
  auto of = [&](const ml::FeatureLayout& wrong) {
    return ml::Collage<B, Known>(says, ml::plan_timelines(std::span(&timeline, 1)), wrong, texts({1, 2, 3}), texts({0}),
                                 1);
  };
  auto wrong = layout;
  wrong.size = 4;
  CHECK_ERROR(of(wrong), "[motionlang.config.102] FeatureLayout 'five': range 4:5");
  wrong.size = 6;
  CHECK_ERROR(of(wrong), "[motionlang.config.102] FeatureLayout 'five': number 5 belongs to 0 body parts");
}

TEST_CASE("what a collage answers does not depend on the order of its texts") {
  const Known says{.says_text = true};
  auto turned = timeline;
  std::rotate(turned.intervals.begin(), turned.intervals.begin() + 1, turned.intervals.end());
  const auto x = normal<B, 2>({30, 5}, 4);
  const ml::Collage<B, Known> c(says, ml::plan_timelines(std::span(&turned, 1)), layout, texts({2, 3, 1}), texts({0}),
                                2.5);
  CHECK(same_bits(c.step(x, 0).x0, collage(says).step(x, 0).x0));
}

TEST_CASE("denoisers with crops of one size") {
  const Known masked{.properties = {.crop_frames = 25}},
      whole{.properties = {.crop_frames = 25, .uses_lengths = false}};
  const auto a = collage(masked, {.overlap = 4}, 1), b = collage(whole, {.overlap = 4}, 1);
  CHECK(a.rows() == 55);  // as many frames behind the end
  const auto x = normal<B, 2>({55, 5}, 1);
  const auto clean = [&](const auto& c) { return ml::slice(c.step(x, 0).x0, 0, 0, 30); };
  CHECK(distance(clean(a), ml::slice(x, 0, 0, 30)) < 1e-14);
  CHECK(distance(clean(b), ml::slice(x, 0, 0, 30)) < 1e-14);
  CHECK(masked.seen.back() == Offsets{22, 14, 12, 4, 4, 4});
  CHECK(whole.seen.back() == Offsets{25, 25, 25, 25, 25, 25});
  const std::vector<ml::Timeline> two(2, timeline);
  const auto again = normal<B, 2>({110, 5}, 2);
  for (const Known* d : {&masked, &whole}) {
    const ml::Collage<B, Known> c(*d, ml::plan_timelines(two, {.overlap = 4}), layout, texts({1, 2, 3, 1, 2, 3}),
                                  texts({0}), 1);
    const auto x0 = c.step(again, 0).x0;
    for (Index first : {0, 55})
      CHECK(distance(ml::slice(x0, 0, first, first + 30), ml::slice(again, 0, first, first + 30)) < 1e-14);
  }
  const Known narrow{.properties = {.crop_frames = 21}};
  CHECK_ERROR(collage(narrow, {.overlap = 4}), "[motionlang.timeline.508] timeline: 'one' needs a crop of 22 frames");
}

TEST_CASE("several timelines in one batch do not meet") {
  const Known says{.says_text = true};
  const std::vector<ml::Timeline> two{timeline, {{{"four", 0, 8, BodyParts::all()}}}};
  const ml::Collage<B, Known> c(says, ml::plan_timelines(two, hard_cuts), layout, texts({1, 2, 3, 4}), texts({0}), 1);
  CHECK(c.rows() == 60);
  const auto x0 = c.step(Matrix::zeros({60, 5}), 0).x0;
  CHECK(same_bits(ml::slice(x0, 0, 0, 30), collage(says, hard_cuts, 1).step(Matrix::zeros({30, 5}), 0).x0));
  CHECK(same_bits(ml::slice(x0, 0, 30, 38), Matrix::full({8, 5}, 4)));
  CHECK(same_bits(ml::slice(x0, 0, 38, 60), Matrix::zeros({22, 5})));
}

TEST_CASE("texts that do not fit are refused") {
  const Known d;
  const auto plan = ml::plan_timelines(std::span(&timeline, 1));
  using C = ml::Collage<B, Known>;
  CHECK_ERROR(C(d, plan, layout, texts({1, 2}), texts({0}), 2),
              "[motionlang.shape.204] Collage: 2 texts for 3 intervals");
  CHECK_ERROR(C(d, plan, layout, texts({1, 2, 3}), texts({0, 0}), 2), "[motionlang.shape.204]");
}

TEST_CASE("a whole run: the first draw is the start, progress can stop it") {
  const Known says{.says_text = true};
  const auto c = collage(says, hard_cuts, 1);
  const ml::GaussianDiffusion process(ml::CosineSchedule{.steps = 6});
  std::vector<Index> draws;
  const auto noise = [&](Index draw) { return draws.push_back(draw), normal<B, 2>({30, 5}, 1); };
  const auto goal = c.step(Matrix::zeros({30, 5}), 0).x0;
  CHECK(distance(ml::sample_collage(c, process, ml::Prediction::x0, noise), goal) < 1e-12);
  CHECK(std::exchange(draws, {}) == std::vector<Index>{0, 1, 2, 3, 4, 5, 6});
  const ml::SamplingOptions ddim{.sampler = ml::SamplingOptions::Sampler::ddim};
  CHECK(distance(ml::sample_collage(c, process, ml::Prediction::x0, noise, ddim), goal) < 1e-12);
  CHECK(draws == std::vector<Index>{0});

  const auto stop = [](Index done, Index total) { return done < 2 || total != 6; };
  CHECK_THROWS_AS(ml::sample_collage(c, process, ml::Prediction::x0, noise, {}, stop), ml::cancelled);
  const auto short_process = process.respaced(std::vector<Index>{2, 5});
  ml::sample_collage(c, short_process, ml::Prediction::x0, noise);
  CHECK(says.steps == std::vector<Index>(3, 2));  // the network gets the original step
}

TEST_CASE("interpolation between the ends of a window, per part") {
  const ml::Timeline cut{{{"a", 0, 10, BodyParts::all()}, {"b", 10, 20, BodyParts::all()}}};
  auto options = hard_cuts;
  options.overlap = 4;
  const auto plan = ml::plan_timelines(std::span(&cut, 1), options);
  Values motion(100);
  for (std::size_t i = 50; i < 100; ++i) motion[i] = 3;
  const auto soft = ml::interpolate_transitions<B>(plan, layout, Matrix::from(motion, {20, 5}), 20);
  for (std::size_t part = 0; part < 5; ++part) {
    for (std::size_t frame = 0; frame < 20; ++frame) {
      const double expected = frame <= 8 ? 0 : frame >= 11 ? 3 : static_cast<double>(frame) - 8;
      CHECK(soft.span()[5 * frame + part] == doctest::Approx(expected));
    }
  }
}

TEST_CASE("every text as a motion of its own") {
  const auto plan = ml::plan_timelines(std::span(&timeline, 1));
  const auto alone = ml::independent_plan(plan);
  REQUIRE(alone.timelines.size() == 3);
  CHECK(alone.timelines[2].frames == 10);
  CHECK(alone.timelines[2].text(alone.timelines[2].crops[0]) == "three");
  CHECK(alone.crops() == 3);
  CHECK(ml::independent_plan(plan, 7).timelines[0].frames == 7);
}
