// Tensors of golden cases, and handlers over backends.
#pragma once

#include <motionlang/diffusion/sampler.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/sequences.hpp>
#include <motionlang/weights/module_file.hpp>

#include "golden.hpp"

namespace golden {

constexpr ml::Index position_rows = 5000;  // of tables of positions, as published

template <ml::Backend B, int R>
ml::Tensor<B, R> tensor(const Case& c, const std::string& name) {
  return ml::Tensor<B, R>::from(c.values<typename B::scalar>(name), c.shape(name));
}
/// A tensor whose leading axes are joined: (rows, last).
template <ml::Backend B>
ml::Tensor<B, 2> rows(const Case& c, const std::string& name) {
  const auto s = c.shape(name);
  return ml::Tensor<B, 2>::from(c.values<typename B::scalar>(name), {s.count(0, s.rank() - 1), s.back()});
}
template <ml::Backend B, int R>
void out(Case& c, const std::string& name, const ml::Tensor<B, R>& t) {
  c.out(name, t.shape(), t.span());
}
/// Only where the case holds it.
template <ml::Backend B, int R>
void out_if_wanted(Case& c, const std::string& name, const ml::Tensor<B, R>& t) {
  if (c.wants(name)) out(c, name, t);
}
/// grad/ of every parameter; tables and statistics have none. Returns the gradients.
template <ml::AutodiffBackend A, class M>
ml::Gradients<A> out_gradients(Case& c, const M& model, const ml::Tensor<A, 0>& loss, const std::string& prefix = "") {
  const auto gradients = ml::backward(loss);
  ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
    if (t.data().node == nullptr) return;
    const auto g = gradients[t];
    c.grad(ml::tensor_key<M>(prefix, path), g.shape(), g.span());
  });
  return gradients;
}
inline std::string noise_name(ml::Index k) { return "noise/" + three_digits(k); }

/// MDM's [batch, joints, features, frames] as packed rows (frames of all, J C), and back.
template <ml::Backend B>
ml::Tensor<B, 2> mdm_rows(const ml::Tensor<B, 4>& x) {
  return ml::reshape<2>(ml::permute(x, {0, 3, 1, 2}), {x.size(0) * x.size(3), x.size(1) * x.size(2)});
}
template <ml::Backend B>
ml::Tensor<B, 4> mdm_layout(const ml::Tensor<B, 2>& rows, const ml::Shape& like) {
  return ml::permute(ml::reshape<4>(rows, {like[0], like[3], like[1], like[2]}), {0, 2, 3, 1});
}

/// The schedule that a config names.
inline ml::GaussianDiffusion diffusion_of(const ml::JsonView& config) {
  const auto name = config["schedule"].as<std::string>();
  const auto T = config["T"].as<ml::Index>();
  if (name == "linear") return ml::GaussianDiffusion(ml::LinearSchedule{T, config.value_or("scale_betas", 1.0)});
  if (name == "cosine") return ml::GaussianDiffusion(ml::CosineSchedule{T, config.value_or("s", 0.008)});
  if (name == "scaled_linear") {
    return ml::GaussianDiffusion(
        ml::ScaledLinearSchedule{T, config.value_or("b0", 0.00085), config.value_or("b1", 0.012)});
  }
  if (name == "chen_cosine") {
    return ml::GaussianDiffusion(ml::ChenCosineSchedule{T, config.value_or("start", 0.0), config.value_or("end", 1.0),
                                                        config.value_or("tau", 1.0),
                                                        config.value_or("clip_min", 1e-9)});
  }
  ml::raise<ml::config_error>(103, "unknown schedule '", name, "'");
}
inline ml::Prediction prediction_of(const ml::JsonView& config) {
  const auto name = config.value_or("prediction", std::string("x0"));
  if (name == "x0") return ml::Prediction::x0;
  if (name == "eps") return ml::Prediction::eps;
  if (name == "score") return ml::Prediction::score;
  if (name == "x_prev") return ml::Prediction::x_prev;
  ml::raise<ml::config_error>(103, "unknown prediction '", name, "'");
}
inline ml::NoiseScale noise_scale_of(const ml::JsonView& config) {
  return config.value_or("noise_scale", std::string("posterior_std")) == "posterior_variance"
             ? ml::NoiseScale::posterior_variance
             : ml::NoiseScale::posterior_std;
}

}  // namespace golden
