// Tensor handles: making, reading, sharing, and what is refused.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>
#include <motionlang/tensor/tensor.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
template <int R>
using Tensor = ml::Tensor<B, R>;

TEST_CASE("values go in and out in row-major order") {
  const auto t = Tensor<2>::from({1, 2, 3, 4, 5, 6}, {2, 3});
  CHECK(t.shape() == ml::Shape{2, 3});
  CHECK(t.size(0) == 2);
  CHECK(t.size(-1) == 3);
  CHECK(t.count() == 6);
  CHECK(t.to_vector() == std::vector<float>{1, 2, 3, 4, 5, 6});
  CHECK(Tensor<2>::full({1, 2}, 0.5).to_vector() == std::vector<float>{0.5, 0.5});
  CHECK(Tensor<0>(7.0).item() == 7);
  CHECK(Tensor<3>(7.0).shape() == ml::Shape{1, 1, 1});  // one number broadcasts against anything
  CHECK(Tensor<2>::zeros({0, 3}).to_vector().empty());
}

template <ml::Backend C>
void check_written() {
  using S = typename C::scalar;
  const auto t = ml::Tensor<C, 2>::written({2, 3}, [](S* to) {
    for (int i = 0; i < 6; ++i) to[i] = static_cast<S>(i);
  });
  CHECK(t.shape() == ml::Shape{2, 3});
  CHECK(t.to_vector() == std::vector<S>{0, 1, 2, 3, 4, 5});
}
TEST_CASE("numbers are written where the tensor will have them") {
  check_written<B>();
  check_written<ml::ReferenceBackend<double>>();
  check_written<ml::Autodiff<B>>();
  const float* place = nullptr;
  const auto t = Tensor<1>::written({1}, [&](float* to) { *to = 7, place = to; });
  CHECK(t.data().data() == place);
}

TEST_CASE("the same seed gives the same random tensor") {
  ml::Philox a{.seed = 3}, b{.seed = 3};
  const auto x = Tensor<2>::randn({4, 5}, a), y = Tensor<2>::randn({4, 5}, b);
  CHECK(x.to_vector() == y.to_vector());
  CHECK(Tensor<2>::randn({4, 5}, a).to_vector() != x.to_vector());
}

TEST_CASE("a copy never sees what happens to the original") {
  auto a = Tensor<1>::from({1, 2, 3}, {3});
  const auto copy = a;
  a = std::move(a) + 10.0;
  CHECK(a.to_vector() == std::vector<float>{11, 12, 13});
  CHECK(copy.to_vector() == std::vector<float>{1, 2, 3});
  CHECK(copy.data().data() != a.data().data());
  const auto shared = copy;
  CHECK(shared.data().data() == copy.data().data());  // nobody has written: one memory
}

TEST_CASE("a temporary is computed in place") {
  auto a = Tensor<1>::from({1, 2, 3}, {3});
  const float* memory = a.data().data();
  const auto b = ml::exp(std::move(a) * 2.0);
  CHECK(b.data().data() == memory);
}

TEST_CASE("a tensor that has not been made has no numbers, and nothing can be computed with it") {
  const Tensor<2> none;
  CHECK(none.shape() == ml::Shape{0});
  CHECK(none.to_vector().empty());
  CHECK_ERROR(Tensor<0>().item(), "[motionlang.shape.205] Tensor::item: shape (0) has 0 elements");
  CHECK_ERROR(none + Tensor<2>::zeros({2, 3}), "[motionlang.shape.202]");
  CHECK_ERROR(ml::exp(none), "[motionlang.shape.206]");
  CHECK_ERROR(ml::matmul(none, none), "[motionlang.shape.206] matmul: no tensor yet, or moved from; rank 2 expected");
  CHECK_ERROR(ml::matmul(Tensor<2>::zeros({3, 0}), none), "[motionlang.shape.206]");
  CHECK_ERROR(ml::sum(none), "[motionlang.shape.206]");
  CHECK_ERROR(ml::mean(none, 1), "[motionlang.shape.206]");
  CHECK_ERROR(ml::max(none, 1), "[motionlang.shape.206]");
  CHECK_ERROR(ml::transpose(none), "[motionlang.shape.206]");
  CHECK_ERROR(ml::slice(none, 0, 0, 0), "[motionlang.shape.206]");
  CHECK_ERROR(ml::reshape<1>(none, {0}), "[motionlang.shape.206]");
  CHECK_ERROR(ml::softmax(none), "[motionlang.shape.206]");
}

