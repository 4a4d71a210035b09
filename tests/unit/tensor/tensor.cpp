// Tensor handles: making, reading, sharing, and what is refused.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>

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
  CHECK(Tensor<2>::zeros({0, 3}).span().empty());
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
  CHECK_ERROR(ml::matmul(none, none), "[motionlang.shape.206] matmul: no tensor yet, rank 2 expected");
  CHECK_ERROR(ml::matmul(Tensor<2>::zeros({3, 0}), none), "[motionlang.shape.206]");
  CHECK_ERROR(ml::sum(none), "[motionlang.shape.206]");
  CHECK_ERROR(ml::mean(none, 1), "[motionlang.shape.206]");
  CHECK_ERROR(ml::max(none, 1), "[motionlang.shape.206]");
  CHECK_ERROR(ml::transpose(none), "[motionlang.shape.206]");
  CHECK_ERROR(ml::slice(none, 0, 0, 0), "[motionlang.shape.206]");
  CHECK_ERROR(ml::reshape<1>(none, {0}), "[motionlang.shape.206]");
  CHECK_ERROR(ml::softmax(none), "[motionlang.shape.206]");
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
