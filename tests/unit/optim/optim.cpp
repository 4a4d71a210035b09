// AdamW by hand, averages, learning rates, clipping.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/optim/ema.hpp>
#include <motionlang/optim/lr_schedule.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;
using doctest::Approx;

namespace {

template <ml::Backend C>
struct Numbers {
  ml::Tensor<C, 1> used, unused;
  static constexpr auto fields() { return ml::fields("used", &Numbers::used, "unused", &Numbers::unused); }
};

Numbers<A> numbers(double value = 1) {
  const auto one = ml::Tensor<B, 1>::full({1}, value);
  return {ml::variable<A>(one), ml::variable<A>(one)};
}
/// A loss with this gradient.
ml::Gradients<A> with_gradient(const Numbers<A>& model, double g) { return ml::backward(ml::sum(model.used * g)); }

double value(const Numbers<A>& model) { return model.used.span()[0]; }

}  // namespace

TEST_CASE("AdamW as computed by hand, three steps") {
  auto model = numbers();
  const ml::AdamWConfig c{.lr = 0.1, .beta1 = 0.8, .beta2 = 0.9, .eps = 1e-3, .weight_decay = 0.5};
  ml::AdamW<A> adam(c);
  double p = 1, m = 0, v = 0, b1 = 1, b2 = 1;
  for (double g : {2.0, -1.0, 0.5}) {
    adam.step(model, with_gradient(model, g));
    p *= 1 - 0.1 * 0.5;
    m = 0.8 * m + 0.2 * g, v = 0.9 * v + 0.1 * g * g;
    b1 *= 0.8, b2 *= 0.9;
    p -= 0.1 * (m / (1 - b1)) / (std::sqrt(v / (1 - b2)) + 1e-3);
    CHECK(value(model) == Approx(p).epsilon(1e-12));
  }
  CHECK(adam.steps() == 3);
}

TEST_CASE("a parameter that the loss does not reach stays as it is, without decay") {
  auto model = numbers();
  ml::AdamW<A> adam({.lr = 0.1, .weight_decay = 0.5});
  adam.step(model, with_gradient(model, 1));
  CHECK(model.unused.span()[0] == 1);
  CHECK(adam.state().size() == 1);
}

TEST_CASE("an optimiser that goes on from its state makes the same steps") {
  auto a = numbers(), b = numbers();
  ml::AdamW<A> first({.lr = 0.1}), second({.lr = 0.1}), resumed({.lr = 0.1});
  for (double g : {1.0, 3.0}) first.step(a, with_gradient(a, g));
  second.step(b, with_gradient(b, 1.0));
  resumed.restore(second.steps(), second.state());
  resumed.step(b, with_gradient(b, 3.0));
  CHECK(value(a) == value(b));
}

TEST_CASE("in float, too, what is new weighs 1 - beta of the decimal number") {
  using F = ml::EigenBackend<float>;
  const auto one = ml::Tensor<F, 1>::full({1}, 1);
  Numbers<ml::Autodiff<F>> model{ml::variable<ml::Autodiff<F>>(one), ml::variable<ml::Autodiff<F>>(one)};
  ml::AdamW<ml::Autodiff<F>> adam({.beta1 = 0.9, .beta2 = 0.999});
  adam.step(model, ml::backward(ml::sum(model.used)));
  const auto& moments = adam.state().at("used");
  CHECK(F::to_span(moments.m)[0] == 0.1F);
  CHECK(F::to_span(moments.v)[0] == 0.001F);  // 1 - 0.999F is 0.00099998713
}

TEST_CASE("moments of another model are refused") {
  auto model = numbers();
  ml::AdamW<A> adam;
  const auto one = B::full({1}, 0), two = B::full({2}, 0);
  for (const auto& moments : {ml::AdamW<A>::Moments{two, two}, {one, two}}) {
    adam.restore(1, {{"used", moments}});
    CHECK_ERROR(adam.step(model, with_gradient(model, 1)), "[motionlang.shape.204] AdamW: 'used' is (1)");
  }
}

namespace {

/// A module of one member under two names: a path of each is "x.a".
struct Inner {
  ml::Tensor<A, 1> a;
  static constexpr auto fields() { return ml::fields("a", &Inner::a); }
};
struct SamePaths {
  Inner x;
  ml::Tensor<A, 1> b;
  static constexpr auto fields() { return ml::fields("x", &SamePaths::x, "x.a", &SamePaths::b); }
};
/// A statistic is not a parameter.
struct Statistic {
  static constexpr bool trainable = false;
  ml::Tensor<A, 1> mean;
  static constexpr auto fields() { return ml::fields("mean", &Statistic::mean); }
};
struct WithStatistic {
  Statistic statistic;
  ml::Tensor<A, 1> used;
  static constexpr auto fields() {
    return ml::fields("statistic", &WithStatistic::statistic, "used", &WithStatistic::used);
  }
};

}  // namespace

