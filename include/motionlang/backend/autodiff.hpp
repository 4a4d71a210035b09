// SPDX-License-Identifier: MIT
/// Autodiff<B>: a backend that computes with B and remembers how, so that `backward` gives gradients (reverse mode).
///
/// Each operation below stands next to its derivative (vjp: vector-Jacobian product). g is the gradient of the result,
/// and the vjp returns the gradient of each operand. The tensors own the graph; there is no global tape. A closure
/// keeps only the tensors that its derivative needs, and `backward` frees them as it goes, so a graph can be walked
/// once. The results of layer norms and of self-attention are cheap, so they are not kept: a product that needs one
/// computes it again. `checkpoint` does the same with any function (Chen, Xu, Zhang, Guestrin: "Training deep nets with
/// sublinear memory cost", 2016). Gradients are returned as a value and live on the inner backend.
///
/// Threads may differentiate losses over the same variables at once: a walk writes only to the operations behind its
/// own loss. Losses that share operations belong to one thread.
#pragma once

#include <algorithm>      // sort
#include <array>          // operands that are kept
#include <atomic>         // numbers of nodes
#include <memory>         // nodes
#include <optional>       // what a node has forgotten
#include <tuple>          // apply
#include <unordered_map>  // gradients by variable
#include <utility>        // move
#include <vector>         // operands

