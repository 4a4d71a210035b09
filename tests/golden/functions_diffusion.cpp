// Golden functions of the diffusion engine; the network is a toy that is linear in every channel.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/diffusion/guidance.hpp>
#include <motionlang/diffusion/respacing.hpp>
#include <motionlang/loss/reconstruction.hpp>

#include "tensors.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

// ---- schedules: numbers in double, no tensors
// -------------------------------------------------------------------------------

void beta_schedule(Case& c) {
  const auto d = golden::diffusion_of(c.config());
  auto list = [&](const std::string& name, auto f) {
    if (!c.wants(name)) return;
    std::vector<double> values;
    for (Index t = 0; t < d.steps(); ++t) values.push_back(f(t));
    c.out(name, values);
  };
  list("beta", [&](Index t) { return d.beta(t); });
  list("alpha", [&](Index t) { return d.alpha(t); });
  list("abar", [&](Index t) { return d.abar(t); });
  list("abarp", [&](Index t) { return d.abarp(t); });
  list("abarn", [&](Index t) { return d.abarn(t); });
  list("pvar", [&](Index t) { return d.posterior_variance(t); });
  list("plogv", [&](Index t) { return d.posterior_log_variance(t); });
  list("var_large", [&](Index t) { return d.large_variance(t); });
  list("c0", [&](Index t) { return d.c0(t); });
  list("ct", [&](Index t) { return d.ct(t); });
  list("sqrt_abar", [&](Index t) { return std::sqrt(d.abar(t)); });
  list("sqrt_1m_abar", [&](Index t) { return std::sqrt(1 - d.abar(t)); });
  list("log_1m_abar", [&](Index t) { return std::log(1 - d.abar(t)); });
  list("sqrt_1_over_abar", [&](Index t) { return std::sqrt(1 / d.abar(t)); });
  list("sqrt_1_over_abar_m1", [&](Index t) { return std::sqrt(1 / d.abar(t) - 1); });
  list("1_over_1m_abar", [&](Index t) { return 1 / (1 - d.abar(t)); });
  list("1_over_sqrt_abar", [&](Index t) { return 1 / std::sqrt(d.abar(t)); });
  list("sqrt_abar_over_1m_abar", [&](Index t) { return std::sqrt(d.abar(t)) / (1 - d.abar(t)); });
  list("sqrt_of_abar_over_1m_abar", [&](Index t) { return std::sqrt(d.abar(t) / (1 - d.abar(t))); });
  list("1m_abar_over_sqrt_abar", [&](Index t) { return (1 - d.abar(t)) / std::sqrt(d.abar(t)); });
  list("sqrt_1_over_1m_abar", [&](Index t) { return std::sqrt(1 / (1 - d.abar(t))); });
  list("e1", [&](Index t) { return 1 / std::sqrt(d.alpha(t)); });
  list("e2", [&](Index t) { return d.beta(t) / (std::sqrt(1 - d.abar(t)) * std::sqrt(d.alpha(t))); });
  list("s2", [&](Index t) { return d.beta(t) / std::sqrt(d.alpha(t)); });
}

void schedule_acceptance(Case& c) {
  std::vector<std::uint8_t> accepted;
  const auto cases = c.config()["cases"];
  for (Index i = 0; i < cases.size(); ++i) {
    try {
      golden::diffusion_of(cases[i]);
      accepted.push_back(1);
    } catch (const ml::config_error&) {
      accepted.push_back(0);
    }
  }
  c.out("accepted", accepted);
}

/// The indices that a respacing keeps: null for all, a list of counts, or a string.
std::vector<Index> kept_steps(const ml::JsonView& config, const std::string& key, Index T) {
  if (!config.contains(key) || config[key].is_null()) return ml::respace(T, "");
  if (config[key].is_array()) return ml::respace(T, config[key].as<std::vector<Index>>());
  return ml::respace(T, config[key].as<std::string>());
}
ml::GaussianDiffusion respaced(const ml::JsonView& config, const std::string& key = "respacing") {
  const auto d = golden::diffusion_of(config);
  return d.respaced(kept_steps(config, key, d.steps()));
}
/// The time that the network receives: the original index, or this index rescaled to 1000 steps.
double network_time(const ml::GaussianDiffusion& d, Index t, bool rescale, Index original_steps) {
  const auto original = static_cast<double>(d.network_t(t));
  return rescale ? original * (1000.0 / static_cast<double>(original_steps)) : original;
}

