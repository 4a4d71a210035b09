// The tape: which gradients come back, shared subexpressions, graphs that are deep or walked twice. That gradients are
// right is checked by tests/ops and tests/laws.
#include <thread>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/fused.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;
using Vector = ml::Tensor<A, 1>;
using Values = std::vector<double>;

namespace {

Vector variable(const Values& values) { return ml::variable<A>(ml::Tensor<B, 1>::from(values, {std::ssize(values)})); }

}  // namespace

TEST_CASE("a subexpression that is used several times is walked once and adds up") {
  const auto x = variable({2, 3});
  int used = 0;
  auto y = x;
  for (; used < 40; ++used) y = (y + y) * 0.5;  // 2^40 paths from y to x
  CHECK(ml::backward(ml::sum(y * y))[x].to_vector() == Values{4, 6});
  CHECK(ml::backward(ml::sum(x * x * x))[x].to_vector() == Values{12, 27});
}

TEST_CASE("gradients are a value: nothing is kept in the variables") {
  const auto x = variable({2}), unused = variable({5, 6});
  const auto first = ml::backward(ml::sum(x * 3.0)), second = ml::backward(ml::sum(x * x));
  CHECK(first[x].item() == 3);
  CHECK(second[x].item() == 4);
  CHECK(first[unused].to_vector() == Values{0, 0});
  CHECK(first.find(unused.data()) == nullptr);
}

TEST_CASE("only variables have gradients") {
  const auto x = variable({2});
  const auto y = x * x;
  const auto gradients = ml::backward(ml::sum(y));
  CHECK_ERROR(gradients[y], "[motionlang.config.102] Gradients: a tensor (1) is the result of an operation");
  CHECK_ERROR(gradients[ml::stop_gradient(x)], "[motionlang.config.102] Gradients: a tensor (1) is a constant");
}

TEST_CASE("threads differentiate losses over the same variables at once") {
  const auto x = variable({2, 3});
  const auto work = [&](double factor, int& right) {
    for (int i = 0; i < 2000; ++i) {
      auto y = x;
      for (int k = 0; k < 20; ++k) y = y + x;
      right += ml::backward(ml::sum(y * factor))[x].to_vector() == Values{21 * factor, 21 * factor};
    }
  };
  int here = 0, there = 0;
  std::thread other([&] { work(2, there); });
  work(3, here);
  other.join();
  CHECK(here == 2000);
  CHECK(there == 2000);
}

TEST_CASE("constants build no graph") {
  const auto c = Vector::from({1, 2}, {2});
  CHECK((c * 2.0 + c).data().node == nullptr);
  CHECK(ml::backward(ml::sum(c)).find(c.data()) == nullptr);
  const auto x = variable({1, 2});
  CHECK((x + c).data().node != nullptr);
  CHECK(ml::stop_gradient(x).data().node == nullptr);
  CHECK(ml::value_of(x).to_vector() == Values{1, 2});
}

TEST_CASE("the gradient of a variable itself is 1") {
  const auto x = ml::variable<A>(ml::Tensor<B, 0>(5.0));
  CHECK(ml::backward(x)[x].item() == 1);
}

TEST_CASE("a graph is walked once; a second walk is refused and does no harm") {
  const auto x = variable({2});
  const auto shared = x * x;
  const auto loss = ml::sum(shared), other = ml::sum(shared * 2.0);
  CHECK(ml::backward(loss)[x].item() == 4);
  CHECK_ERROR(ml::backward(loss), "[motionlang.config.102] backward: this graph has been walked already");
  CHECK_ERROR(ml::backward(other), "[motionlang.config.102]");
  CHECK(ml::backward(ml::sum(x * x))[x].item() == 4);
}

TEST_CASE("a chain of two million operations neither overflows the stack when walked nor when released") {
  for (bool walk : {true, false}) {
    const auto x = ml::variable<A>(ml::Tensor<B, 0>(1.0));
    auto y = x;
    for (int i = 0; i < 2'000'000; ++i) y = y + x;
    if (walk) CHECK(ml::backward(y)[x].item() == 2'000'001);
  }
}

TEST_CASE("a tensor of variables may be gathered with repetition, and equal maxima give the first the gradient") {
  const auto x = variable({1, 7, 7});
  const std::vector<ml::Index> rows{1, 1, 0};
  CHECK(ml::backward(ml::sum(ml::gather(x, rows)))[x].to_vector() == Values{1, 2, 0});
  CHECK(ml::backward(ml::sum(ml::maximum(x, x * 1.0)))[x].to_vector() == Values{1, 1, 1});
}

