// STMC as a whole: threads, batches, progress and cancelling, gaps, and timelines at the edge of what makes sense.
#include <doctest/doctest.h>

#include <ctime>

#include <motionlang/backend/eigen.hpp>

#include "../support/compositions.hpp"
#include "../support/small_model.hpp"
#include "../support/threads.hpp"

namespace ml = motionlang;
using ml::BodyParts, ml::Index, ml::Timeline;
using B = ml::EigenBackend<float>;

namespace {

const ml::Stmc<B>& model() {
  static const auto m = [] {
    auto made = small::model<B>();
    ml::prepare(made);
    return made;
  }();
  return m;
}
constexpr ml::Philox rng{.seed = 7};

std::vector<float> motion_of(const Timeline& timeline, const ml::StmcOptions& options = {}) {
  return small::numbers(model().generate(timeline, rng, options));
}

}  // namespace

TEST_CASE("same seed, same bits, on any number of threads") {
  for (auto sampler : {ml::SamplingOptions::Sampler::ddpm, ml::SamplingOptions::Sampler::ddim}) {
    auto run = [&](int threads) {
      const Threads scope(threads);
      return motion_of(small::several_tracks(), {.sampling = ml::SamplingOptions{.sampler = sampler, .eta = 0.5}});
    };
    const auto one = run(1);
    CHECK(one.size() == 70 * 205);
    CHECK(run(2) == one);
    CHECK(run(3) == one);
    CHECK(run(16) == one);
  }
  const auto other = small::numbers(model().generate(small::several_tracks(), {.seed = 8}));
  CHECK(other != motion_of(small::several_tracks()));
}

TEST_CASE("a timeline alone gives the bits that it gives in a batch") {
  const std::vector<Timeline> batch{small::several_tracks(), small::one_track(), small::one_text()};
  for (const auto how : compositions::all) {
    const auto together = compositions::generate(how, model(), batch, rng);
    REQUIRE(together.size() == batch.size());
    Index first = 0;  // number of the sequence in the batch: a timeline each, in the baselines a text each
    for (std::size_t m = 0; m < batch.size(); ++m) {
      const Index sequences = how == compositions::Composition::stmc ? 1 : std::ssize(batch[m].intervals);
      auto same_noise = [&](Index draw, const ml::Shape& shape) {
        return ml::slice(model().noise(rng, draw, {first + sequences, shape[1], shape[2]}), 0, first,
                         first + sequences);
      };
      const auto alone = compositions::generate_from(how, model(), std::span(&batch[m], 1), same_noise);
      CHECK(alone.front().shape() == ml::Shape{batch[m].end(), 205});
      CHECK(small::numbers(alone.front()) == small::numbers(together[m]));
      first += sequences;
    }
  }
}

TEST_CASE("progress counts every step once") {
  for (const auto& [wanted, total] : {std::pair<Index, Index>{0, 8}, {8, 8}, {3, 3}, {1, 1}}) {
    std::vector<Index> seen;
    auto watch = [&, of = total](Index done, Index all) {
      CHECK(all == of);
      seen.push_back(done);
      return true;
    };
    motion_of(small::one_text(), {.steps = wanted, .progress = watch});
    std::vector<Index> expected;
    for (Index i = 1; i <= total; ++i) expected.push_back(i);
    CHECK(seen == expected);
  }
  CHECK_THROWS_WITH_AS(motion_of(small::one_text(), {.steps = 9}), doctest::Contains("[motionlang.config.105]"),
                       ml::config_error);
}

TEST_CASE("cancelling stops at once and leaves nothing behind") {
  const Threads scope(1);
  const auto whole = motion_of(small::several_tracks());
  for (Index stop : {1, 4, 8}) {
    auto cancelled_run = [&] {
      Index calls = 0;
      auto until = [&](Index done, Index) { return ++calls, done < stop; };
      CHECK_THROWS_AS(motion_of(small::several_tracks(), {.progress = until}), ml::cancelled);
      CHECK(calls == stop);
    };
    cancelled_run();
    const auto taken = ml::BufferPool::local().system_allocations();
    cancelled_run();  // a buffer that was lost in the first run would be missing now
    CHECK(ml::BufferPool::local().system_allocations() == taken);
  }
  CHECK(motion_of(small::several_tracks()) == whole);
}

