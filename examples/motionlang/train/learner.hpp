// A module under training: its weights, the moments of AdamW, a running average, and how all of that lies in a
// checkpoint.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/optim/ema.hpp>
#include <motionlang/weights/module_file.hpp>

namespace program {

namespace ml = motionlang;

/// What training computes on.
using TrainingBackend = ml::EigenBackend<float>;
using TrainingTape = ml::Autodiff<TrainingBackend>;

/// The moments of an optimiser in a checkpoint, behind `prefix`.
template <class A>
void add_moments(ml::TensorStore& store, const std::string& prefix, const ml::AdamW<A>& adam) {
  using B = typename A::inner;
  for (const auto& [path, s] : adam.state()) {
    store.add(prefix + "m." + path, B::shape(s.m), B::to_span(s.m), ml::DType::F32);
    store.add(prefix + "v." + path, B::shape(s.v), B::to_span(s.v), ml::DType::F32);
  }
}
/// Throws io_error 407 for moments of another shape than their parameter.
template <class A, ml::Module M>
void restore_moments(ml::AdamW<A>& adam, const M& model, const ml::TensorSet& file, const std::string& prefix,
                     ml::Index steps) {
  using B = typename A::inner;
  std::map<std::string, typename ml::AdamW<A>::Moments> moments;
  for (const auto& t : ml::tensors_of(model)) {
    const auto *m = file.find(prefix + "m." + t.path), *v = file.find(prefix + "v." + t.path);
    if (m == nullptr || v == nullptr) continue;
    auto load = [&](const ml::TensorView& view) {
      if (view.shape != t.shape())
        ml::raise<ml::io_error>(407, file.name(), ": ", view.name, " is ", view.shape, ", not ", t.shape());
      const auto numbers = ml::values_of<float>(view);
      return B::from_span(std::span<const float>(numbers), view.shape);
    };
    moments.emplace(t.path, typename ml::AdamW<A>::Moments{load(*m), load(*v)});
  }
  adam.restore(steps, std::move(moments));
}

/// `M` lies on the tape, `Average` is the same without it: the model that is validated, sampled from and exported. It
/// follows M at the rate `ema`; with ema = 0 it is M itself, brought up to date by `follow`.
template <ml::Module M, ml::Module Average>
struct Learner {
  M model;
  Average average;
  ml::AdamW<TrainingTape> adam{};
  double ema = 0;
  double clip_norm = 0;           // longest gradient; 0: any
  std::optional<Average> best{};  // the average of the best validation, where it is wanted

  /// `step` counts from 0.
  void update(const ml::Gradients<TrainingTape>& gradients, double lr, ml::Index step) {
    adam.config.lr = lr;
    const double scale =
        clip_norm > 0 ? ml::clip_scale(ml::gradient_norm<TrainingTape>(model, gradients), clip_norm) : 1.0;
    adam.step(model, gradients, scale);
    if (ema > 0) ml::update_ema(average, model, ema, step);
  }
  void follow() {
    if (ema == 0) ml::update_ema(average, model, 0, 0);
  }

  void add_to(ml::TensorStore& store) const {
    store.add_module(model, "model.");
    if (ema > 0) store.add_module(average, "average.");
    if (best) store.add_module(*best, "best.");
    add_moments(store, "adam.", adam);
  }
  /// Throws io_error 406, 407.
  void load(const ml::TensorSet& file, ml::Index steps) {
    ml::load_module(model, file, "model.");
    if (ema > 0) ml::load_module(average, file, "average.");
    follow();
    const auto is_best = [](const ml::TensorView& t) { return t.name.starts_with("best."); };
    if (std::any_of(file.tensors().begin(), file.tensors().end(), is_best)) {
      best = average;
      ml::load_module(*best, file, "best.");
    }
    restore_moments(adam, model, file, "adam.", steps);
  }
};

}  // namespace program
