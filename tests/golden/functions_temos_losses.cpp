// Golden functions: the losses of TEMOS, with the gradients of all weights through Autodiff.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "text_motion.hpp"

namespace {

using golden::Case, golden::Layout, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void temos_losses(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config();
  const auto m = ml::convert<A>(golden::temos_model<B>(c));
  const auto motion = golden::packed<A>(c, "features", "mask"), text = golden::packed<A>(c, "text_x", "text_mask");
  const auto both = m.branches(text, motion, {golden::noise<A>(c, "eps_text"), golden::noise<A>(c, "eps_motion")});
  const Index frames = golden::padded_frames(c);
  const auto terms =
      ml::temos_losses(both, motion,
                       {.recons = config["lmd_recons"].template as<double>(),
                        .kl = config["lmd_kl"].template as<double>(),
                        .latent = config["lmd_latent"].template as<double>(),
                        .embedding = config["loss_on_both"].template as<bool>(),
                        .feats = config["mode"].template as<std::string>() == "xyz" ? "jfeats" : "rfeats",
                        .padded_frames = frames});
  for (const auto& term : terms.terms) golden::out(c, term.name, term.value);
  golden::out(c, "latent_text", both.text.z);
  golden::out(c, "latent_motion", both.motion->z);
  golden::out_padded(c, "features_text", motion.with(both.text.frames), frames, Layout::batch_first);
  golden::out_padded(c, "features_motion", motion.with(both.motion->frames), frames, Layout::batch_first);
  const auto loss = terms.total();
  golden::out(c, "loss", loss);
  golden::out_gradients(c, m, loss);
}

template <ml::Backend B>
Registration over(const std::string& variant) {
  return {"temos losses", variant, temos_losses<B>};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
