// A backend of your own: it counts operations, and another backend computes.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <motionlang/core/concepts.hpp>

/// `Inner` computes. Only the operations of the concept Backend are here. Softmax, attention, linear layers, ... are
/// computed from them by their definitions, so each of their parts is counted.
template <motionlang::Backend Inner>
struct CountingBackend {
  using Index = motionlang::Index;
  using Shape = motionlang::Shape;
  using scalar = typename Inner::scalar;
  using tensor = typename Inner::tensor;

  /// The number of calls of an operation, by all threads.
  struct Count {
    std::string_view operation;
    Index times;
  };
  /// The called operations, in the order of the concept.
  static std::vector<Count> counts() {
    std::vector<Count> out;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (times_[i] > 0) out.push_back({names[i], times_[i]});
    }
    return out;
  }
  static void reset() {
    for (auto& t : times_) t = 0;
  }

  // Data, which are not counted.
  static tensor full(const Shape& s, scalar value) { return Inner::full(s, value); }
  static tensor from_span(std::span<const scalar> values, const Shape& s) { return Inner::from_span(values, s); }
  static std::span<const scalar> to_span(const tensor& a) { return Inner::to_span(a); }
  static Shape shape(const tensor& a) { return Inner::shape(a); }

  // Operands come by value and are passed on: the inner backend may reuse their memory if nobody else holds it.
  static tensor add(tensor a, tensor b) { return count("add"), Inner::add(std::move(a), std::move(b)); }
  static tensor sub(tensor a, tensor b) { return count("sub"), Inner::sub(std::move(a), std::move(b)); }
  static tensor mul(tensor a, tensor b) { return count("mul"), Inner::mul(std::move(a), std::move(b)); }
  static tensor div(tensor a, tensor b) { return count("div"), Inner::div(std::move(a), std::move(b)); }
  static tensor maximum(tensor a, tensor b) { return count("maximum"), Inner::maximum(std::move(a), std::move(b)); }
  static tensor atan2(tensor a, tensor b) { return count("atan2"), Inner::atan2(std::move(a), std::move(b)); }
  static tensor exp(tensor a) { return count("exp"), Inner::exp(std::move(a)); }
  static tensor log(tensor a) { return count("log"), Inner::log(std::move(a)); }
  static tensor sqrt(tensor a) { return count("sqrt"), Inner::sqrt(std::move(a)); }
  static tensor tanh(tensor a) { return count("tanh"), Inner::tanh(std::move(a)); }
  static tensor erf(tensor a) { return count("erf"), Inner::erf(std::move(a)); }
  static tensor sin(tensor a) { return count("sin"), Inner::sin(std::move(a)); }
  static tensor cos(tensor a) { return count("cos"), Inner::cos(std::move(a)); }
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x, const tensor& y) {
    return count("where_less"), Inner::where_less(a, b, x, y);
  }
  static tensor sum(const tensor& a, int axis) { return count("sum"), Inner::sum(a, axis); }
  static tensor max(const tensor& a, int axis) { return count("max"), Inner::max(a, axis); }
  static tensor matmul(const tensor& a, const tensor& b, bool transpose_a, bool transpose_b) {
    return count("matmul"), Inner::matmul(a, b, transpose_a, transpose_b);
  }
  static tensor reshape(const tensor& a, const Shape& s) { return count("reshape"), Inner::reshape(a, s); }
  static tensor permute(const tensor& a, std::span<const int> axes) {
    return count("permute"), Inner::permute(a, axes);
  }
  static tensor broadcast(const tensor& a, const Shape& s) { return count("broadcast"), Inner::broadcast(a, s); }
  static tensor slice(const tensor& a, int axis, Index first, Index last) {
    return count("slice"), Inner::slice(a, axis, first, last);
  }
  static tensor concat(std::span<const tensor> list, int axis) { return count("concat"), Inner::concat(list, axis); }
  static tensor gather(const tensor& a, std::span<const Index> rows) { return count("gather"), Inner::gather(a, rows); }
  static tensor scatter_add(const tensor& a, std::span<const Index> rows, Index n) {
    return count("scatter_add"), Inner::scatter_add(a, rows, n);
  }

 private:
  static constexpr std::array<std::string_view, 24> names{
      "add",    "sub",     "mul",     "div",       "maximum", "atan2",      "exp",    "log",
      "sqrt",   "tanh",    "erf",     "sin",       "cos",     "where_less", "sum",    "max",
      "matmul", "reshape", "permute", "broadcast", "slice",   "concat",     "gather", "scatter_add"};
  static void count(std::string_view operation) {
    const auto place = std::find(names.begin(), names.end(), operation) - names.begin();
    times_[static_cast<std::size_t>(place)].fetch_add(1, std::memory_order_relaxed);
  }

  inline static std::array<std::atomic<Index>, names.size()> times_{};
};
