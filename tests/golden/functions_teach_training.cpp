// Golden functions: TEACH's training step with the gradients of all weights through Autodiff, and a step of the
// optimiser.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "teach_sinc.hpp"

namespace {

using golden::Case, golden::Layout, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void training_step(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config();
  auto model = ml::convert<A>(golden::teach_model<B>(c));
  const auto first = c.values<Index>("in/length_0"), transition = c.values<Index>("in/length_transition");
  auto second = c.values<Index>("in/length_1");
  for (std::size_t i = 0; i < second.size(); ++i) second[i] += transition[i];
  auto motion = [&](const std::string& name, const std::vector<Index>& lengths) {
    return ml::from_padded(tensor<A, 3>(c, "in/" + name), std::span<const Index>(lengths));
  };
  const ml::TeachPairs<A> pairs{golden::packed<A>(c, "text_hidden_0", "text_mask_0"),
                                golden::packed<A>(c, "text_hidden_1", "text_mask_1"), motion("features_0", first),
                                motion("features_1", second), ml::Offsets(transition)};
  const auto out = model.branches(pairs,
                                  {{golden::noise<A>(c, "eps_text_0"), golden::noise<A>(c, "eps_motion_0")},
                                   {golden::noise<A>(c, "eps_text_1"), golden::noise<A>(c, "eps_motion_1")}},
                                  {}, config["teacher_forcing"].template as<bool>());
  golden::out(c, "past", ml::to_padded(out.past));
  auto branch = [&](const std::string& modality, const std::string& number, const ml::LatentBranch<A>& b,
                    const ml::Sequences<A>& like) {
    golden::out_padded(c, "features_" + modality + number, like.with(b.frames), c.shape("in/features" + number)[1],
                       Layout::batch_first);
    golden::out_if_wanted(c, "mu_" + modality + number, b.distribution.mu);
    golden::out_if_wanted(c, "std_" + modality + number, b.distribution.std());
    golden::out_if_wanted(c, "z_" + modality + number, b.z);
  };
  branch("text", "_0", out.first.text, pairs.first_motion);
  branch("text", "_1", out.second.text, pairs.second_motion);
  branch("motion", "_0", *out.first.motion, pairs.first_motion);
  branch("motion", "_1", *out.second.motion, pairs.second_motion);
  ml::TeachLossOptions options{.loss_on_transition = config["loss_on_transition"].template as<bool>()};
  options.each = golden::loss_weights(config, options.each);
  golden::out_training_step<A>(c, model, ml::teach_losses(out, pairs, options));
}

template <ml::Backend B>
Registration over(const std::string& variant) {
  return {"teach training step", variant, training_step<B>};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