void respacing(Case& c) {
  std::vector<std::uint8_t> rejected;
  const auto cases = c.config()["cases"];
  for (Index i = 0; i < cases.size(); ++i) {
    try {
      const auto d = respaced(cases[i], "spec");
      const bool rescale = cases[i].value_or("rescale_timesteps", false);
      std::vector<Index> steps;
      std::vector<double> beta, abar, pvar, network_t;
      for (Index t = 0; t < d.steps(); ++t) {
        steps.push_back(d.network_t(t));
        beta.push_back(d.beta(t));
        abar.push_back(d.abar(t));
        pvar.push_back(d.posterior_variance(t));
        network_t.push_back(network_time(d, t, rescale, cases[i]["T"].as<Index>()));
      }
      const std::string suffix = "_" + std::to_string(i);
      c.out("steps" + suffix, steps);
      c.out("beta" + suffix, beta);
      c.out("abar" + suffix, abar);
      c.out("pvar" + suffix, pvar);
      c.out("network_t" + suffix, network_t);
      rejected.push_back(0);
    } catch (const ml::config_error&) {
      rejected.push_back(1);
    }
  }
  c.out("rejected", rejected);
}

// ---- tensors over a backend
// -----------------------------------------------------------------------------------------------

/// Any rank as (batch, rest): the engine treats all axes but the first alike.
template <ml::Backend B>
ml::Tensor<B, 2> flat(const Case& c, const std::string& name) {
  const auto s = c.shape(name);
  return ml::Tensor<B, 2>::from(c.values<typename B::scalar>(name), {s[0], s.count(1, s.rank())});
}
template <ml::Backend B>
void out_like(Case& c, const std::string& name, const ml::Tensor<B, 2>& t) {
  if (c.wants(name)) c.out(name, c.shape("out/" + name), t.span());
}

template <ml::Backend B>
void forward_noising(Case& c) {
  const auto d = golden::diffusion_of(c.config());
  out_like(c, "x_t", ml::q_sample(d, flat<B>(c, "in/x0"), c.values<Index>("in/t"), flat<B>(c, "noise/000")));
}

template <ml::Backend B>
void posterior(Case& c) {
  const auto d = golden::diffusion_of(c.config());
  const auto t = c.values<Index>("in/t");
  const auto x_t = flat<B>(c, "in/x_t");
  out_like(c, "mean_from_x0", ml::posterior_mean(d, flat<B>(c, "in/x0"), x_t, t));
  if (c.has("in/eps")) out_like(c, "mean_from_eps", ml::posterior_mean_from_eps(d, flat<B>(c, "in/eps"), x_t, t));
  if (c.has("in/score"))
    out_like(c, "mean_from_score", ml::posterior_mean_from_score(d, flat<B>(c, "in/score"), x_t, t));
  std::vector<double> variance, log_variance;
  for (Index i : t) {
    variance.push_back(d.posterior_variance(i));
    log_variance.push_back(d.posterior_log_variance(i));
  }
  if (c.wants("variance")) c.out("variance", variance);
  if (c.wants("log_variance")) c.out("log_variance", log_variance);
}

template <ml::Backend B>
void prediction_conversion(Case& c) {
  using ml::Prediction, ml::convert_prediction;
  const auto d = golden::diffusion_of(c.config());
  const auto t = c.values<Index>("in/t");
  const auto x_t = flat<B>(c, "in/x_t");
  if (c.has("in/value")) {
    const auto value = flat<B>(c, "in/value");
    out_like(c, "x0_from_x_prev", ml::to_x0(d, Prediction::x_prev, value, x_t, t));
    out_like(c, "eps_from_x0", ml::eps_from_x0(d, value, x_t, t));
    out_like(c, "x0_from_eps", ml::to_x0(d, Prediction::eps, value, x_t, t));
    return;
  }
  const auto x0 = flat<B>(c, "in/x0");
  const auto eps = convert_prediction(d, Prediction::x0, Prediction::eps, x0, x_t, t);
  const auto score = convert_prediction(d, Prediction::x0, Prediction::score, x0, x_t, t);
  out_like(c, "eps", eps);
  out_like(c, "score", score);
  out_like(c, "x0_from_eps", convert_prediction(d, Prediction::eps, Prediction::x0, eps, x_t, t));
  out_like(c, "x0_from_score", convert_prediction(d, Prediction::score, Prediction::x0, score, x_t, t));
  out_like(c, "eps_from_score", convert_prediction(d, Prediction::score, Prediction::eps, score, x_t, t));
  out_like(c, "score_from_eps", convert_prediction(d, Prediction::eps, Prediction::score, eps, x_t, t));
}

