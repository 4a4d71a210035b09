// SPDX-License-Identifier: MIT
/// A module in training: its weights, the moments of AdamW, a running average, and their form in a checkpoint.
#pragma once

#include <algorithm>  // any_of
#include <map>        // moments
#include <optional>   // the best weights
#include <string>     // names

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/optim/ema.hpp>
#include <motionlang/weights/module_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Adds the moments of an optimiser to a checkpoint, with `prefix` before their names.
template <AutodiffBackend A>
void add_moments(TensorStore& store, const std::string& prefix, const AdamW<A>& adam) {
  using B = typename A::inner;
  for (const auto& [path, s] : adam.state()) {
    store.add(prefix + "m." + path, B::shape(s.m), B::to_span(s.m), DType::F32);
    store.add(prefix + "v." + path, B::shape(s.v), B::to_span(s.v), DType::F32);
  }
}
/// Restores them. `steps`: the number of updates so far. Throws io_error 407 for moments whose shape differs from that
/// of their parameter.
template <AutodiffBackend A, Module M>
void restore_moments(AdamW<A>& adam, const M& model, const TensorSet& file, const std::string& prefix, Index steps) {
  using B = typename A::inner;
  using S = typename B::scalar;
  std::map<std::string, typename AdamW<A>::Moments> moments;
  for (const auto& t : tensors_of(model)) {
    const auto *m = file.find(prefix + "m." + t.path), *v = file.find(prefix + "v." + t.path);
    if (m == nullptr || v == nullptr) continue;
    auto load = [&](const TensorView& view) {
      if (view.shape != t.shape())
        raise<io_error>(407, file.name(), ": ", view.name, " is ", view.shape, ", not ", t.shape());
      const auto numbers = values_of<S>(view);
      return B::from_span(std::span<const S>(numbers), view.shape);
    };
    moments.emplace(t.path, typename AdamW<A>::Moments{load(*m), load(*v)});
  }
  adam.restore(steps, std::move(moments));
}

/// `M` is on the tape. `Average` is the same without it: the model that is validated, sampled from and exported. It
/// follows M at the rate `ema`. With ema = 0 it is M itself, updated by `follow`.
template <Module M, Module Average>
struct Learner {
  using A = module_backend<M>;

  M model;
  Average average;
  AdamW<A> adam{};
  double ema = 0;
  double clip_norm = 0;           // largest gradient norm; 0: any
  std::optional<Average> best{};  // the average of the best validation, if it is wanted

  /// One step of the optimiser. `step` counts from 0.
  void update(const Gradients<A>& gradients, double lr, Index step);
  void follow() {
    if (ema == 0) update_ema(average, model, 0, 0);
  }

  void add_to(TensorStore& store) const;
  /// Throws io_error 406, 407.
  void load(const TensorSet& file, Index steps);
};

template <Module M, Module Average>
void Learner<M, Average>::update(const Gradients<A>& gradients, double lr, Index step) {
  adam.config.lr = lr;
  const double scale = clip_norm > 0 ? clip_scale(gradient_norm<A>(model, gradients), clip_norm) : 1.0;
  adam.step(model, gradients, scale);
  if (ema > 0) update_ema(average, model, ema, step);
}

template <Module M, Module Average>
void Learner<M, Average>::add_to(TensorStore& store) const {
  store.add_module(model, "model.");
  if (ema > 0) store.add_module(average, "average.");
  if (best) store.add_module(*best, "best.");
  add_moments(store, "adam.", adam);
}

template <Module M, Module Average>
void Learner<M, Average>::load(const TensorSet& file, Index steps) {
  load_module(model, file, "model.");
  if (ema > 0) load_module(average, file, "average.");
  follow();
  const auto is_best = [](const TensorView& t) { return t.name.starts_with("best."); };
  if (std::any_of(file.tensors().begin(), file.tensors().end(), is_best)) {
    best = average;
    load_module(*best, file, "best.");
  }
  restore_moments(adam, model, file, "adam.", steps);
}

MOTIONLANG_NAMESPACE_END
