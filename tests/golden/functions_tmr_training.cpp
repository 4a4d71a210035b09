// Golden functions: the losses of TMR and their parts with gradients, and training steps, through Autodiff.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/optim/adamw.hpp>

#include "text_motion.hpp"

namespace {

using golden::Case, golden::Layout, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::AutodiffBackend A>
ml::Tensor<A, 2> variable(const Case& c, const std::string& name) {
  return ml::variable<A>(tensor<typename A::inner, 2>(c, "in/" + name));
}

template <ml::Backend B>
void kl_divergence(Case& c) {
  using A = ml::Autodiff<B>;
  std::vector<ml::Tensor<A, 2>> x;
  const std::vector<std::string> names{"mu_q", "logvar_q", "mu_p", "logvar_p"};
  for (const auto& name : names) x.push_back(variable<A>(c, name));
  const auto kl = ml::kl_divergence(x[0], x[1], x[2], x[3]);
  golden::out(c, "kl", kl);
  const auto gradients = ml::backward(kl);
  for (std::size_t i = 0; i < names.size(); ++i) golden::out(c, "d_" + names[i], gradients[x[i]]);
}

template <ml::Backend B>
void info_nce(Case& c) {
  using A = ml::Autodiff<B>;
  const auto x = variable<A>(c, "x"), y = variable<A>(c, "y");
  std::vector<unsigned char> filtered;
  if (c.has("in/sent_emb"))
    filtered = ml::false_negatives(tensor<B, 2>(c, "in/sent_emb"), c.config().value_or("threshold_selfsim", 0.0));
  const auto loss = ml::info_nce(x, y, c.config()["temperature"].as<double>(), filtered);
  golden::out(c, "loss", loss);
  const auto gradients = ml::backward(loss);
  golden::out(c, "d_x", gradients[x]);
  golden::out(c, "d_y", gradients[y]);
  golden::out(c, "similarity", ml::cosine_similarity(x, y));
  if (filtered.empty()) filtered.resize(static_cast<std::size_t>(x.size(0) * x.size(0)));
  if (c.wants("filtered")) c.out("filtered", {x.size(0), x.size(0)}, filtered);
}

/// One batch and its loss; `step` stands before the names of the noise.
template <ml::AutodiffBackend A>
struct Batch {
  ml::Sequences<A> text, motion;
  std::optional<ml::Tensor<A, 2>> sentences;
  ml::TmrLossOptions options;
  double fact = 1;

  Batch(const Case& c, bool contrastive)
      : text(golden::packed<A>(c, "text_x", "text_mask")), motion(golden::packed<A>(c, "motion_x", "motion_mask")) {
    if (c.has("in/sent_emb")) sentences = tensor<A, 2>(c, "in/sent_emb");
    const auto config = c.config(), weights = config["lmd"];
    fact = config.value_or("fact", 1.0);
    options.padded_frames = c.shape("in/motion_mask")[1];
    options.recons = weights["recons"].as<double>();
    options.kl = weights.value_or("kl", 0.0);
    options.latent = weights["latent"].as<double>();
    options.contrastive_loss = contrastive ? ml::ContrastiveLoss::info_nce : ml::ContrastiveLoss::none;
    if (!contrastive) return;
    options.contrastive = weights["contrastive"].as<double>();
    options.temperature = config["temperature"].as<double>();
    options.threshold = config.value_or("threshold_selfsim", 0.0);
  }
  ml::TextMotionBranches<A> branches(const Case& c, const ml::Tmr<A>& m, const std::string& step = "") const {
    return m.branches(text, motion,
                      {golden::noise<A>(c, step + "eps_text"), golden::noise<A>(c, step + "eps_motion"), fact});
  }
  ml::LossTerms<A> losses(const ml::TextMotionBranches<A>& both) const {
    return ml::tmr_losses(both, motion, sentences ? &*sentences : nullptr, options);
  }
};

template <ml::Backend B, bool contrastive>
void tmr_losses(Case& c) {
  using A = ml::Autodiff<B>;
  const auto m = ml::convert<A>(golden::tmr_model<B>(c));
  const Batch<A> batch(c, contrastive);
  const auto both = batch.branches(c, m);
  const auto terms = batch.losses(both);
  for (const auto& term : terms.terms) golden::out(c, term.name, term.value);
  golden::out_if_wanted(c, "latent_text", both.text.z);
  golden::out_if_wanted(c, "latent_motion", both.motion->z);
  const auto loss = terms.total();
  golden::out(c, "loss", loss);
  golden::out_gradients(c, m, loss);
}

template <ml::Backend B>
void training_steps(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config(), betas = config["betas"];
  auto m = ml::convert<A>(golden::tmr_model<B>(c));
  const Batch<A> batch(c, true);
  ml::AdamW<A> adam({.lr = config["lr"].template as<double>(),
                     .beta1 = betas[0].template as<double>(),
                     .beta2 = betas[1].template as<double>(),
                     .eps = config["eps"].template as<double>(),
                     .weight_decay = config["weight_decay"].template as<double>()});
  for (Index k = 1; k <= config["steps"].template as<Index>(); ++k) {
    const std::string step = "step" + std::to_string(k) + ".";
    const auto loss = batch.losses(batch.branches(c, m, step)).total();
    golden::out(c, step + "loss", loss);
    adam.step(m, ml::backward(loss));
    ml::visit_tensors(m, [&](const std::string& path, const auto& t) { golden::out_if_wanted(c, step + path, t); });
  }
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"tmr kl divergence", variant, kl_divergence<B>},
          {"InfoNCE with filtering", variant, info_nce<B>},
          {"tmr losses", variant, tmr_losses<B, true>},
          {"tmr temos losses", variant, tmr_losses<B, false>},
          {"tmr training steps", variant, training_steps<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
