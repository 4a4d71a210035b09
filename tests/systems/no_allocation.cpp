// The denoising loop takes nothing from the system once it has settled, that is, after its second step.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include <motionlang/backend/xtensor.hpp>

#include "../support/compositions.hpp"
#include "../support/small_denoisers.hpp"
#include "../support/threads.hpp"

namespace {

std::atomic<long> taken{0};  // of all threads, by operator new

void* take(std::size_t bytes, std::size_t alignment) {
  ++taken;
  const std::size_t whole = (bytes / alignment + 1) * alignment;
  if (void* memory = std::aligned_alloc(alignment, whole)) return memory;
  throw std::bad_alloc();
}

}  // namespace

// The whole program allocates through these, the library's pool through its own counter. (Inlined, GCC mistakes them
// for a mismatch.)
[[gnu::noinline]] void* operator new(std::size_t bytes) { return take(bytes, alignof(std::max_align_t)); }
[[gnu::noinline]] void* operator new(std::size_t bytes, std::align_val_t a) {
  return take(bytes, static_cast<std::size_t>(a));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace {

namespace ml = motionlang;
using ml::Index;

/// Records after every step how much memory was taken since the program began. Needs no memory itself.
struct Counter {
  struct Count {
    long heap = 0;
    std::int64_t pool = 0;
    bool operator==(const Count&) const = default;
  };
  std::array<Count, 64> after{};
  Index steps = 0;

  bool operator()(Index done, Index) {
    after[static_cast<std::size_t>(done)] = {taken, ml::BufferPool::local().system_allocations()};
    steps = done;
    return true;
  }
  void check(Index expected) const {
    REQUIRE(steps == expected);
    CHECK(after[1].heap > 0);
    CHECK(after[1].pool > 0);
    for (Index i = 3; i <= steps; ++i) {
      const Count &before = after[static_cast<std::size_t>(i) - 1], now = after[static_cast<std::size_t>(i)];
      CHECK_MESSAGE(now == before, "step ", i, " took ", now.heap - before.heap, " times from the heap and ",
                    now.pool - before.pool, " times for the pool");
    }
  }
};

}  // namespace

TEST_CASE_TEMPLATE("no step after the second takes memory", B, ml::EigenBackend<float>, ml::XtensorBackend<float>) {
  auto model = small::model<B>(small::config(12));
  ml::prepare(model);
  const std::vector timelines{small::several_tracks(), small::one_track()};
  for (int threads : {1, 2}) {
    const Threads scope(threads);
    for (auto sampler : {ml::SamplingOptions::Sampler::ddpm, ml::SamplingOptions::Sampler::ddim}) {
      for (double guidance : {1.0, 2.5}) {
        for (const auto how : {compositions::Composition::stmc, compositions::Composition::sinc}) {
          for (Index rows_at_once : {ml::usual_rows_at_once, Index{50}}) {
            ml::BufferPool::local().trim();
            Counter counter;
            compositions::generate(how, model, timelines, ml::Philox{.seed = 1},
                                   {.guidance = guidance,
                                    .sampling = ml::SamplingOptions{.sampler = sampler, .eta = 0.5, .clip = true},
                                    .rows_at_once = rows_at_once,
                                    .progress = counter});
            counter.check(12);
          }
        }
      }
    }
  }
}

TEST_CASE_TEMPLATE("the other denoisers take none either", D, ml::MdmDenoiser<small::B>,
                   ml::MotionDiffuseDenoiser<small::B>) {
  const auto model = small::model_of<D>();
  for (int threads : {1, 2}) {
    const Threads scope(threads);
    ml::BufferPool::local().trim();
    Counter counter;
    model.generate(small::one_text(20), ml::Philox{.seed = 1}, {.guidance = 2.5, .progress = counter});
    counter.check(6);
  }
}

TEST_CASE("the counter sees what it should") {
  const long before = taken;
  std::vector<int> list(1000);
  CHECK(list.data() != nullptr);
  CHECK(taken == before + 1);
}
