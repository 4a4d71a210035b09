// Golden functions: SINC's training step with the gradients of all weights through Autodiff, and a step of the
// optimiser.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/vae/sinc_losses.hpp>

#include "teach_sinc.hpp"

namespace {

using golden::Case, golden::Layout, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void training_step(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config();
  auto model = ml::convert<A>(golden::sinc_model<B>(c));
  const auto texts = golden::sinc_texts<A>(c);
  const auto lengths = c.values<Index>("in/lengths");
  const auto motion = ml::from_padded(tensor<A, 3>(c, "in/features"), std::span<const Index>(lengths));
  const auto both =
      model.branches(texts, motion, {golden::rows<A>(c, "noise/eps_text"), golden::rows<A>(c, "noise/eps_motion")});
  auto branch = [&](const std::string& modality, const ml::LatentBranch<A>& b) {
    golden::out_padded(c, "features_" + modality, motion.with(b.frames), c.shape("in/features")[1],
                       Layout::batch_first);
    golden::out_rows(c, "mu_" + modality, b.distribution.mu);
    golden::out_rows(c, "std_" + modality, b.distribution.std());
  };
  branch("text", both.text);
  branch("motion", *both.motion);
  golden::out_rows(c, "z_motion", both.motion->z);
  const auto z = ml::to_padded(ml::Sequences<A>(both.text.z, model.latents(texts)));
  c.out("z_text", c.shape("out/z_text"), z.span());
  golden::out_training_step<A>(
      c, model, model.losses(both, texts, motion, golden::loss_weights(config, ml::sinc_loss_options())));
}

template <ml::Backend B>
Registration over(const std::string& variant) {
  return {"sinc training step", variant, training_step<B>};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
