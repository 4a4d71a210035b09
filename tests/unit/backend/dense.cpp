// Dense storage: who shares memory with whom.
#include <doctest/doctest.h>

#include <motionlang/backend/dense.hpp>
#include <motionlang/backend/dense_ops.hpp>

namespace ml = motionlang;
using Dense = ml::Dense<float>;
using Ops = ml::DenseOps<float>;

TEST_CASE("copies, shapes and leading rows are views; everything else copies") {
  const auto a = Dense::from_span(std::vector<float>{1, 2, 3, 4, 5, 6}, {3, 2});
  CHECK(a.unique());
  const auto rows = a.rows(1, 3);
  CHECK(rows.shape() == ml::Shape{2, 2});
  CHECK(rows.data() == a.data() + 2);
  CHECK_FALSE(a.unique());
  CHECK(rows.rows(1, 2).data() == a.data() + 4);
  CHECK(rows.reshaped({4}).span()[3] == 6);
  CHECK(Ops::slice(a, 0, 1, 3).data() == rows.data());
  CHECK(Ops::slice(a, 1, 0, 2).data() != a.data());
}

TEST_CASE("memory of somebody else is kept alive and never written") {
  auto owner = std::make_shared<std::vector<float>>(std::vector<float>{1, 2});
  const std::weak_ptr<std::vector<float>> watch = owner;
  {
    const Dense view(owner->data(), {2}, owner);
    owner.reset();
    CHECK(view.span()[1] == 2);
    CHECK_FALSE(view.unique());
    CHECK_FALSE(watch.expired());
  }
  CHECK(watch.expired());
}

TEST_CASE("a packed form lives and dies with the memory, and belongs to all of it only") {
  const Dense a = Dense::full({2, 2}, 1);
  CHECK(a.attached() == nullptr);
  const auto packed = std::make_shared<int>(7);
  a.attach(packed);
  const Dense copy = a;
  CHECK(copy.attached() == packed.get());
  CHECK(a.rows(1, 2).attached() == nullptr);
  CHECK_FALSE(Dense().defined());
}