template <ml::Backend B>
void guidance(Case& c) {
  const Index weights = c.shape("in/w").count();  // one for each sample, or one for all
  const auto w = ml::Tensor<B, 2>::from(c.values<typename B::scalar>("in/w"), {weights, 1});
  out_like(c, "guided", ml::guide(flat<B>(c, "in/cond"), flat<B>(c, "in/null"), w));
}

/// out = a_f x + b_f + c_f index / 1000 for channel f; guided with a second offset for the null call.
template <ml::Backend B>
class Toy {
 public:
  Toy(const Case& c, const ml::Shape& shape, int feature_axis) : shape_(shape) {
    auto spread = [&](const std::string& name) {
      const auto channel = c.values<typename B::scalar>("in/toy_" + name);
      std::vector<typename B::scalar> out;
      const Index inner = shape.count(feature_axis + 1, shape.rank()), width = shape[feature_axis];
      for (Index i = 0; i < shape.count(1, shape.rank()); ++i)
        out.push_back(channel[static_cast<std::size_t>(i / inner % width)]);
      return ml::Tensor<B, 1>::from(out, {static_cast<Index>(out.size())});
    };
    a_ = spread("a"), cond_ = spread("b_cond"), null_ = spread("b_null"), c_ = spread("c");
  }
  /// Per-sample indices as a column.
  ml::Tensor<B, 2> operator()(const ml::Tensor<B, 2>& x, const ml::Tensor<B, 2>& time, double w) const {
    const auto base = x * a_ + time * (1.0 / 1000) * c_;
    return w == 1 ? base + cond_ : ml::guide(base + cond_, base + null_, w);
  }
  ml::Tensor<B, 2> operator()(const ml::Tensor<B, 2>& x, double time, double w) const {
    return (*this)(x, ml::Tensor<B, 2>(time), w);
  }

 private:
  ml::Shape shape_;
  ml::Tensor<B, 1> a_, cond_, null_, c_;
};

ml::StepOptions step_options(const ml::JsonView& config) {
  return {.prediction = golden::prediction_of(config),
          .noise_scale = golden::noise_scale_of(config),
          .variance = config.value_or("variance", "fixed_small") == "fixed_large" ? ml::Variance::fixed_large
                                                                                  : ml::Variance::fixed_small,
          .clip = config.value_or("clip", false)};
}

/// Everything that a step and the chains share: process, toy, hooks.
template <ml::Backend B>
struct Chain {
  explicit Chain(Case& c_, const std::string& like = "noise/000")
      : c(c_),
        config(c.config()),
        d(respaced(config)),
        toy(c, c.shape(like), config["feature_axis"].template as<int>()) {}

  double network_time(Index t) const {
    return ::network_time(d, t, config.value_or("rescale_timesteps", false), config["T"].template as<Index>());
  }
  auto network() const {
    return [this](const ml::Tensor<B, 2>& x, Index t) {
      return toy(x, network_time(t), config.value_or("guidance", 1.0));
    };
  }
  /// The index of the first step.
  Index first() const { return d.steps() - 1 - config.value_or("skip_timesteps", Index{0}); }
  /// Where the chain begins: at the noise, or at a motion to which it is added. The initial noise is never shared.
  ml::Tensor<B, 2> start() const {
    const auto x = flat<B>(c, "noise/000");
    const Index t = first();
    if (t == d.steps() - 1 && !c.has("in/init_motion")) return x;
    const auto motion = c.has("in/init_motion") ? flat<B>(c, "in/init_motion") : ml::Tensor<B, 2>::zeros(x.shape());
    return ml::q_sample(d, motion, std::span(&t, 1), x);
  }
  /// Known values take the place of the clean estimate.
  auto inpainting() const {
    return [this](const ml::Tensor<B, 2>& x0, Index) {
      if (!c.has("in/inpainting_mask")) return x0;
      const auto mask = flat<B>(c, "in/inpainting_mask");
      return ml::where_less(mask, ml::Tensor<B, 2>(0.5), x0, flat<B>(c, "in/inpainted_motion"));
    };
  }
  auto watch() const {
    return [this](Index t, const ml::AncestralStep<B, 2>& step) {
      out_like(c, "x_after_" + golden::three_digits(t), step.x_prev);
    };
  }
  ml::Tensor<B, 2> noise(Index k) const {
    const auto z = flat<B>(c, golden::noise_name(k));
    if (!config.value_or("const_noise", false)) return z;
    return ml::broadcast_to<2>(ml::slice(z, 0, 0, 1), z.shape());  // everybody uses row 0
  }

  Case& c;
  ml::JsonView config;
  ml::GaussianDiffusion d;
  Toy<B> toy;
};

