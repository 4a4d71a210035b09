// Golden functions: ACTOR's loss and its gradients, through Autodiff. A source for each backend registers them:
// together they would take long to compile.
#pragma once

#include <motionlang/backend/autodiff.hpp>

#include "actor_models.hpp"
#include "bodies.hpp"

namespace golden::actor_losses {

template <ml::Backend B>
void out_terms(Case& c, const ml::LossTerms<B>& loss) {
  for (const auto& term : loss.terms) c.out_scalar(term.name, static_cast<double>(term.value.item()));
}

template <ml::Backend B>
void loss_terms(Case& c) {
  const ml::LatentGaussian<B> latent{tensor<B, 2>(c, "in/mu"), tensor<B, 2>(c, "in/logvar")};
  const ml::ActorLossPoints<B> points{golden::motions<B>(c, "in/x_xyz"), golden::motions<B>(c, "in/output_xyz")};
  out_terms(c, ml::actor_losses<B>(latent, golden::motions<B>(c), golden::motions<B>(c, "in/output"),
                                   {.vel = 1, .velxyz = 1}, points));
}

/// The points of a motion, as the case wants them compared.
template <ml::Backend A>
ml::Sequences<A> points_of(const Case& c, const ml::Sequences<A>& x, const ml::BodyModel<A>& body,
                           const ml::Tensor<A, 2>& regressor) {
  const auto config = c.config();
  ml::ActorPointOptions o{.features = {.rotations = ml::parse_pose_representation(config["pose_rep"].as<std::string>()),
                                       .translation = config["translation"].as<bool>(),
                                       .global = config["glob"].as<bool>()},
                          .translate = config["vertstrans"].as<bool>()};
  if (config.contains("glob_rot")) {
    const auto r = config["glob_rot"].as<std::vector<double>>();
    o.global_rotation = {r[0], r[1], r[2]};
  }
  return ml::actor_points(x, body, &regressor, ml::parse_actor_points(config["jointstype"].as<std::string>()), o);
}

template <ml::Backend B>
void losses(Case& c) {
  using A = ml::Autodiff<B>;
  ml::NoInit zeros;
  const auto model = ml::convert<A>(golden::loaded(c, ml::Actor<B>(golden::actor_config(c), zeros)));
  const auto x = golden::motions<A>(c);
  const auto y = c.values<Index>("in/y");
  const auto latent = model.encode(x, y, {}, c.shape("in/x")[3]);
  const auto written = model.decode(latent.sample(tensor<A, 2>(c, "noise/eps")), y, x.offsets);
  const auto lambdas = c.config()["lambdas"];
  auto used = [&](const char* name) { return lambdas.contains(name) ? 1.0 : 0.0; };
  const ml::ActorLossWeights w{
      .rc = used("rc"), .rcxyz = used("rcxyz"), .kl = used("kl"), .vel = used("vel"), .velxyz = used("velxyz")};
  std::optional<ml::ActorLossPoints<A>> points;
  if (w.rcxyz != 0 || w.velxyz != 0) {
    const auto body = ml::convert<A>(golden::body_of<B>(c, "in/body."));
    const auto regressor = tensor<A, 2>(c, "in/body.J_regressor_extra");
    points = {points_of(c, x, body, regressor), points_of(c, written, body, regressor)};
  }
  auto terms = ml::actor_losses(latent, x, written, w, points);
  for (auto& term : terms.terms) term.weight = lambdas[term.name].template as<double>();
  out_terms(c, terms);
  const auto loss = terms.total();
  c.out_scalar("loss", static_cast<double>(loss.item()));
  const auto gradients = ml::backward(loss);
  ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
    const auto g = gradients[t];
    c.grad(ml::Actor<A>::official_key(path), g.shape(), g.span());
  });
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"actor loss terms", variant, loss_terms<B>}, {"actor losses", variant, losses<B>}};
}

}  // namespace golden::actor_losses
