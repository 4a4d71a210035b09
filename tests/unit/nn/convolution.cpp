// Convolution over time and batch normalisation: against plain loops, packed and alone, gradients, what is refused.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/batch_norm.hpp>
#include <motionlang/nn/conv1d.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets, ml::Conv1dOptions;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<ml::ReferenceBackend<double>>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::normal, tensors::same_bits;

namespace {

/// One sequence, number by number.
Matrix convolved(const Matrix& x, const ml::Tensor<B, 3>& w, const ml::Tensor<B, 1>& bias, const Conv1dOptions& o) {
  const Index in = x.size(1), out = w.size(0), kernel = w.size(2);
  std::vector<double> y;
  for (Index t = 0; t * o.stride + (kernel - 1) * o.dilation < x.size(0) + 2 * o.padding; ++t) {
    for (Index c = 0; c < out; ++c) {
      double sum = bias.span()[static_cast<std::size_t>(c)];
      for (Index j = 0; j < kernel; ++j) {
        const Index at = t * o.stride + j * o.dilation - o.padding;
        for (Index i = 0; i < in && at >= 0 && at < x.size(0); ++i) {
          sum += x.span()[static_cast<std::size_t>(at * in + i)] *
                 w.span()[static_cast<std::size_t>((c * in + i) * kernel + j)];
        }
      }
      y.push_back(sum);
    }
  }
  return Matrix::from(y, {std::ssize(y) / out, out});
}

/// (f(x + h) - f(x - h)) / 2h for one number of x.
template <class F>
double slope(const ml::Tensor<ml::ReferenceBackend<double>, 2>& x, std::size_t at, F f) {
  auto moved = [&](double h) {
    auto v = x.to_vector();
    v[at] += h;
    return f(ml::Tensor<ml::ReferenceBackend<double>, 2>::from(v, x.shape()));
  };
  return (moved(1e-6) - moved(-1e-6)) / 2e-6;
}

}  // namespace

TEST_CASE("conv1d: strides, padding and dilation, as a plain loop has them; each sequence by itself") {
  const ml::Sequences<B> x(normal<B, 2>({16, 3}, 1), Offsets{9, 7});
  for (const Conv1dOptions o :
       {Conv1dOptions{}, Conv1dOptions{.padding = 1}, Conv1dOptions{.stride = 2, .padding = 1},
        Conv1dOptions{.padding = 6, .dilation = 3}, Conv1dOptions{.stride = 3, .dilation = 2}}) {
    for (Index kernel : {1, 3, 4}) {
      if (o.dilation * (kernel - 1) >= 7 + 2 * o.padding) continue;
      ml::Philox rng{.seed = 2};
      const ml::Conv1d<B> conv(3, 5, kernel, o, rng);
      const auto y = conv(x);
      for (Index s : {0, 1}) {
        CHECK(distance(y[s], convolved(x[s], conv.weight, conv.bias, o)) < 1e-13);
        CHECK(same_bits(y[s], conv(ml::Sequences<B>(x[s], Offsets{x.offsets.length(s)})).rows));
        CHECK(y.offsets.length(s) == ml::conv1d_length(x.offsets.length(s), kernel, o));
      }
    }
  }
  ml::Philox rng{.seed = 2};
  const ml::Conv1d<B> conv(3, 5, 4, {}, rng);
  CHECK_ERROR(conv(ml::Sequences<B>(Matrix::zeros({3, 3}), Offsets{3})), "[motionlang.shape.205]");
  CHECK_ERROR(conv(ml::Sequences<B>(Matrix::zeros({9, 2}), Offsets{9})), "[motionlang.shape.201]");
  CHECK_ERROR(ml::conv1d_length(9, 3, {.stride = 0}), "[motionlang.config.101]");
  const auto short_bias = ml::Tensor<B, 1>::zeros({4});
  CHECK_ERROR(ml::conv1d(x, conv.weight, &short_bias), "[motionlang.shape.204]");
}

