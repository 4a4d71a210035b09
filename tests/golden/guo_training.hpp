// Golden functions: the training losses of Guo's evaluator, with gradients through Autodiff. A source for each backend
// registers them: together they would take long to compile.
#pragma once

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/loss/margin.hpp>
#include <motionlang/optim/adamw.hpp>

#include "guo_models.hpp"

namespace golden::guo_training {

template <ml::Backend B>
void matching_loss(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config();
  const auto m = ml::convert<A>(golden::evaluator<B>(c));
  const auto both = golden::embeddings(c, m);
  const auto terms = ml::shifted_margin_loss(both.text, both.motion, config["shift"].template as<Index>(),
                                             config["margin"].template as<double>());
  golden::out(c, "text_embedding", both.text);
  golden::out(c, "motion_embedding", both.motion);
  golden::out(c, "loss_pos", terms.terms.at(0).value);
  golden::out(c, "loss_neg", terms.terms.at(1).value);
  golden::out(c, "loss", terms.total());
  const auto gradients = ml::backward(terms.total());
  c.out_scalar("grad_norm_text", ml::gradient_norm<A>(m.text_encoder, gradients));
  c.out_scalar("grad_norm_motion", ml::gradient_norm<A>(m.motion_encoder, gradients));
  ml::visit_tensors(m, [&](const std::string& path, const auto& t) {
    if (path.starts_with("movement_encoder.")) {
      if (gradients.find(t.data()) != nullptr) c.grad(path, t.shape(), t.span());  // the case has none: a failure
      return;
    }
    const auto g = gradients[t];
    c.grad(path, g.shape(), g.span());
  });
}

template <ml::Backend B>
void movement_autoencoder(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config();
  ml::Philox rng;
  ml::MovementAutoencoder<B> inner(config["dim_pose"].template as<Index>(), config["hidden"].template as<Index>(),
                                   config["latent"].template as<Index>(), rng, config["dropout"].template as<double>());
  ml::load_module(inner, c.file(), "weights/");
  const auto m = ml::convert<A>(inner);
  const auto x = ml::from_equal(tensor<A, 3>(c, "in/motions"));
  const auto result = m(x);
  const auto terms = ml::movement_losses<A>(result, x, config["lambda_sparsity"].template as<double>(),
                                            config["lambda_smooth"].template as<double>());
  golden::out(c, "latents", ml::to_padded(result.latents));
  golden::out(c, "recon", ml::to_padded(result.reconstruction));
  for (const auto& term : terms.terms) golden::out(c, "loss_" + term.name, term.value);
  const auto loss = terms.total();
  golden::out(c, "loss", loss);
  golden::out_gradients(c, m, loss);
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"guo matching loss", variant, matching_loss<B>},
          {"guo movement autoencoder losses", variant, movement_autoencoder<B>}};
}

}  // namespace golden::guo_training