TEST_CASE("the slope of abs at 0 is 0") {
  const auto x = variable({-2, 0, 3});
  CHECK(ml::backward(ml::sum(ml::abs(x)))[x].to_vector() == Values{-1, 0, 1});
  CHECK(ml::abs(x).to_vector() == Values{2, 0, 3});
}

TEST_CASE("the optimiser's view of a variable keeps its place in later graphs") {
  auto x = variable({1, 2});
  A::mutable_value(x.mutable_data()) = ml::Tensor<B, 1>::from({10, 20}, {2}).data();
  CHECK(ml::backward(ml::sum(x * x))[x].to_vector() == Values{20, 40});
}

TEST_CASE("a checkpoint gives the value and the gradients of what it stands for") {
  const auto x = variable({2, 3}), weight = variable({5, 7});
  const auto f = [&](const Vector& a, const Vector& b) { return ml::exp(a * 0.1) * weight + a * b * a; };
  const auto loss = [&](auto&& call) {
    const auto a = x * 3.0;
    return ml::sum(call(a, x) * a) + ml::sum(weight * x);
  };
  const auto plain = loss(f), kept = loss([&](const auto&... inputs) { return ml::checkpoint(f, inputs...); });
  CHECK(plain.item() == kept.item());
  const auto expected = ml::backward(plain), found = ml::backward(kept);
  for (const auto& v : {x, weight}) CHECK(tensors::same_bits(found[v], expected[v]));
}

TEST_CASE("a checkpoint calls its function once for the value and once for the gradients") {
  const auto x = variable({2});
  int calls = 0;
  const auto square = [&calls](const Vector& v) { return ++calls, v * v; };
  const auto inner = [&](const Vector& v) { return ml::checkpoint(square, v) * 1.0; };
  const auto loss = ml::sum(ml::checkpoint(inner, x));
  CHECK(calls == 1);
  CHECK(ml::backward(loss)[x].item() == 4);
  CHECK(calls == 3);  // the value of the inner one once more, then its gradient
  CHECK_ERROR(ml::backward(loss), "[motionlang.config.102] backward: this graph has been walked already");
}

TEST_CASE("constants and the function that returns its input need no checkpoint") {
  const auto x = variable({2});
  const auto c = Vector::from({3}, {1});
  CHECK(ml::checkpoint([](const Vector& v) { return v * v; }, c).data().node == nullptr);
  CHECK(ml::checkpoint([](const Vector& v) { return v; }, x).data().node == x.data().node);
  CHECK(ml::backward(ml::sum(ml::checkpoint([](const Vector& v, const Vector& w) { return v * w; }, x, c)))[x].item() ==
        3);
  CHECK(ml::backward(ml::sum(ml::checkpoint([&](const Vector& v) { return v * x; }, c)))[x].item() == 3);
}

TEST_CASE("a checkpoint refuses results that are not among its inputs") {
  const auto x = variable({2});
  const auto y = x * x;
  const auto hidden = ml::checkpoint([&](const Vector& v) { return v * y; }, x);
  CHECK_ERROR(ml::backward(ml::sum(hidden + y)),
              "[motionlang.config.102] backward: a checkpoint recomputes with a result");
}

TEST_CASE("layer norms and attention are calculated again where a product needs their result: no value changes") {
  const auto x = tensors::normal<A, 2>({6, 12}, 1);
  const auto gain = tensors::normal<A, 1>({12}, 3), shift = tensors::normal<A, 1>({12}, 4);
  const auto loss = [](const ml::Tensor<A, 2>& y, const ml::Tensor<A, 2>& w) {
    return ml::sum(ml::square(ml::linear<A>(y, w, nullptr)));
  };
  for (const auto& y :
       {ml::layer_norm(x * 2.0, gain, shift),
        ml::self_attention(x * 2.0, ml::Offsets{4, 2}, {.heads = 2, .dropout = {.p = 0.5, .key = 7}})}) {
    const auto w = tensors::normal<A, 2>({5, y.size(1)}, 2);
    const auto kept = ml::variable<A>(ml::value_of(y));  // this is not calculated again
    CHECK(tensors::same_bits(ml::backward(loss(y, w))[w], ml::backward(loss(kept, w))[w]));
  }
}