template <ml::Backend B>
void single_step(Case& c) {
  const Chain<B> chain(c, "in/x_t");
  const auto& d = chain.d;
  const auto t = c.values<Index>("in/t");
  const auto x = flat<B>(c, "in/x_t");
  const auto time = ml::coefficients<B, 2>(t, [&](Index i) { return chain.network_time(i); });
  const auto options = step_options(chain.config);
  const auto output = chain.toy(x, time, chain.config.value_or("guidance", 1.0));
  const auto step = ml::ancestral_step(d, x, output, flat<B>(c, "noise/000"), t, options);
  out_like(c, "x0", step.x0);
  out_like(c, "mean", step.mean);
  out_like(c, "x_prev", step.x_prev);
  std::vector<double> factor;
  for (Index i : t) factor.push_back(d.noise_factor(i, options.noise_scale, options.variance));
  c.out("factor", factor);
}

template <ml::Backend B>
void ancestral_chain(Case& c) {
  const Chain<B> chain(c);
  out_like(c, "sample",
           ml::sample_ancestral(
               chain.d, chain.start(), chain.network(), [&](Index draw) { return chain.noise(draw + 1); },
               step_options(chain.config), chain.inpainting(), {}, chain.first(), chain.watch()));
}

template <ml::Backend B>
void ddim_chain(Case& c) {
  const Chain<B> chain(c);
  out_like(c, "sample",
           ml::sample_ddim(
               chain.d, chain.start(), chain.network(), [&](Index draw) { return chain.noise(draw + 1); },
               chain.config["eta"].template as<double>(), step_options(chain.config), chain.inpainting(), {},
               chain.watch(), chain.first()));
}

template <ml::Backend B>
void ddim_inversion(Case& c) {
  const Chain<B> chain(c, "in/x0");
  auto x = flat<B>(c, "in/x0");
  for (Index t = 0; t < chain.d.steps(); ++t) {
    x = ml::ddim_inversion_step(chain.d, x, chain.network()(x, t), t, step_options(chain.config));
    out_like(c, "x_after_" + golden::three_digits(t), x);
  }
  out_like(c, "x_T", x);
}

template <ml::Backend B>
void plms_chain(Case& c) {
  const Chain<B> chain(c);
  out_like(c, "sample",
           ml::sample_plms(chain.d, chain.noise(0), chain.network(), chain.config["order"].template as<int>(),
                           step_options(chain.config), {}, chain.watch()));
}

template <ml::Backend B>
void training_loss(Case& c) {
  const auto d = golden::diffusion_of(c.config());
  const auto t = c.values<Index>("in/t");
  const auto mask = c.values<unsigned char>("in/mask");
  const auto x0 = tensor<B, 3>(c, "in/x0"), eps = tensor<B, 3>(c, "noise/000");
  const Toy<B> toy(c, c.shape("in/x0"), c.config()["feature_axis"].as<int>());
  auto predict = [&](const ml::Tensor<B, 3>& x) {
    const auto rows = ml::reshape<2>(x, {x.size(0), x.size(1) * x.size(2)});
    const auto time = ml::coefficients<B, 2>(t, [](Index i) { return static_cast<double>(i); });
    return ml::reshape<3>(toy(rows, time, 1), {x.size(0), x.size(1), x.size(2)});
  };
  const auto output = predict(ml::q_sample(d, x0, t, eps));
  const auto target = ml::from_padded(x0, std::span<const unsigned char>(mask));
  const auto predicted = ml::from_padded(output, std::span<const unsigned char>(mask));
  const auto per_sample = ml::mse_per_sequence(target, predicted.rows);
  c.out_scalar("loss_stmc_x0", static_cast<double>(ml::padded_mse(target, predicted.rows, x0.size(1)).item()));
  golden::out(c, "loss_mdm_per_sample", per_sample);
  c.out_scalar("loss_mdm", static_cast<double>(ml::mean(per_sample).item()));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"diffusion forward noising", variant, forward_noising<B>},
          {"diffusion posterior", variant, posterior<B>},
          {"diffusion prediction conversion", variant, prediction_conversion<B>},
          {"diffusion guidance", variant, guidance<B>},
          {"diffusion ancestral step", variant, single_step<B>},
          {"diffusion ancestral chain", variant, ancestral_chain<B>},
          {"diffusion ddim chain", variant, ddim_chain<B>},
          {"diffusion ddim inversion", variant, ddim_inversion<B>},
          {"diffusion plms chain", variant, plms_chain<B>},
          {"diffusion training loss", variant, training_loss<B>}};
}

const Registration registrations[] = {{"diffusion beta schedule", "double", beta_schedule},
                                      {"diffusion schedule acceptance", "double", schedule_acceptance},
                                      {"diffusion respacing", "double", respacing}};
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
