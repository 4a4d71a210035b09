// The buffer pool: reuse, alignment, handles, foreign memory.
#include <doctest/doctest.h>

#include <cstring>
#include <thread>

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/text_lines.hpp>

namespace ml = motionlang;
using ml::BufferPool, ml::detail::BufferHandle;

namespace {

std::int64_t allocations() { return BufferPool::local().system_allocations(); }

}  // namespace

TEST_CASE("a buffer that is given back is used again for sizes of the same bucket only") {
  BufferPool::local().trim();
  const auto before = allocations();
  const void* first = nullptr;
  {
    const BufferHandle a(1000);
    first = a.data();
  }
  {
    const BufferHandle b(1020);
    CHECK(b.data() == first);
    const BufferHandle c(1020);
    CHECK(c.data() != first);
  }
  CHECK(allocations() == before + 2);
  const BufferHandle other(5000);
  CHECK(allocations() == before + 3);
}

TEST_CASE("buffers of every size are aligned and large enough") {
  for (std::size_t bytes : std::initializer_list<std::size_t>{0, 1, 63, 64, 65, 255, 256, 257, 511, 512, 513, 1000,
                                                              4096, 5121, 100'000, 1'000'003}) {
    const BufferHandle b(bytes);
    CHECK(reinterpret_cast<std::uintptr_t>(b.data()) % 64 == 0);
    std::memset(b.data(), 0xAB, bytes);  // the address sanitizer watches
  }
}

TEST_CASE("a loop that has settled takes nothing from the system") {
  const auto round = [] {
    const BufferHandle a(3000), b(70'000);
    BufferHandle c(3000);
    c = BufferHandle(900);
  };
  round();
  const auto settled = allocations();
  for (int i = 0; i < 100; ++i) round();
  CHECK(allocations() == settled);
  BufferPool::local().trim();
  round();
  CHECK(allocations() > settled);
}

TEST_CASE("handles count") {
  BufferHandle a(100);
  CHECK(a.unique());
  {
    const BufferHandle b = a;  // NOLINT: the copy is the point
    CHECK_FALSE(a.unique());
    CHECK(b.data() == a.data());
  }
  CHECK(a.unique());
  const BufferHandle moved = std::move(a);
  CHECK(moved.unique());
  CHECK_FALSE(static_cast<bool>(a));  // NOLINT: what is left after a move is empty
  CHECK(a.data() == nullptr);
  CHECK_FALSE(a.unique());
  BufferHandle self = moved;
  self = *&self;
  CHECK(self.data() == moved.data());
}

TEST_CASE("foreign memory is kept alive and never written") {
  auto numbers = std::make_shared<std::array<float, 4>>();
  const std::weak_ptr<std::array<float, 4>> watch = numbers;
  {
    const BufferHandle view(numbers->data(), numbers);
    CHECK(view.data() == numbers->data());
    CHECK_FALSE(view.unique());
    numbers.reset();
    CHECK_FALSE(watch.expired());
  }
  CHECK(watch.expired());
}

TEST_CASE("what was packed for a buffer ends with it") {
  const auto packed = std::make_shared<int>(1);
  {
    const BufferHandle b(100);
    b.packed() = packed;
    CHECK(packed.use_count() == 2);
  }
  CHECK(packed.use_count() == 1);
  const BufferHandle again(100);
  CHECK(again.packed() == nullptr);
}

TEST_CASE("a buffer may be freed by another thread than the one that made it, which does not keep it") {
  for (int i = 0; i < 10; ++i) {
    BufferHandle here(1000);
    std::thread([there = std::move(here)]() mutable { there = BufferHandle(); }).join();
  }
  BufferPool::local().trim();
  const auto before = allocations();
  BufferHandle foreign;
  std::thread([&] { foreign = BufferHandle(1000); }).join();
  foreign = BufferHandle();
  const BufferHandle own(1000);
  CHECK(allocations() == before + 1);
}

TEST_CASE("buffers outlive the pool of their thread, and can be made without it") {
  struct Last {  // made before the thread's pool, so destroyed after it
    BufferHandle kept;
    ~Last() {
      kept = BufferHandle(1000);
      std::memset(kept.data(), 1, 1000);
    }
  };
  std::thread([] {
    thread_local Last last;
    last.kept = BufferHandle(1000);
  }).join();  // the address sanitizer watches
}