TEST_CASE("gaps are filled with the text \"\" on all parts") {
  const Timeline gaps{{{"walk forward", 10, 30, BodyParts::all()}, {"sit down", 45, 60, BodyParts::all()}}};
  Timeline filled = gaps;
  filled.intervals.push_back({"", 0, 10, BodyParts::all()});
  filled.intervals.push_back({"", 30, 45, BodyParts::all()});
  CHECK(motion_of(gaps) == motion_of(filled));
  CHECK_THROWS_WITH_AS(motion_of(gaps, {.gaps = ml::Gaps::refuse}),
                       doctest::Contains("[motionlang.timeline.505] plan_timeline: no text covers frames 0 to 10"),
                       ml::timeline_error);
}

TEST_CASE("one text is plain text to motion: the baselines agree") {
  const auto stmc = motion_of(small::one_text());
  CHECK(stmc.size() == 30 * 205);
  const Timeline text = small::one_text();
  for (const auto how : compositions::all)
    CHECK(small::numbers(compositions::generate(how, model(), std::span(&text, 1), rng).front()) == stmc);
  CHECK(motion_of(small::one_text(), {.overlap = 0}) == stmc);
}

TEST_CASE("intervals of one frame, and overlaps longer than the motion") {
  const auto parts = BodyParts{}.with(ml::BodyPart::legs);
  const Timeline tiny{{{"walk forward", 0, 1, parts}, {"sit down", 1, 2, BodyParts::all()}, {"walk", 2, 9, parts}}};
  const Timeline frame{{{"sit down", 0, 1, BodyParts::all()}}};
  for (Index overlap : {0, 1, 2, 10, 1000}) {
    for (const auto how : compositions::all) {
      const auto motions = compositions::generate(how, model(), std::vector{tiny, frame}, rng, {.overlap = overlap});
      CHECK(motions[0].shape() == ml::Shape{9, 205});
      CHECK(motions[1].shape() == ml::Shape{1, 205});
      CHECK(small::is_finite(motions[0]));
      CHECK(small::is_finite(motions[1]));
    }
  }
}

TEST_CASE("options that cannot be are refused with both values") {
  CHECK_THROWS_WITH_AS(motion_of(small::one_text(), {.overlap = -1}), doctest::Contains("Overlap: -1 frames"),
                       ml::config_error);
  CHECK_THROWS_WITH_AS(motion_of(Timeline{}), doctest::Contains("[motionlang.timeline.507]"), ml::timeline_error);
  CHECK_THROWS_WITH_AS(motion_of(small::one_text(1021)),
                       doctest::Contains("[motionlang.timeline.508] timeline: 'wave the right hand' needs a crop of "
                                         "1021 frames with its overlap; the denoiser accepts 1020"),
                       ml::timeline_error);
  CHECK(motion_of(small::one_text(1020), {.steps = 1}).size() == 1020 * 205);

  auto short_noise = [](Index, const ml::Shape& s) { return ml::Tensor<B, 3>::zeros({s[0], s[1] - 1, s[2]}); };
  const Timeline t = small::one_text();
  CHECK_THROWS_WITH_AS(model().generate_from(std::span(&t, 1), short_noise),
                       doctest::Contains("[motionlang.shape.204] Stmc: noise (1, 29, 205) where (1, 30, 205)"),
                       ml::shape_error);
}

TEST_CASE("a thousand crops take about four times as long as 250") {
  const Threads scope(1);
  auto seconds = [&](Index texts) {
    Timeline t;
    for (Index i = 0; i < texts; ++i)
      t.intervals.push_back({i % 2 == 0 ? "walk forward" : "sit down", 3 * i, 3 * i + 3, BodyParts::all()});
    double best = 1e9;
    for (int repeat = 0; repeat < 3; ++repeat) {
      const std::clock_t start = std::clock();
      CHECK(motion_of(t, {.overlap = 2, .guidance = 1, .steps = 2}).size() ==
            static_cast<std::size_t>(3 * texts * 205));
      best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return best;
  };
  seconds(20);
  const double few = seconds(126), many = seconds(501);  // 251 and 1001 crops
  CHECK_MESSAGE(many < 8 * few, many, " s and ", few, " s");
}
