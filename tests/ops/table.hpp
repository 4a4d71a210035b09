// One table of operations: every primitive and every fused operation, with shapes that matter. Three readers: parity
// with the reference backend, derivatives against central differences, timing (tests/bench/ops.cpp). A new operation is
// one row.
#pragma once

#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include <motionlang/core/rng.hpp>
#include <motionlang/nn/conv1d.hpp>
#include <motionlang/tensor/fused.hpp>

namespace table {

namespace ml = motionlang;
using ml::Index;
using ml::Shape;

/// How inputs are drawn.
enum class Domain {
  real,      // standard normal
  positive,  // |x| + 0.3
  apart,     // distinct values: no ties for max, no kinks within reach of a difference
};

template <ml::Backend B>
struct Row {
  std::string name;
  std::vector<Shape> inputs;
  std::function<typename B::tensor(const std::vector<typename B::tensor>&)> run;
  Domain domain = Domain::real;
  bool grows = true;  // sizes above 1 may all be multiplied by the same factor
};

template <ml::Backend B, int R>
ml::Tensor<B, R> as(const typename B::tensor& t) {
  return ml::Tensor<B, R>(t);
}

/// All rows over one backend.
template <ml::Backend B>
std::vector<Row<B>> rows() {
  using T = typename B::tensor;
  using In = const std::vector<T>&;
  std::vector<Row<B>> r;
  auto binary = [&](const std::string& name, auto f, Domain domain = Domain::real) {
    const std::vector<std::pair<Shape, Shape>> shapes{{{3, 5}, {3, 5}},    {{4, 3, 5}, {5}},   {{3, 5}, {3, 1}},
                                                      {{3, 1}, {1, 5}},    {{7}, {}},          {{}, {2, 3}},
                                                      {{2, 1, 3}, {4, 1}}, {{1, 37}, {19, 37}}};
    for (const auto& [a, b] : shapes) {
      r.push_back(
          {name + " " + to_string(a) + " " + to_string(b), {a, b}, [f](In x) { return f(x[0], x[1]); }, domain});
    }
  };
  binary("add", [](const T& a, const T& b) { return B::add(a, b); });
  binary("sub", [](const T& a, const T& b) { return B::sub(a, b); });
  binary("mul", [](const T& a, const T& b) { return B::mul(a, b); });
  binary(
      "div", [](const T& a, const T& b) { return B::div(a, b); }, Domain::positive);
  binary(
      "maximum", [](const T& a, const T& b) { return B::maximum(a, b); }, Domain::apart);
  binary(
      "atan2", [](const T& a, const T& b) { return B::atan2(a, b); }, Domain::positive);

  auto unary = [&](const std::string& name, auto f, Domain domain = Domain::real) {
    for (const Shape& s : {Shape{}, Shape{1}, Shape{3, 5}, Shape{2, 3, 17}}) {
      r.push_back({name + " " + to_string(s), {s}, [f](In x) { return f(x[0]); }, domain});
    }
  };
  unary("exp", [](const T& a) { return B::exp(a); });
  unary(
      "log", [](const T& a) { return B::log(a); }, Domain::positive);
  unary(
      "sqrt", [](const T& a) { return B::sqrt(a); }, Domain::positive);
  unary("tanh", [](const T& a) { return B::tanh(a); });
  unary("erf", [](const T& a) { return B::erf(a); });
  unary("sin", [](const T& a) { return B::sin(a); });
  unary("cos", [](const T& a) { return B::cos(a); });

  r.push_back({"where_less",
               {{4, 3}, {3}, {4, 1}, {1}},
               [](In x) { return B::where_less(x[0], x[1], x[2], x[3]); },
               Domain::apart});
  for (int axis = 0; axis < 3; ++axis) {
    r.push_back({"sum axis " + std::to_string(axis), {{3, 4, 5}}, [axis](In x) { return B::sum(x[0], axis); }});
    r.push_back(
        {"max axis " + std::to_string(axis), {{3, 4, 5}}, [axis](In x) { return B::max(x[0], axis); }, Domain::apart});
  }
  for (const Shape s : {Shape{19, 150}, Shape{3, 1, 7}, Shape{1, 130}})
    r.push_back({"sum of rows " + to_string(s), {s}, [last = s.rank() - 1](In x) { return B::sum(x[0], last); }});
  for (int t = 0; t < 4; ++t) {
    const bool ta = (t & 1) != 0, tb = (t & 2) != 0;
    const std::vector<std::array<Index, 4>> sizes{{1, 1, 1, 1},     {1, 7, 5, 9},     {2, 3, 4, 5}, {1, 33, 40, 35},
                                                  {1, 5, 1025, 35}, {1, 3, 2048, 35}, {1, 4, 1, 6}, {1, 460, 41, 35}};
    for (auto [n, i, k, j] : sizes) {
      const Shape a = ta ? Shape{n, k, i} : Shape{n, i, k}, b = tb ? Shape{n, j, k} : Shape{n, k, j};
      r.push_back({"matmul" + std::string(ta ? " aT " : " ") + to_string(a) + (tb ? " bT " : " ") + to_string(b),
                   {a, b},
                   [ta, tb](In x) { return B::matmul(x[0], x[1], ta, tb); }});
    }
  }
  r.push_back({"reshape", {{3, 4}}, [](In x) { return B::reshape(x[0], Shape{2, 6}); }, Domain::real, /*grows=*/false});
  r.push_back({"permute", {{2, 3, 4}}, [](In x) {
                 const std::vector<int> axes{2, 0, 1};
                 return B::permute(x[0], std::span<const int>(axes));
               }});
  r.push_back({"broadcast",
               {{3, 1}},
               [](In x) {
                 return B::broadcast(x[0], Shape{2, 3, 4});
               },
               Domain::real,
               /*grows=*/false});
  for (int axis = 0; axis < 2; ++axis) {
    r.push_back({"slice axis " + std::to_string(axis), {{5, 6}}, [axis](In x) { return B::slice(x[0], axis, 1, 4); }});
    r.push_back({"concat axis " + std::to_string(axis),
                 {{3, 3}, axis == 0 ? Shape{2, 3} : Shape{3, 2}, {3, 3}},
                 [axis](In x) { return B::concat(std::span<const T>(x), axis); }});
  }
  r.push_back({"gather", {{4, 3}}, [](In x) {
                 const std::vector<Index> rows{3, 0, 3, 1, 1};
                 return B::gather(x[0], rows);
               }});
  r.push_back({"scatter_add",
               {{4, 3}},
               [](In x) {
                 const std::vector<Index> rows{2, 0, 2, 4};
                 return B::scatter_add(x[0], rows, 6);
               },
               Domain::real,
               /*grows=*/false});

  // Fused operations: where a backend has no kernel, its row tests the definition in primitives.
  using ml::Activation;
  for (auto [act, name] : {std::pair{Activation::relu, "relu"},
                           {Activation::gelu, "gelu"},
                           {Activation::silu, "silu"},
                           {Activation::tanh, "tanh"},
                           {Activation::quick_gelu, "quick_gelu"},
                           {Activation::gelu_new, "gelu_new"},
                           {Activation::sigmoid, "sigmoid"}}) {
    r.push_back(
        {name, {{3, 37}}, [act = act](In x) { return ml::activate(as<B, 2>(x[0]), act).data(); }, Domain::apart});
    r.push_back({std::string("linear ") + name,
                 {{7, 12}, {37, 12}, {37}},
                 [act = act](In x) {
                   const auto bias = as<B, 1>(x[2]);
                   return ml::linear(as<B, 2>(x[0]), as<B, 2>(x[1]), &bias, act).data();
                 },
                 Domain::apart});
  }
  for (auto [m, k, n] : {std::array<Index, 3>{1, 1, 1}, {29, 520, 33}, {113, 20, 64}, {9, 40, 70}}) {
    r.push_back({"linear residual " + std::to_string(m) + "x" + std::to_string(k) + "x" + std::to_string(n),
                 {{m, k}, {n, k}, {n}, {m, n}},
                 [](In x) {
                   const auto bias = as<B, 1>(x[2]);
                   const auto residual = as<B, 2>(x[3]);
                   return ml::linear(as<B, 2>(x[0]), as<B, 2>(x[1]), &bias, Activation::none, &residual).data();
                 }});
  }
  r.push_back({"linear gelu residual, no bias", {{4, 6}, {5, 6}, {4, 5}}, [](In x) {
                 const auto residual = as<B, 2>(x[2]);
                 return ml::linear<B>(as<B, 2>(x[0]), as<B, 2>(x[1]), nullptr, Activation::gelu, &residual).data();
               }});
  for (auto [act, rows, width] : {std::tuple{Activation::none, Index{29}, Index{33}}, {Activation::gelu, 150, 70}}) {
    const ml::Dropout drop{.p = 0.3, .key = 0x123456789ABCDEFu};
    r.push_back({std::string("linear dropout") + (act == Activation::gelu ? " gelu" : ""),
                 {{rows, 20}, {width, 20}, {width}, {rows, width}},
                 [=, act = act](In x) {
                   const auto bias = as<B, 1>(x[2]);
                   const auto residual = as<B, 2>(x[3]);
                   return ml::linear(as<B, 2>(x[0]), as<B, 2>(x[1]), &bias, act, &residual, drop).data();
                 }});
  }
  for (const ml::Conv1dOptions o : {ml::Conv1dOptions{}, ml::Conv1dOptions{.padding = 1},
                                    ml::Conv1dOptions{.stride = 2, .padding = 1}, ml::Conv1dOptions{.stride = 3},
                                    ml::Conv1dOptions{.padding = 4}, ml::Conv1dOptions{.padding = 2, .dilation = 2}}) {
    for (Index taps : {1, 3, 4}) {
      r.push_back({"conv1d " + std::to_string(taps) + " taps, stride " + std::to_string(o.stride) + ", padding " +
                       std::to_string(o.padding) + ", dilation " + std::to_string(o.dilation),
                   {{25, 6}, {7, 6, taps}, {7}},
                   [=](In x) {
                     const auto bias = as<B, 1>(x[2]);
                     const ml::Sequences<B> motion(as<B, 2>(x[0]), ml::Offsets{7, 12, 6});
                     return ml::conv1d(motion, as<B, 3>(x[1]), &bias, o, Activation::silu).rows.data();
                   },
                   Domain::real,
                   /*grows=*/false});
    }
  }
  for (Index width : {1, 16, 45}) {
    if (width > 1) {
      r.push_back({"layer_norm " + std::to_string(width), {{5, width}, {width}, {width}}, [](In x) {
                     return ml::layer_norm(as<B, 2>(x[0]), as<B, 1>(x[1]), as<B, 1>(x[2])).data();
                   }});
      r.push_back({"add_layer_norm " + std::to_string(width), {{5, width}, {5, width}, {width}, {width}}, [](In x) {
                     return ml::add_layer_norm(as<B, 2>(x[0]), as<B, 2>(x[1]), as<B, 1>(x[2]), as<B, 1>(x[3])).data();
                   }});
    }
    r.push_back(
        {"softmax " + std::to_string(width), {{4, width}}, [](In x) { return ml::softmax(as<B, 2>(x[0])).data(); }});
  }
  r.push_back({"dropout", {{9, 41}}, [](In x) {
                 return ml::dropout(as<B, 2>(x[0]), {.p = 0.3, .key = 0x123456789ABCDEFu}).data();
               }});
  for (bool causal : {false, true}) {
    for (double p : {0.0, 0.4}) {
      const std::string suffix = std::string(causal ? " causal" : "") + (p > 0 ? " dropout" : "");
      const ml::AttentionOptions options{.heads = 3, .causal = causal, .dropout = {.p = p, .key = 77}};
      const ml::Offsets offsets{1, 19, 5};
      r.push_back({"self_attention" + suffix,
                   {{25, 36}},
                   [=](In x) { return ml::self_attention(as<B, 2>(x[0]), offsets, options).data(); },
                   Domain::real,
                   /*grows=*/false});
      if (causal) continue;
      const ml::Offsets keys{4, 1, 33};
      r.push_back(
          {"attention" + suffix,
           {{25, 12}, {38, 12}, {38, 12}},
           [=](In x) {
             return ml::attention(as<B, 2>(x[0]), as<B, 2>(x[1]), as<B, 2>(x[2]), offsets, keys, options).data();
           },
           Domain::real,
           /*grows=*/false});
    }
  }
  const ml::Offsets offsets{1, 19, 5};
  r.push_back({"attention relative scores",
               {{25, 12}, {25, 12}, {25, 12}, {3, 41}},
               [=](In x) {
                 const auto scores = as<B, 2>(x[3]);
                 return ml::attention(as<B, 2>(x[0]), as<B, 2>(x[1]), as<B, 2>(x[2]), offsets, offsets, {.heads = 3},
                                      &scores)
                     .data();
               },
               Domain::real,
               /*grows=*/false});
  return r;
}

/// The inputs of a row: the same numbers for every backend, rounded to float so that all scalars see the same ones.
inline std::vector<std::vector<double>> draw(const std::vector<Shape>& shapes, Domain domain, std::uint64_t seed) {
  std::vector<std::vector<double>> out;
  ml::Philox rng{.seed = seed};
  for (const Shape& s : shapes) {
    std::vector<double> v(static_cast<std::size_t>(s.count()));
    rng.normal(std::span<double>(v));
    for (double& x : v) {
      if (domain == Domain::positive) x = std::abs(x) + 0.3;
      x = static_cast<double>(static_cast<float>(x));
    }
    out.push_back(std::move(v));
  }
  if (domain == Domain::apart) {  // multiples of 0.013 plus an offset, shuffled: no two equal, none at 0
    std::vector<double*> all;
    for (auto& v : out) {
      for (double& x : v) all.push_back(&x);
    }
    std::vector<std::size_t> rank(all.size());
    for (std::size_t i = 0; i < rank.size(); ++i) rank[i] = i;
    for (std::size_t i = rank.size(); i > 1; --i)
      std::swap(rank[i - 1], rank[rng.below(static_cast<std::uint32_t>(i))]);
    for (std::size_t i = 0; i < all.size(); ++i) {
      *all[i] = static_cast<double>(
          static_cast<float>(0.013 * (static_cast<double>(rank[i]) - 0.5 * static_cast<double>(all.size())) + 0.0041));
    }
  }
  return out;
}

template <ml::Backend B>
std::vector<typename B::tensor> tensors(const std::vector<std::vector<double>>& values,
                                        const std::vector<Shape>& shapes) {
  std::vector<typename B::tensor> out;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::vector<typename B::scalar> v(values[i].begin(), values[i].end());
    out.push_back(B::from_span(std::span<const typename B::scalar>(v), shapes[i]));
  }
  return out;
}

}  // namespace table