#include <motionlang/core/fields.hpp>
#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/sum_over_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Autodiff {
  using inner = B;
  using scalar = typename B::scalar;
  using Value = typename B::tensor;

  class Node;
  struct tensor {
    Value value{};
    std::shared_ptr<Node> node{};  // none for constants

    bool defined() const requires requires(const Value& v) { v.defined(); }
    { return value.defined(); }
  };

  using GradientMap = std::unordered_map<const Node*, Value>;

  /// Collects the gradients of a node's operands.
  class Sink {
   public:
    /// Operands that are constants need no gradient: skip the work.
    bool needs(std::size_t i) const { return node_->inputs[i] != nullptr; }
    void add(std::size_t i, Value g) const {
      if (!needs(i)) return;
      const Node* input = node_->inputs[i].get();
      if (input->variable) return add_variable(input, std::move(g));
      auto& slot = (*gradients_)[static_cast<std::size_t>(input->order)];
      slot.second = slot.first ? B::add(std::move(slot.second), std::move(g)) : std::move(g);
      slot.first = true;
    }

   private:
    friend struct Autodiff;
    void add_variable(const Node* variable, Value g) const {
      if (outer_ != nullptr) {  // in a checkpoint, whose inputs are leaves
        const auto leaf =
            std::find_if(leaves_.begin(), leaves_.end(), [&](auto& t) { return t.node.get() == variable; });
        if (leaf != leaves_.end()) return outer_->add(static_cast<std::size_t>(leaf - leaves_.begin()), std::move(g));
        return outer_->add_variable(variable, std::move(g));
      }
      const auto [slot, first] = variables_->try_emplace(variable);
      slot->second = first ? std::move(g) : B::add(std::move(slot->second), std::move(g));
    }
    const Node* node_ = nullptr;
    std::vector<std::pair<bool, Value>>* gradients_ = nullptr;  // of operations, by their order
    GradientMap* variables_ = nullptr;
    const Sink* outer_ = nullptr;
    std::span<const tensor> leaves_;
  };

  /// One operation of the graph, or a variable (no inputs, no vjp).
  class Node {
   public:
    std::vector<std::shared_ptr<Node>> inputs;
    Index order = -1;                      // of an operation: its place in the current walk
    const std::uint64_t number = ++made_;  // operands have smaller numbers than their results
    bool variable = true;

    Node() = default;
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;
    virtual ~Node() { release_inputs(); }
    virtual void vjp(const Value&, const Sink&) const {}
    virtual void forget() {}  // drops what the vjp keeps
    virtual bool forgotten() const { return false; }
    virtual bool cheap() const { return false; }  // to compute again
    virtual Value again() const { return {}; }    // the result, of a cheap operation that has forgotten nothing

    /// Not recursive: a chain of two million operations must not overflow the stack.
    void release_inputs() {
      std::vector<std::shared_ptr<Node>> waiting = std::move(inputs);
      while (!waiting.empty()) {
        std::shared_ptr<Node> last = std::move(waiting.back());
        waiting.pop_back();
        if (last != nullptr && last.use_count() == 1) {
          for (auto& i : last->inputs) waiting.push_back(std::move(i));
          last->inputs.clear();
        }
      }
    }

   private:
    inline static std::atomic<std::uint64_t> made_{0};
  };

  static tensor variable(Value value) { return {std::move(value), std::make_shared<Node>()}; }
  static const Value& value(const tensor& a) { return a.value; }
  static Value& mutable_value(tensor& a) { return a.value; }  // for optimisers: the variable stays the same leaf

  // Data.

  static tensor full(const Shape& s, scalar v) { return {B::full(s, v), nullptr}; }
  static tensor from_span(std::span<const scalar> values, const Shape& s) { return {B::from_span(values, s), nullptr}; }
  static auto to_span(const tensor& a MOTIONLANG_LIFETIMEBOUND) { return B::to_span(a.value); }
  static Shape shape(const tensor& a) { return B::shape(a.value); }

  // Elementwise, broadcasting.

  static tensor add(const tensor& a, const tensor& b) {
    return record(
        B::add(a.value, b.value),
        [sa = shape(a), sb = shape(b)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(g, sa));
          if (s.needs(1)) s.add(1, unbroadcast(g, sb));
        },
        a, b);
  }
  static tensor sub(const tensor& a, const tensor& b) {
    return record(
        B::sub(a.value, b.value),
        [sa = shape(a), sb = shape(b)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(g, sa));
          if (s.needs(1)) s.add(1, unbroadcast(times(g, -1), sb));
        },
        a, b);
  }
  static tensor mul(const tensor& a, const tensor& b) {
    return record(
        B::mul(a.value, b.value),
        [x = value_for(b, a), y = value_for(a, b), sa = shape(a), sb = shape(b)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(B::mul(g, y), sa));
          if (s.needs(1)) s.add(1, unbroadcast(B::mul(g, x), sb));
        },
        a, b);
  }
  static tensor div(const tensor& a, const tensor& b) {
    Value q = B::div(a.value, b.value);
    return record(
        q,
        [q = b.node == nullptr ? Value{} : q, y = b.value, sa = shape(a)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(B::div(g, y), sa));
          if (s.needs(1)) s.add(1, unbroadcast(times(B::div(B::mul(g, q), y), -1), B::shape(y)));
        },
        a, b);
  }
  static tensor maximum(const tensor& a, const tensor& b) {  // at equal values the first takes the gradient
    return record(
        B::maximum(a.value, b.value),
        [x = a.value, y = b.value](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(B::where_less(x, y, zero_like(g), g), B::shape(x)));
          if (s.needs(1)) s.add(1, unbroadcast(B::where_less(x, y, g, zero_like(g)), B::shape(y)));
        },
        a, b);
  }
  static tensor atan2(const tensor& a, const tensor& b) {  // d atan2(y, x) = (x dy - y dx) / (x^2 + y^2)
    return record(
        B::atan2(a.value, b.value),
        [y = a.value, x = b.value](const Value& g, const Sink& s) {
          const Value h = B::div(g, B::add(B::mul(x, x), B::mul(y, y)));
          if (s.needs(0)) s.add(0, unbroadcast(B::mul(h, x), B::shape(y)));
          if (s.needs(1)) s.add(1, unbroadcast(times(B::mul(h, y), -1), B::shape(x)));
        },
        a, b);
  }
  static tensor exp(const tensor& a) {
    Value y = B::exp(a.value);
    return record(
        y, [y](const Value& g, const Sink& s) { s.add(0, B::mul(g, y)); }, a);
  }
  static tensor log(const tensor& a) {
    return record(
        B::log(a.value), [x = a.value](const Value& g, const Sink& s) { s.add(0, B::div(g, x)); }, a);
  }
  static tensor sqrt(const tensor& a) {
    Value y = B::sqrt(a.value);
    return record(
        y, [y](const Value& g, const Sink& s) { s.add(0, times(B::div(g, y), 0.5)); }, a);
  }
  static tensor tanh(const tensor& a) {
    Value y = B::tanh(a.value);
    return record(
        y, [y](const Value& g, const Sink& s) { s.add(0, B::sub(g, B::mul(g, B::mul(y, y)))); }, a);
  }
  static tensor erf(const tensor& a) {  // 2 / sqrt(pi) exp(-x^2)
    return record(
        B::erf(a.value),
        [x = a.value](const Value& g, const Sink& s) {
          s.add(0, times(B::mul(g, B::exp(times(B::mul(x, x), -1))), 1.1283791670955126));
        },
        a);
  }
  static tensor sin(const tensor& a) {
    return record(
        B::sin(a.value), [x = a.value](const Value& g, const Sink& s) { s.add(0, B::mul(g, B::cos(x))); }, a);
  }
  static tensor cos(const tensor& a) {
    return record(
        B::cos(a.value), [x = a.value](const Value& g, const Sink& s) { s.add(0, times(B::mul(g, B::sin(x)), -1)); },
        a);
  }
  static tensor where_less(const tensor& a, const tensor& b, const tensor& x,
                           const tensor& y) {  // a and b get no gradient
    return record(
        B::where_less(a.value, b.value, x.value, y.value),
        [a = a.value, b = b.value, sx = shape(x), sy = shape(y)](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, unbroadcast(B::where_less(a, b, g, zero_like(g)), sx));
          if (s.needs(1)) s.add(1, unbroadcast(B::where_less(a, b, zero_like(g), g), sy));
        },
        x, y);
  }

  // Reductions.

  static tensor sum(const tensor& a, int axis) {
    return record(
        B::sum(a.value, axis), [sa = shape(a), axis](const Value& g, const Sink& s) { s.add(0, along(g, sa, axis)); },
        a);
  }
  static tensor max(const tensor& a, int axis) {  // every element that equals the maximum takes the whole gradient
    Value y = B::max(a.value, axis);
    return record(
        y,
        [x = a.value, y, axis](const Value& g, const Sink& s) {
          s.add(0, B::where_less(x, along(y, B::shape(x), axis), zero_like(x), along(g, B::shape(x), axis)));
        },
        a);
  }

  static tensor sum_over_parts(const tensor& a, const BatchSums& sums, double* count = nullptr) {
    return record(
        detail::sum_over_parts<B>(a.value, sums, count),
        [&sums](const Value& g, const Sink& s) { s.add(0, detail::sum_over_parts<B>(g, sums)); }, a);
  }

  // Product.

  static tensor matmul(const tensor& a, const tensor& b, bool ta, bool tb) {
    return record(
        B::matmul(a.value, b.value, ta, tb),
        [x = value_for(b, a), y = value_for(a, b), ta, tb](const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, ta ? B::matmul(y, g, tb, true) : B::matmul(g, y, false, !tb));
          if (s.needs(1)) s.add(1, tb ? B::matmul(g, x, true, ta) : B::matmul(x, g, !ta, false));
        },
        a, b);
  }

  // Movement.

  static tensor reshape(const tensor& a, const Shape& to) {
    return record(
        B::reshape(a.value, to), [sa = shape(a)](const Value& g, const Sink& s) { s.add(0, B::reshape(g, sa)); }, a);
  }
  static tensor permute(const tensor& a, std::span<const int> axes) {
    std::vector<int> back(axes.size());
    for (std::size_t i = 0; i < axes.size(); ++i) back[static_cast<std::size_t>(axes[i])] = static_cast<int>(i);
    return record(
        B::permute(a.value, axes),
        [back](const Value& g, const Sink& s) { s.add(0, B::permute(g, std::span<const int>(back))); }, a);
  }
  static tensor broadcast(const tensor& a, const Shape& to) {
    return record(
        B::broadcast(a.value, to), [sa = shape(a)](const Value& g, const Sink& s) { s.add(0, unbroadcast(g, sa)); }, a);
  }
  static tensor slice(const tensor& a, int axis, Index first, Index last) {
    return record(
        B::slice(a.value, axis, first, last),
        [sa = shape(a), axis, first, last](const Value& g, const Sink& s) {
          auto zeros = [&](Index n) {
            Shape z = sa;
            z[axis] = n;
            return B::full(z, scalar(0));
          };
          const std::vector<Value> parts{zeros(first), g, zeros(sa[axis] - last)};
          s.add(0, B::concat(std::span<const Value>(parts), axis));
        },
        a);
  }
  static tensor concat(std::span<const tensor> list, int axis) {
    std::vector<Value> values;
    std::vector<Index> ends{0};
    for (const tensor& t : list) {
      values.push_back(t.value);
      ends.push_back(ends.back() + shape(t)[axis]);
    }
    return record_list(
        B::concat(std::span<const Value>(values), axis),
        [ends, axis](const Value& g, const Sink& s) {
          for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
            if (s.needs(i)) s.add(i, B::slice(g, axis, ends[i], ends[i + 1]));
          }
        },
        list);
  }
  static tensor gather(const tensor& a, std::span<const Index> rows) {
    return record(
        B::gather(a.value, rows),
        [rows = std::vector<Index>(rows.begin(), rows.end()), n = shape(a)[0]](const Value& g, const Sink& s) {
          s.add(0, B::scatter_add(g, rows, n));
        },
        a);
  }
  static tensor scatter_add(const tensor& a, std::span<const Index> rows, Index n) {
    return record(
        B::scatter_add(a.value, rows, n),
        [rows = std::vector<Index>(rows.begin(), rows.end())](const Value& g, const Sink& s) {
          s.add(0, B::gather(g, rows));
        },
        a);
  }

  // Fused operations, where the inner backend has their kernels.

  static tensor activate(const tensor& a, Activation act, const Dropout& drop = {}) requires requires(const Value& v) {
    B::activate_vjp(v, v, act, drop);
  }
  {
    return record(
        B::activate(a.value, act, drop),
        [x = a.value, act, drop](const Value& g, const Sink& s) { s.add(0, B::activate_vjp(x, g, act, drop)); }, a);
  }
  static tensor linear(const tensor& x, const tensor& weight, const tensor* bias, Activation act,
                       const tensor* residual, const Dropout& drop = {}) requires requires(const Value& v) {
    B::linear(v, v, &v, act, &v, drop);
  }
  {
    if (act != Activation::none) {  // the nonlinearity needs its own input for the derivative
      const tensor y = activate(linear(x, weight, bias, Activation::none, nullptr), act, drop);
      return residual == nullptr ? y : add(y, *residual);
    }
    const tensor none{};
    return record(
        B::linear(x.value, weight.value, bias == nullptr ? nullptr : &bias->value, act,
                  residual == nullptr ? nullptr : &residual->value, drop),
        [x = Operand(weight, x), w = value_for(x, weight), drop](const Value& g, const Sink& s) {
          if (s.needs(3)) s.add(3, g);
          const Value inner = drop.p > 0 ? B::dropout(g, drop) : g;
          if (s.needs(0)) s.add(0, B::matmul(inner, w, false, false));
          if (s.needs(1)) s.add(1, B::matmul(inner, x.value(), true, false));
          if (s.needs(2)) s.add(2, B::sum(inner, 0));
        },
        x, weight, bias == nullptr ? none : *bias, residual == nullptr ? none : *residual);
  }
  static tensor conv1d(const tensor& x, const Offsets& before, const Offsets& after, const tensor& weight,
                       const tensor* bias, Index stride, Index padding, Activation act) requires
      requires(const Value& v) {
    B::conv1d_weight_vjp(v, before, after, stride, stride, padding, v);
    B::conv1d_input_vjp(v, before, after, stride, padding, v);
  }
  {
    if (act != Activation::none)
      return activate(conv1d(x, before, after, weight, bias, stride, padding, Activation::none), act);
    return record(
        B::conv1d(x.value, before, after, weight.value, bias == nullptr ? nullptr : &bias->value, stride, padding, act),
        [x = Operand(weight, x), w = value_for(x, weight), taps = shape(weight)[2], before, after, stride, padding](
            const Value& g, const Sink& s) {
          if (s.needs(0)) s.add(0, B::conv1d_input_vjp(w, before, after, stride, padding, g));
          if (s.needs(1)) s.add(1, B::conv1d_weight_vjp(x.value(), before, after, taps, stride, padding, g));
          if (s.needs(2)) s.add(2, B::sum(g, 0));
        },
        x, weight, bias == nullptr ? tensor{} : *bias);
  }
  static tensor layer_norm(const tensor& x, const tensor& weight, const tensor& bias, double eps) requires
      requires(const Value& v) {
    B::layer_norm_vjp(v, v, eps, v);
  }
  {
    auto forward = [x = x.value, w = weight.value, b = bias.value, eps] { return B::layer_norm(x, w, b, eps); };
    Value y = forward();
    return record_cheap(
        std::move(y), std::move(forward),
        [x = x.value, w = weight.value, eps](const Value& g, const Sink& s) {
          auto [dx, dweight, dbias] = B::layer_norm_vjp(x, w, eps, g);
          s.add(0, std::move(dx));
          s.add(1, std::move(dweight));
          s.add(2, std::move(dbias));
        },
        x, weight, bias);
  }
  static tensor softmax(const tensor& x)  // dx = y (g - sum(g y))
      requires requires(const Value& v) {
    B::softmax(v);
  }
  {
    Value y = B::softmax(x.value);
    return record(
        y,
        [y](const Value& g, const Sink& s) {
          const Value gy = B::mul(g, y);
          s.add(0, B::sub(gy, B::mul(y, along(B::sum(gy, 1), B::shape(y), 1))));
        },
        x);
  }
  static tensor dropout(const tensor& x, const Dropout& d) requires requires(const Value& v) { B::dropout(v, d); }
  {
    return record(
        B::dropout(x.value, d), [d](const Value& g, const Sink& s) { s.add(0, B::dropout(g, d)); }, x);
  }
  static tensor self_attention(const tensor& qkv, const Offsets& offsets, const AttentionOptions& options) requires
      requires(const Value& v) {
    B::self_attention_vjp(v, offsets, options, v);
  }
  {
    auto forward = [x = qkv.value, offsets, options] { return B::self_attention(x, offsets, options); };
    Value y = forward();
    return record_cheap(
        std::move(y), std::move(forward),
        [x = qkv.value, offsets, options](const Value& g, const Sink& s) {
          s.add(0, B::self_attention_vjp(x, offsets, options, g));
        },
        qkv);
  }
  static tensor attention(const tensor& q, const tensor& k, const tensor& v, const Offsets& q_offsets,
                          const Offsets& k_offsets, const AttentionOptions& options) requires requires(const Value& x) {
    B::attention_vjp(x, x, x, q_offsets, k_offsets, options, x);
  }
  {
    return record(
        B::attention(q.value, k.value, v.value, q_offsets, k_offsets, options),
        [q = q.value, k = k.value, v = v.value, q_offsets, k_offsets, options](const Value& g, const Sink& s) {
          auto [dq, dk, dv] = B::attention_vjp(q, k, v, q_offsets, k_offsets, options, g);
          s.add(0, std::move(dq));
          s.add(1, std::move(dk));
          s.add(2, std::move(dv));
        },
        q, k, v);
  }

  // Recomputation.

  /// Makes y one operation that keeps only its inputs. again(inputs...) computes y again during the backward pass, and
  /// makes its graph then. Everything else that `again` uses must be a constant or a variable.
  template <class F, class... T>
  static tensor checkpoint(const tensor& y, F again, const T&... inputs) {
    if (y.node == nullptr || y.node->variable) return y;
    return operation(
        y.value,
        [again = std::move(again), values = std::array{inputs.value...}](const Value& g, const Sink& s) {
          std::array<tensor, sizeof...(T)> leaves;
          for (std::size_t i = 0; i < leaves.size(); ++i)
            leaves[i] = s.needs(i) ? variable(values[i]) : tensor{values[i], nullptr};
          Sink inside;
          inside.outer_ = &s;
          inside.leaves_ = leaves;
          walk(std::apply(again, leaves), g, inside);
        },
        inputs...);
  }

  // The walk.

  /// Gradients of a number with respect to all variables that it depends on. Frees the graph behind it. Throws
  /// config_error 102 if the graph has been walked before, or if a checkpoint uses a variable that is not one of its
  /// inputs.
  static GradientMap gradients(const tensor& loss) {
    GradientMap result;
    Sink sink;
    sink.variables_ = &result;
    walk(loss, B::full(B::shape(loss.value), scalar(1)), sink);
    return result;
  }

 private:
  /// Sends the gradients of all variables behind `last` to the sink; g is the gradient of `last` itself. Walks
  /// operations from the last made to the first. So the memory of a layer is free before the layer below begins. Sums
  /// of gradients have the same order with checkpoints and without.
  static void walk(const tensor& last, Value g_last, Sink& sink) {
    if (last.node == nullptr) return;
    if (last.node->variable) return sink.add_variable(last.node.get(), std::move(g_last));
    std::vector<Node*> found{last.node.get()};
    auto let_go = [&] {
      for (Node* node : found) node->order = -1;
    };
    last.node->order = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (found[i]->forgotten()) {
        let_go();
        raise<config_error>(102, "backward: this graph has been walked already; compute the loss again");
      }
      for (const auto& input : found[i]->inputs) {
        if (input == nullptr || input->variable) continue;
        if (input->order == -1) {
          input->order = std::ssize(found);
          found.push_back(input.get());
        } else if (input->order >= std::ssize(found) || found[static_cast<std::size_t>(input->order)] != input.get()) {
          let_go();
          raise<config_error>(102, "backward: a checkpoint recomputes with a result that is not one of its inputs");
        }
      }
    }
    std::sort(found.begin(), found.end(), [](const Node* a, const Node* b) { return a->number < b->number; });
    for (std::size_t i = 0; i < found.size(); ++i) found[i]->order = static_cast<Index>(i);
    std::vector<std::pair<bool, Value>> gradient(found.size());
    gradient.back() = {true, std::move(g_last)};
    sink.gradients_ = &gradient;
    for (std::size_t i = found.size(); i-- > 0;) {
      auto [known, g] = std::move(gradient[i]);
      gradient[i] = {};
      sink.node_ = found[i];
      if (known) found[i]->vjp(g, sink);
      found[i]->forget();
    }
    let_go();
  }

  template <class F>
  class Operation final : public Node {
   public:
    explicit Operation(F f) : f_(std::move(f)) { this->variable = false; }
    void vjp(const Value& g, const Sink& s) const override { (*f_)(g, s); }
    void forget() override { f_.reset(); }
    bool forgotten() const override { return !f_.has_value(); }

   private:
    std::optional<F> f_;
  };

  /// An operation whose result `forward` computes again from the values that the vjp keeps anyway.
  template <class F, class G>
  class CheapOperation final : public Node {
   public:
    CheapOperation(F f, G forward) : parts_({std::move(f), std::move(forward)}) { this->variable = false; }
    void vjp(const Value& g, const Sink& s) const override { parts_->first(g, s); }
    void forget() override { parts_.reset(); }
    bool forgotten() const override { return !parts_.has_value(); }
    bool cheap() const override { return true; }
    Value again() const override { return parts_->second(); }

   private:
    std::optional<std::pair<F, G>> parts_;
  };

  /// An operand whose value the derivative for `other` needs; nothing if other is a constant. The result of a cheap
  /// operation is not kept. That operation is among the inputs of the node that needs it, and is walked after that
  /// node.
  class Operand {
   public:
    Operand(const tensor& other, const tensor& x)
        : node_(x.node != nullptr && x.node->cheap() ? x.node.get() : nullptr),
          value_(node_ == nullptr ? value_for(other, x) : Value{}) {}
    Value value() const { return node_ == nullptr ? value_ : node_->again(); }

   private:
    const Node* node_;
    Value value_;
  };
  static Value value_for(const tensor& other, const tensor& x) { return other.node == nullptr ? Value{} : x.value; }

  /// `value` as the result of the operation `node` on the operands.
  template <class... T>
  static tensor result(Value value, std::shared_ptr<Node> node, const T&... operands) {
    node->inputs = {operands.node...};
    return {std::move(value), std::move(node)};
  }
  template <class F, class... T>
  static tensor operation(Value value, F vjp, const T&... operands) {
    return result(std::move(value), std::make_shared<Operation<F>>(std::move(vjp)), operands...);
  }
  template <class... T>
  static bool constants(const T&... operands) {
    return ((operands.node == nullptr) && ...);
  }
  template <class F, class... T>
  static tensor record(Value value, F vjp, const T&... operands) {
    if (constants(operands...)) return {std::move(value), nullptr};
    return operation(std::move(value), std::move(vjp), operands...);
  }
  template <class G, class F, class... T>
  static tensor record_cheap(Value value, G forward, F vjp, const T&... operands) {
    if (constants(operands...)) return {std::move(value), nullptr};
    return result(std::move(value), std::make_shared<CheapOperation<F, G>>(std::move(vjp), std::move(forward)),
                  operands...);
  }
  template <class F>
  static tensor record_list(Value value, F vjp, std::span<const tensor> operands) {
    auto node = std::make_shared<Operation<F>>(std::move(vjp));
    bool any = false;
    for (const tensor& t : operands) {
      node->inputs.push_back(t.node);
      any = any || t.node != nullptr;
    }
    return any ? tensor{std::move(value), std::move(node)} : tensor{std::move(value), nullptr};
  }

  static Value times(const Value& a, double c) { return B::mul(a, B::full(Shape{}, static_cast<scalar>(c))); }
  static Value zero_like(const Value& a) { return B::full(B::shape(a), scalar(0)); }

  /// The adjoint of broadcasting: sums over the axes that were repeated.
  static Value unbroadcast(const Value& g, const Shape& to) {
    if (B::shape(g) == to) return g;
    Value sum = g;
    while (B::shape(sum).rank() > to.rank()) sum = B::sum(sum, 0);
    for (int axis = 0; axis < to.rank(); ++axis) {
      if (to[axis] == 1 && B::shape(sum)[axis] != 1) {
        Shape kept = B::shape(sum);
        kept[axis] = 1;
        sum = B::reshape(B::sum(sum, axis), kept);
      }
    }
    return sum;
  }
  /// The adjoint of a sum: repeats g along the axis that disappeared.
  static Value along(const Value& g, const Shape& to, int axis) {
    Shape kept = to;
    kept[axis] = 1;
    return B::broadcast(B::reshape(g, kept), to);
  }
};

MOTIONLANG_NAMESPACE_END
