// Golden functions: losses, gradients and optimiser steps of the denoisers, through Autodiff.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/optim/adamw.hpp>
#include <motionlang/train/diffusion_losses.hpp>

#include "models.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

ml::AdamWConfig optimiser(const ml::JsonView& config) {
  const auto betas = config["betas"];
  return {.lr = config["lr"].as<double>(),
          .beta1 = betas[0].as<double>(),
          .beta2 = betas[1].as<double>(),
          .eps = config["eps"].as<double>(),
          .weight_decay = config["weight_decay"].as<double>()};
}

/// Runs the optimiser: loss(model, k) is the loss of step k. Hands over losses, gradients of step 0, parameters at the
/// end.
template <ml::AutodiffBackend A, class M, class Loss>
void train(Case& c, M& model, const std::string& prefix, Loss loss) {
  const auto config = c.config();
  ml::AdamW<A> adam(optimiser(config));
  const auto steps = config["steps"].as<Index>();
  for (Index k = 0; k < steps; ++k) {
    const ml::Tensor<A, 0> value = loss(model, k);
    c.out_scalar(k == 0 ? "loss" : "loss_" + std::to_string(k), static_cast<double>(value.item()));
    const auto gradients = ml::backward(value);
    double scale = 1;
    if (config.contains("clip_norm")) {
      const double norm = ml::gradient_norm<A>(model, gradients);
      if (k == 0 && c.wants("grad_norm")) c.out_scalar("grad_norm", norm);
      scale = ml::clip_scale(norm, config["clip_norm"].as<double>());
    }
    if (k == 0) {
      ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
        const std::string key = ml::tensor_key<M>(prefix, path);
        if (c.has("grad/" + key)) {
          const auto g = gradients[t];
          c.grad(key, g.shape(), g.span());
        }
      });
    }
    adam.step(model, gradients, scale);
  }
  ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
    const std::string key = "after/" + ml::tensor_key<M>(prefix, path);
    if (c.wants(key)) golden::out(c, key, t);
  });
}

template <ml::Backend B>
void mdm_smpl_training(Case& c) {
  using A = ml::Autodiff<B>;
  const auto d = golden::diffusion_of(c.config());
  auto model = ml::convert<A>(golden::mdm_smpl_model<B>(c));
  const auto mask = c.values<unsigned char>("in/mask");
  const std::span<const unsigned char> valid(mask);
  const auto x0 = ml::from_padded(model.motion_normalizer.normalize(tensor<A, 3>(c, "in/x")), valid);
  auto text = golden::text_features<A>(c);
  text.tokens.rows = model.text_normalizer.normalize(text.tokens.rows);
  train<A>(c, model, "", [&](const auto& m, Index k) {
    const auto eps = ml::from_padded(tensor<A, 3>(c, golden::noise_name(k)), valid);
    return ml::mdm_smpl_loss<A>(d, m.denoiser, {x0, eps.rows, c.values<Index>("in/t_" + std::to_string(k))}, text, {},
                                golden::prediction_of(c.config()), c.shape("in/x")[1]);
  });
}

template <ml::Backend B>
void mdm_training(Case& c) {
  using A = ml::Autodiff<B>;
  const auto d = golden::diffusion_of(c.config());
  auto model = ml::convert<A>(golden::mdm_model<B>(c));
  const auto shape = c.shape("in/x");
  const Index frames = shape[3], width = shape[1] * shape[2];
  const auto mask = c.values<unsigned char>("in/mask");
  auto padded = [&](const ml::Tensor<A, 2>& rows) { return ml::reshape<3>(rows, {shape[0], frames, width}); };
  const auto x0 = ml::from_equal(padded(golden::mdm_rows(tensor<A, 4>(c, "in/x"))));
  std::vector<Index> lengths(static_cast<std::size_t>(shape[0]));
  for (std::size_t i = 0; i < mask.size(); ++i) lengths[i / static_cast<std::size_t>(frames)] += mask[i];
  train<A>(c, model, "", [&](const auto& m, Index k) {
    const auto eps = golden::mdm_rows(tensor<A, 4>(c, golden::noise_name(k)));
    auto text = golden::mdm_condition<A>(c, m.config, shape[0]);
    if (const auto drop = "noise/drop_" + std::to_string(k); c.has(drop)) {
      const auto kept = 1.0 - ml::reshape<2>(tensor<A, 1>(c, drop), {shape[0], 1});
      text.tokens.rows = text.tokens.rows * ml::repeat_for_rows(kept, text.tokens.offsets);
    }
    const auto per_sample =  // no key padding mask in training
        ml::mdm_losses<A>(d, m, {x0, eps, c.values<Index>("in/t_" + std::to_string(k))}, lengths, text);
    if (k == 0) golden::out_if_wanted(c, "loss_per_sample", per_sample);
    return ml::mean(per_sample);
  });
}