/// Every operation on x, which is not a tensor, beside one that is.
template <ml::Backend C, int R>
void check_refused(const ml::Tensor<C, R>& x, const ml::Tensor<C, R>& other) {
  CHECK_FALSE(x.defined());
  CHECK(x.shape() == ml::Shape{0});
  for (const auto& f :
       {ml::exp<C, R>, ml::log<C, R>, ml::sqrt<C, R>, ml::tanh<C, R>, ml::erf<C, R>, ml::sin<C, R>, ml::cos<C, R>}) {
    CHECK_ERROR(f(x), "[motionlang.shape.206]");
  }
  CHECK_ERROR(x + x, "[motionlang.shape.206]");
  CHECK_ERROR(x - x, "[motionlang.shape.206]");
  CHECK_ERROR(x * x, "[motionlang.shape.206]");
  CHECK_ERROR(x / x, "[motionlang.shape.206]");
  CHECK_ERROR(x * 2.0, "[motionlang.shape.206]");
  CHECK_ERROR(1.0 - x, "[motionlang.shape.206]");
  CHECK_ERROR(-x, "[motionlang.shape.206]");
  CHECK_ERROR(ml::maximum(x, x), "[motionlang.shape.206]");
  CHECK_ERROR(ml::atan2(x, x), "[motionlang.shape.206]");
  CHECK_ERROR(ml::abs(x), "[motionlang.shape.206]");
  CHECK_ERROR(ml::where_less(x, x, x, x), "[motionlang.shape.206]");
  CHECK_ERROR(x + other, "[motionlang.shape.20");  // 202 unless they broadcast
  CHECK_ERROR(ml::sum(x), "[motionlang.shape.206]");
  CHECK_ERROR(ml::mean(x), "[motionlang.shape.206]");
  CHECK_ERROR(ml::sum(x, 0), "[motionlang.shape.206]");
  CHECK_ERROR(ml::max(x, 0), "[motionlang.shape.206]");
  CHECK_ERROR(ml::slice(x, 0, 0, 0), "[motionlang.shape.206]");
  CHECK_ERROR(ml::concat(0, x, x), "[motionlang.shape.206]");
  const std::vector<ml::Tensor<C, R>> list{x, x};
  CHECK_ERROR(ml::concat(std::span<const ml::Tensor<C, R>>(list), 0), "[motionlang.shape.206]");
  CHECK_ERROR(ml::gather(x, std::vector<ml::Index>{}), "[motionlang.shape.206]");
  CHECK_ERROR(ml::scatter_add(x, std::vector<ml::Index>{}, 1), "[motionlang.shape.206]");
  CHECK_ERROR(ml::reshape<1>(x, {0}), "[motionlang.shape.206]");
  CHECK_ERROR((ml::broadcast_to<R>(x, x.shape())), "[motionlang.shape.206]");
  CHECK_ERROR(ml::activate(x, ml::Activation::gelu), "[motionlang.shape.206]");
  CHECK_ERROR(ml::dropout(x, {}), "[motionlang.shape.206]");
}
template <ml::Backend C>
void check_moved() {
  auto matrix = ml::Tensor<C, 2>::full({2, 3}, 1);
  auto list = ml::Tensor<C, 1>::full({3}, 1);
  const auto taken = std::move(matrix);
  const auto also_taken = std::move(list);
  check_refused(matrix, taken);     // NOLINT: what is left after a move is what is tested
  check_refused(list, also_taken);  // NOLINT
  CHECK_ERROR(matrix.at(0, 0), "[motionlang.shape.206] Tensor::at");
  CHECK_ERROR(list.at(0), "[motionlang.shape.206]");
  CHECK_ERROR(ml::transpose(matrix), "[motionlang.shape.206]");
  CHECK_ERROR(ml::softmax(matrix), "[motionlang.shape.206]");
  CHECK_ERROR(ml::self_attention(matrix, ml::Offsets{}, {}), "[motionlang.shape.206]");
  CHECK_ERROR(ml::attention(matrix, matrix, matrix, ml::Offsets{}, ml::Offsets{}, {}), "[motionlang.shape.206]");
  CHECK_ERROR(ml::linear<C>(matrix, matrix, nullptr), "[motionlang.shape.206]");
  CHECK_ERROR(ml::linear<C>(taken, matrix, nullptr), "[motionlang.shape.201]");
  CHECK_ERROR(ml::layer_norm(taken, list, list), "[motionlang.shape.204]");
  matrix = ml::Tensor<C, 2>::full({1, 1}, 4);
  CHECK(matrix.item() == 4);
  CHECK(ml::Tensor<C, 1>::zeros({0}).defined());  // an empty list is one
}
TEST_CASE("a tensor that was moved from is refused by every operation, and can be assigned to") {
  check_moved<B>();
  check_moved<ml::ReferenceBackend<double>>();
  check_moved<ml::Autodiff<B>>();
}

TEST_CASE("one number by its place") {
  const auto t = Tensor<3>::from({1, 2, 3, 4, 5, 6}, {1, 2, 3});
  CHECK(t.at(0, 0, 0) == 1);
  CHECK(t.at(0, 1, 2) == 6);
  CHECK(t.at(0U, ml::Index{1}, 0) == 4);
  CHECK(Tensor<0>(7.0).at() == 7);
  CHECK_ERROR(t.at(0, 2, 0), "[motionlang.shape.203] Tensor::at: index 2 of axis 1 of shape (1, 2, 3)");
  CHECK_ERROR(t.at(0, 0, -1), "[motionlang.shape.203]");
  CHECK_ERROR(t.at(std::size_t(-1), 0, 0), "[motionlang.shape.203]");
}

TEST_CASE("what does not fit is refused") {
  CHECK_ERROR(Tensor<2>::from({1, 2, 3}, {2, 2}), "[motionlang.shape.205] Tensor: 3 values for shape (2, 2)");
  CHECK_ERROR(Tensor<2>::full({3}, 0), "[motionlang.shape.206] Tensor: rank 2 expected, shape is (3)");
  CHECK_ERROR(Tensor<2>(Tensor<1>::zeros({3}).data()), "[motionlang.shape.206]");
  CHECK_ERROR(Tensor<1>::zeros({3}).item(), "[motionlang.shape.205]");
  CHECK_ERROR(Tensor<1>::zeros({3}).size(1), "[motionlang.shape.203]");
  CHECK_ERROR(Tensor<1>::zeros({-1}), "[motionlang.shape.205]");
  CHECK_ERROR(Tensor<1>::written({-1}, [](float*) {}), "[motionlang.shape.205]");
  CHECK_ERROR(Tensor<1>::written({2, 3}, [](float*) {}), "[motionlang.shape.206]");
}