TEST_CASE("conv1d: gradients are central differences") {
  ml::Philox rng{.seed = 3};
  const auto conv = ml::convert<A>(ml::Conv1d<A::inner>(2, 3, 3, {.stride = 2, .padding = 1}, rng));
  const Offsets offsets{5, 4};
  const auto start = normal<A::inner, 2>({9, 2}, 4);
  auto loss = [&](const ml::Tensor<A, 2>& x) { return ml::sum(ml::square(conv(ml::Sequences<A>(x, offsets)).rows)); };
  const auto x = ml::variable<A>(start);
  const auto gradient = ml::backward(loss(x))[x];
  for (std::size_t i = 0; i < 18; ++i) {
    const double want = slope(start, i, [&](const auto& moved) { return loss(ml::variable<A>(moved)).item(); });
    CHECK(gradient.span()[i] == doctest::Approx(want).epsilon(1e-6));
  }
}

TEST_CASE("batch norm: the batch's statistics in training, running ones in use") {
  ml::BatchNorm<B> norm(2);
  const auto x = Matrix::from({1, 10, 3, 10, 5, 40}, {3, 2});
  CHECK(distance(norm(x), x) < 1e-5);  // mean 0, variance 1 before any training
  const auto y = norm.train(x);
  for (Index c : {0, 1}) {
    const auto column = ml::slice(y, 1, c, c + 1);
    CHECK(ml::sum(column).item() == doctest::Approx(0).epsilon(1e-12));
    CHECK(ml::mean(ml::square(column)).item() == doctest::Approx(1).epsilon(1e-4));
  }
  // mean (3, 20); variance with n - 1: (4, 300)
  CHECK(distance(norm.statistics.running_mean, ml::Tensor<B, 1>::from({0.3, 2}, {2})) < 1e-12);
  CHECK(distance(norm.statistics.running_var, ml::Tensor<B, 1>::from({0.9 + 0.4, 0.9 + 30}, {2})) < 1e-12);
  CHECK(norm.statistics.num_batches_tracked.item() == 1);
  for (int i = 0; i < 400; ++i) norm.train(x);
  CHECK(norm(x).at(0, 0) == doctest::Approx(-1).epsilon(1e-4));  // (1 - 3) / sqrt(4)
  CHECK_ERROR(norm.train(Matrix::zeros({1, 2})), "[motionlang.shape.205]");
  CHECK_ERROR(norm(Matrix::zeros({4, 3})), "[motionlang.shape.204]");
}

TEST_CASE("batch norm: its statistics stand beside its parameters, and only these are trained") {
  std::vector<std::string> names;
  const auto norm = ml::convert<A>(ml::BatchNorm<A::inner>(2));
  ml::visit_tensors(norm, [&](const std::string& path, const auto& t) {
    names.push_back(path);
    CHECK((t.data().node != nullptr) == (path == "weight" || path == "bias"));
  });
  CHECK(names == std::vector<std::string>{"weight", "bias", "running_mean", "running_var", "num_batches_tracked"});
}

TEST_CASE("batch norm: gradients of training are central differences; statistics stay constants") {
  const auto start = normal<A::inner, 2>({4, 2}, 5), weights = normal<A::inner, 2>({4, 2}, 6);
  auto loss = [&](ml::BatchNorm<A>& norm, const ml::Tensor<A, 2>& x) {
    return ml::sum(ml::square(norm.train(x)) * ml::Tensor<A, 2>::from(weights.to_vector(), {4, 2}));
  };
  auto norm = ml::convert<A>(ml::BatchNorm<A::inner>(2));
  const auto x = ml::variable<A>(start);
  const auto gradient = ml::backward(loss(norm, x))[x];
  CHECK(norm.statistics.running_mean.data().node == nullptr);
  for (std::size_t i = 0; i < 8; ++i) {
    const double want = slope(start, i, [&](const auto& moved) { return loss(norm, ml::variable<A>(moved)).item(); });
    CHECK(gradient.span()[i] == doctest::Approx(want).epsilon(1e-5));
  }
}