template <ml::Backend B>
void motiondiffuse_training(Case& c) {
  using A = ml::Autodiff<B>;
  const auto d = golden::diffusion_of(c.config());
  auto model = ml::convert<A>(golden::motiondiffuse_model<B>(c));
  const auto lengths = c.values<Index>("in/lengths");
  const bool all = model.config.no_eff;
  const auto full = tensor<A, 3>(c, "in/x");
  auto pack = [&](const ml::Tensor<A, 3>& x) {
    return all ? ml::from_equal(x) : ml::from_padded(x, std::span<const Index>(lengths));
  };
  const auto x0 = pack(full);
  const auto text = golden::clip_features<A>(c);
  train<A>(c, model, "", [&](const auto& m, Index k) {
    const auto eps = pack(tensor<A, 3>(c, golden::noise_name(k)));
    return ml::motiondiffuse_loss<A>(d, m, {x0, eps.rows, c.values<Index>("in/t_" + std::to_string(k))}, lengths, text);
  });
}

/// The optimiser alone, with given gradients.
template <ml::Backend B>
void adamw_steps(Case& c) {
  using T = typename B::tensor;
  const auto a = optimiser(c.config());
  const auto steps = c.config()["steps"].as<Index>();
  auto load = [&](const std::string& name) {
    const auto v = c.values<typename B::scalar>(name);
    return B::from_span(std::span<const typename B::scalar>(v), c.shape(name));
  };
  T p = load("in/parameter"), m = B::full(B::shape(p), 0), v = m;
  for (Index k = 1; k <= steps; ++k) {
    ml::adamw_update<B>(
        p, m, v, load("in/grad_" + std::to_string(k)),
        {.lr = a.lr, .beta1 = a.beta1, .beta2 = a.beta2, .eps = a.eps, .weight_decay = a.weight_decay, .step = k});
    c.out("parameter_" + std::to_string(k), B::shape(p), B::to_span(p));
  }
  c.out("exp_avg", B::shape(m), B::to_span(m));
  c.out("exp_avg_sq", B::shape(v), B::to_span(v));
}

/// Two or more parameters as a module, so that the norm over all of them is the library's own.
template <ml::Backend B>
struct Parameters {
  std::vector<ml::Tensor<B, 1>> list;
  static constexpr auto fields() { return ml::fields("list", &Parameters::list); }
};
template <ml::Backend B>
void clipped_adam_steps(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config();
  const auto count = config["parameters"].as<Index>();
  Parameters<B> values;
  auto flat = [&](const std::string& name) {
    return ml::Tensor<B, 1>::from(c.values<typename B::scalar>(name), {c.shape(name).count()});
  };
  for (Index i = 0; i < count; ++i) values.list.push_back(flat("in/param_" + std::to_string(i)));
  auto model = ml::convert<A>(values);
  ml::AdamW<A> adam(optimiser(config));
  for (Index k = 0; k < config["steps"].as<Index>(); ++k) {
    ml::Tensor<A, 0> loss(0.0);  // its gradient is the given one
    for (Index i = 0; i < count; ++i) {
      const auto g = flat("in/grad_" + std::to_string(i) + "_step_" + std::to_string(k));
      loss = loss + ml::sum(model.list[static_cast<std::size_t>(i)] * ml::Tensor<A, 1>::from(g.to_vector(), g.shape()));
    }
    const auto gradients = ml::backward(loss);
    const double norm = ml::gradient_norm<A>(model, gradients);
    c.out_scalar("grad_norm_step_" + std::to_string(k), norm);
    adam.step(model, gradients, ml::clip_scale(norm, config["clip_norm"].as<double>()));
    for (Index i = 0; i < count; ++i) {
      c.out("param_" + std::to_string(i) + "_after_" + std::to_string(k), c.shape("in/param_" + std::to_string(i)),
            model.list[static_cast<std::size_t>(i)].span());
    }
  }
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"mdm smpl training", variant, mdm_smpl_training<B>},
          {"mdm training", variant, mdm_training<B>},
          {"motiondiffuse training", variant, motiondiffuse_training<B>},
          {"adamw steps", variant, adamw_steps<B>},
          {"clipped adam steps", variant, clipped_adam_steps<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
