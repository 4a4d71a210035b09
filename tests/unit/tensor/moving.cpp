// Numbers that are moved and not calculated with, element by element against their definition: all backends share the
// code. Sizes are those of some threads' work, and not multiples of what is moved at once.
#include <doctest/doctest.h>
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>

#include <algorithm>
#include <numeric>

#include "../../support/tensors.hpp"
#include "../../support/threads.hpp"

namespace ml = motionlang;
using ml::Index, ml::Shape;
using B = ml::ReferenceBackend<float>;

namespace {

/// 0, 1, 2, ... in this shape.
template <int R>
ml::Tensor<B, R> counted(const Shape& s) {
  std::vector<float> values(static_cast<std::size_t>(s.count()));
  std::iota(values.begin(), values.end(), 0.0f);
  return ml::Tensor<B, R>::from(values, s);
}
/// f(index of each axis, place) for all elements.
template <std::size_t R, class F>
void each(const Shape& s, F f) {
  for (Index place = 0; place < s.count(); ++place) {
    std::array<Index, R> at{};
    Index rest = place;
    for (std::size_t i = R; i-- > 0; rest /= s[static_cast<int>(i)]) at[i] = rest % s[static_cast<int>(i)];
    f(at, static_cast<std::size_t>(place));
  }
}

template <std::size_t R>
void check_permutations(const Shape& s) {
  const auto x = counted<static_cast<int>(R)>(s);
  std::array<int, R> axes{};
  std::iota(axes.begin(), axes.end(), 0);
  do {
    const auto y = ml::permute(x, axes);
    Index wrong = 0;
    each<R>(y.shape(), [&](const std::array<Index, R>& at, std::size_t place) {
      std::array<Index, R> from{};
      for (std::size_t i = 0; i < R; ++i) from[static_cast<std::size_t>(axes[i])] = at[i];
      Index want = 0;
      for (std::size_t i = 0; i < R; ++i) want = want * s[static_cast<int>(i)] + from[i];
      if (y.span()[place] != static_cast<float>(want)) ++wrong;
    });
    CHECK_MESSAGE(wrong == 0, to_string(s), " to ", to_string(y.shape()));
  } while (std::next_permutation(axes.begin(), axes.end()));
}

void check_broadcast(const Shape& small, const Shape& s) {
  const auto x = counted<3>(small);
  const auto y = ml::broadcast_to<3>(x, s);
  Index wrong = 0;
  each<3>(s, [&](const std::array<Index, 3>& at, std::size_t place) {
    Index want = 0;
    for (int i = 0; i < 3; ++i) want = want * small[i] + (small[i] == 1 ? 0 : at[static_cast<std::size_t>(i)]);
    if (y.span()[place] != static_cast<float>(want)) ++wrong;
  });
  CHECK_MESSAGE(wrong == 0, to_string(small), " to ", to_string(s));
}

}  // namespace

TEST_CASE("permute: every order of the axes") {
  for (int threads : {1, 2}) {
    const Threads set(threads);
    for (const Shape& s : {Shape{1, 1}, Shape{7, 1}, Shape{0, 3}, Shape{203, 301}}) check_permutations<2>(s);
    for (const Shape& s : {Shape{3, 1, 5}, Shape{31, 2, 67}, Shape{2, 400, 53}, Shape{129, 40, 3}})
      check_permutations<3>(s);
    for (const Shape& s : {Shape{2, 3, 4, 5}, Shape{9, 17, 1, 23}, Shape{19, 3, 21, 33}}) check_permutations<4>(s);
    check_permutations<5>({3, 4, 2, 5, 3});
  }
}

TEST_CASE("broadcast_to: any axes repeated") {
  for (int threads : {1, 2}) {
    const Threads set(threads);
    const Shape s{21, 33, 45};
    for (int repeated = 0; repeated < 8; ++repeated) {
      Shape small = s;
      for (int i = 0; i < 3; ++i) {
        if ((repeated >> i & 1) != 0) small[i] = 1;
      }
      check_broadcast(small, s);
    }
  }
}

TEST_CASE("slice, concat, gather, scatter_add") {
  for (int threads : {1, 2}) {
    const Threads set(threads);
    const Index rows = 301, width = 211;
    const auto x = counted<2>({rows, width});
    const auto number = [&](Index r, Index c) { return static_cast<float>(r * width + c); };
    Index wrong = 0;
    const auto middle = ml::slice(x, 1, 5, 200);
    each<2>(middle.shape(),
            [&](const auto& at, std::size_t place) { wrong += middle.span()[place] != number(at[0], at[1] + 5); });
    for (int axis : {0, 1}) {
      const auto both = ml::concat(axis, x, x);
      each<2>(both.shape(), [&](const auto& at, std::size_t place) {
        wrong += both.span()[place] != number(at[0] % rows, at[1] % width);
      });
    }
    std::vector<Index> pick;
    for (Index i = 0; i < 500; ++i) pick.push_back(i * 7 % rows);
    const auto picked = ml::gather(x, pick);
    each<2>(picked.shape(), [&](const auto& at, std::size_t place) {
      wrong += picked.span()[place] != number(pick[static_cast<std::size_t>(at[0])], at[1]);
    });
    const auto ones = ml::Tensor<B, 2>::full({std::ssize(pick), width}, 1);
    const auto added = ml::scatter_add(ones, pick, rows);
    each<2>(added.shape(), [&](const auto& at, std::size_t place) {
      wrong += added.span()[place] != static_cast<float>(std::count(pick.begin(), pick.end(), at[0]));
    });
    CHECK(wrong == 0);
  }
}
