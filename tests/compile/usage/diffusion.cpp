// Names that the usage examples of the trainings of diffusion models use without declaring them.
#include "usage.hpp"

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/train/diffusion_training.hpp>
#include <motionlang/train/mdm_action_training.hpp>

using A = Autodiff<B>;

void own_text_encoder(const std::vector<std::string>& texts, Philox rng) {
#include "weights/own_text_encoder.1.inc"
}
void diffusion_losses(const GaussianDiffusion& diffusion, const MdmSmplDenoiser<A>& denoiser, const Sequences<A>& x0,
                      const Tensor<A, 2>& eps, const std::vector<Index>& t, const TextFeatures<A>& text) {
#include "train/diffusion_losses.1.inc"
}
void diffusion_presets() {
#include "train/diffusion_presets.1.inc"
}
void diffusion_texts_of(const MdmTrainingConfig& config, const DescribedMotions& data) {
#include "train/diffusion_texts.1.inc"
}
void diffusion_training() {
#include "train/diffusion_training.1.inc"
}
void mdm_action_training() {
#include "train/mdm_action_training.1.inc"
}