TEST_CASE("a parameter that would not be trained is an error, and nothing has changed by then") {
  auto model = numbers();
  const auto gradients = with_gradient(model, 1);
  ml::AdamW<A> adam({.lr = 0.1});
  model.unused = ml::Tensor<A, 1>::full({1}, 1);
  CHECK_ERROR(
      adam.step(model, gradients),
      "[motionlang.config.102] AdamW: parameter 'unused' is a constant, not a variable: it would not be trained");
  model.unused = model.used + 1.0;
  CHECK_ERROR(adam.step(model, gradients), "AdamW: parameter 'unused' is the result of an operation");
  CHECK(adam.steps() == 0);
  CHECK(value(model) == 1);
  adam.config.allow_constants = true;
  adam.step(model, gradients);
  CHECK(value(model) < 1);

  const auto constant = ml::Tensor<A, 1>::full({1}, 1);
  const auto one = ml::Tensor<B, 1>::full({1}, 1);
  WithStatistic with_statistic{{constant}, ml::variable<A>(one)};
  ml::AdamW<A> other;
  other.step(with_statistic, ml::backward(ml::sum(with_statistic.used)));
  CHECK(other.steps() == 1);

  SamePaths same{{ml::variable<A>(one)}, ml::variable<A>(one)};
  CHECK_ERROR(other.step(same, ml::backward(ml::sum(same.x.a + same.b))),
              "[motionlang.config.102] AdamW: two parameters are 'x.a'");
}

TEST_CASE("clipping: the norm over all gradients, a factor of at most 1, applied before the moments") {
  ml::Philox rng{.seed = 1};
  ml::Linear<A> layer(2, 1, rng);
  const auto x = ml::Tensor<A, 2>::from({3, 0}, {1, 2});
  const auto gradients = ml::backward(ml::sum(layer(x) * 4.0));  // 12, 0 for the weight, 4 for the bias
  CHECK(ml::gradient_norm(layer, gradients) == Approx(std::sqrt(160.0)));
  CHECK(ml::clip_scale(2, 4) == 1);
  CHECK(ml::clip_scale(8, 4) == Approx(0.5));
  CHECK(ml::clip_scale(0, 4) == 1);

  auto clipped = numbers(), small = numbers();
  ml::AdamW<A> adam({.lr = 0.1, .eps = 1}), other({.lr = 0.1, .eps = 1});
  adam.step(clipped, with_gradient(clipped, 8), 0.5);
  other.step(small, with_gradient(small, 4));
  CHECK(value(clipped) == value(small));
}

TEST_CASE("the average starts with the model and slows down") {
  Numbers<B> average{ml::Tensor<B, 1>::zeros({1}), ml::Tensor<B, 1>::zeros({1})};
  const auto model = numbers(10);
  ml::update_ema(average, model, 0.99, 0);
  CHECK(average.used.item() == Approx(9));  // (1 + 0) / (10 + 0) of the old value
  ml::update_ema(average, model, 0.99, 1'000'000);
  CHECK(average.used.item() == Approx(9.01));
}

TEST_CASE("learning rates") {
  const ml::WarmupCosine c{.peak = 1, .floor = 0.1, .warmup = 4, .total = 14};
  CHECK(c(0) == 0.25);
  CHECK(c(3) == 1);
  CHECK(c(4) == 1);
  CHECK(c(9) == Approx(0.55));
  CHECK(c(14) == Approx(0.1));
  CHECK(c(1000) == Approx(0.1));
  CHECK(ml::WarmupCosine{.peak = 2}(0) == 2);
  const ml::StepDecay d{.rate = 8, .factor = 2, .every = 10};
  CHECK(d(9) == 8);
  CHECK(d(10) == 4);
  CHECK(d(35) == 1);
  CHECK(ml::StepDecay{.rate = 8, .factor = 2, .every = 0}(1) == 4);
}

TEST_CASE("a line is fitted") {
  ml::Philox rng{.seed = 2};
  ml::Linear<A> line(1, 1, rng);
  ml::AdamW<A> adam({.lr = 0.05, .weight_decay = 0});
  const auto x = ml::Tensor<A, 2>::from({-1, 0, 1, 2}, {4, 1}), y = x * 3.0 - 1.0;
  for (int i = 0; i < 1000; ++i) adam.step(line, ml::backward(ml::mean(ml::square(line(x) - y))));
  CHECK(line.weight.item() == Approx(3).epsilon(1e-4));
  CHECK(line.bias.item() == Approx(-1).epsilon(1e-4));
}
