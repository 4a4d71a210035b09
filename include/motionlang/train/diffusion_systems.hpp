// SPDX-License-Identifier: MIT
/// The differences between the trainings of MDM-SMPL, MDM and MotionDiffuse: one type for each system, a parameter of
/// DiffusionTraining.
///   Config       the configuration of the training
///   Denoiser     the network
///   name         of the system in config.json
///   prefix       of the names of the network's tensors
///   drops_last   the last batch of an epoch is left out if it is smaller
///   states       true if the network reads all states of a text, not one vector
///   sizes        of the network
///   make         the network with the initial weights of the published program
///   item         the frames and the text of a training sample; `first` of one for validation
///   pads         0, or the number of frames to which motions are padded: before they are normalised, or after
///   loss         of a batch, without regularisation; `frames` of the longest motion, if that is in another part
///   share        the share of a part's loss in that of the batch
///   describe     writes the sizes into the description that the reader of the model takes
#pragma once

#include <algorithm>  // max
#include <span>       // lengths
#include <vector>     // lengths

#include <motionlang/train/batch_parts.hpp>
#include <motionlang/train/diffusion_items.hpp>
#include <motionlang/train/diffusion_losses.hpp>
#include <motionlang/weights/diffusion_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames that a motion is padded with, and when.
struct FramePadding {
  Index frames = 0;
  bool normalised = true;  // zeros are added to normalised frames; otherwise to the frames before that
};

namespace detail {

/// Gives all layers the weights of the first one, as torch.nn.TransformerEncoder and TransformerDecoder do.
template <class Stack>
void make_layers_equal(Stack& stack) {
  using B = module_backend<Stack>;
  for (std::size_t i = 1; i < stack.layers.size(); ++i) {
    zip_tensors(stack.layers[i], stack.layers[0],
                [](const auto& to, const auto& from) { *to.data = B::from_span(from.span(), from.shape()); });
  }
}
template <Module M>
void make_zero(M& module) {
  using B = module_backend<M>;
  for (const auto& t : tensors_of(module)) *t.data = B::full(t.shape(), 0);
}

MdmSmplConfig network_sizes(const MdmSmplTrainingConfig& c, Index width, Index text_width);
MdmConfig network_sizes(const MdmTrainingConfig& c, Index width, Index text_width);
MotionDiffuseConfig network_sizes(const MotionDiffuseTrainingConfig& c, Index width, Index text_width);
MdmArch parse_mdm_arch(const std::string& name);

/// MDM's network with PyTorch's initial weights.
template <Backend B>
MdmDenoiser<B> new_mdm(const MdmConfig& sizes, Philox rng) {
  MdmDenoiser<B> out(sizes, rng);
  if (out.seqTransEncoder) make_layers_equal(*out.seqTransEncoder);
  if (out.seqTransDecoder) make_layers_equal(*out.seqTransDecoder);
  return out;
}

}  // namespace detail

/// Source  nv-tlabs/stmc train.py, configs/
struct MdmSmplSystem {
  using Config = MdmSmplTrainingConfig;
  template <Backend B>
  using Denoiser = MdmSmplDenoiser<B>;
  static constexpr const char *name = "stmc", *prefix = "denoiser.";
  static constexpr bool drops_last = false, drops_texts = false;  // `item` drops them

  static bool states(const Config&) { return false; }
  static bool ema_warmup(const Config&) { return true; }
  static FramePadding pads(const Config&) { return {}; }
  static DiffusionItem item(const Config& c, const DescribedMotion& m, Index frames, Philox rng) {
    return mdm_smpl_item(m, frames, c.items, c.text.drop, rng);
  }
  static DiffusionItem first(const DescribedMotion& m) { return first_item(m); }
  template <Backend B>
  static MdmSmplDenoiser<B> make(const Config& c, Index width, Index text_width, Philox rng) {
    MdmSmplDenoiser<B> out(detail::network_sizes(c, width, text_width), rng);
    detail::make_layers_equal(out.seqTransEncoder);
    return out;
  }
  template <Backend B>
  static Tensor<B, 0> loss(const GaussianDiffusion& d, const MdmSmplDenoiser<B>& denoiser,
                           const NoisedMotions<B>& batch, std::span<const Index>, const TextFeatures<B>& text,
                           const Context& context, Index frames) {
    return mdm_smpl_loss(d, denoiser, batch, text, context, Prediction::x0, frames);
  }
  static double share(const BatchPart& part, std::span<const Index> lengths) { return part.share(std::ssize(lengths)); }
  static void describe(DiffusionRun& run, const Config& c, Index width, Index text_width) {
    run.mdm_smpl = detail::network_sizes(c, width, text_width);
    run.features = "smplrifke";
  }
};

/// Source  GuyTevet/motion-diffusion-model train/train_mdm.py, train/training_loop.py
struct MdmSystem {
  using Config = MdmTrainingConfig;
  template <Backend B>
  using Denoiser = MdmDenoiser<B>;
  static constexpr const char *name = "mdm", *prefix = "";
  static constexpr bool drops_last = true, drops_texts = true;
  static constexpr Index longest = 196;

  static bool states(const Config& c) { return c.network.arch == "trans_dec" && c.text.encoder != "clip"; }
  static bool ema_warmup(const Config& c) { return c.ema_warmup; }
  static FramePadding pads(const Config& c) { return {.frames = c.network.mask_frames ? 0 : longest}; }
  static DiffusionItem item(const Config&, const DescribedMotion& m, Index, Philox rng) { return mdm_item(m, rng); }
  static DiffusionItem first(const DescribedMotion& m) { return first_item(m, longest); }
  template <Backend B>
  static MdmDenoiser<B> make(const Config& c, Index width, Index text_width, Philox rng) {
    return detail::new_mdm<B>(detail::network_sizes(c, width, text_width), rng);
  }
  template <Backend B>
  static Tensor<B, 0> loss(const GaussianDiffusion& d, const MdmDenoiser<B>& denoiser, const NoisedMotions<B>& batch,
                           std::span<const Index> lengths, const TextFeatures<B>& text, const Context& context, Index) {
    return mean(mdm_losses(d, denoiser, batch, lengths, text, context));
  }
  static double share(const BatchPart& part, std::span<const Index> lengths) { return part.share(std::ssize(lengths)); }
  static void describe(DiffusionRun& run, const Config& c, Index width, Index text_width) {
    run.mdm = detail::network_sizes(c, width, text_width);
    run.features = "guoh3dfeats";
  }
};

/// Source  mingyuan-zhang/MotionDiffuse text2motion/tools/train.py, trainers/ddpm_trainer.py
struct MotionDiffuseSystem {
  using Config = MotionDiffuseTrainingConfig;
  template <Backend B>
  using Denoiser = MotionDiffuseDenoiser<B>;
  static constexpr const char *name = "motiondiffuse", *prefix = "";
  static constexpr bool drops_last = true, drops_texts = false;
  static constexpr Index longest = 196;

  static bool states(const Config&) { return true; }
  static bool ema_warmup(const Config&) { return true; }
  /// Linear attention gives padded frames no weight, so they are left out.
  static FramePadding pads(const Config& c) { return {.frames = c.network.no_eff ? longest : 0, .normalised = false}; }
  static DiffusionItem item(const Config&, const DescribedMotion& m, Index, Philox rng) {
    return motiondiffuse_item(m, rng, longest);
  }
  static DiffusionItem first(const DescribedMotion& m) { return first_item(m, longest); }
  /// Parts of the network begin with zeros: it predicts 0, and each block changes nothing.
  template <Backend B>
  static MotionDiffuseDenoiser<B> make(const Config& c, Index width, Index text_width, Philox rng) {
    MotionDiffuseDenoiser<B> out(detail::network_sizes(c, width, text_width), rng);
    detail::make_layers_equal(out.textTransEncoder);
    detail::make_zero(out.out);
    for (auto& block : out.temporal_decoder_blocks) {
      for (auto* part : {&block.sa_block.proj_out, &block.ca_block.proj_out, &block.ffn.proj_out})
        detail::make_zero(part->out_layer);
      detail::make_zero(block.ffn.linear2);
    }
    return out;
  }
  template <Backend B>
  static Tensor<B, 0> loss(const GaussianDiffusion& d, const MotionDiffuseDenoiser<B>& denoiser,
                           const NoisedMotions<B>& batch, std::span<const Index> lengths, const TextFeatures<B>& text,
                           const Context& context, Index) {
    return motiondiffuse_loss(d, denoiser, batch, lengths, text, context);
  }
  static double share(const BatchPart& part, std::span<const Index> lengths) { return part.share(lengths); }
  static void describe(DiffusionRun& run, const Config& c, Index width, Index text_width) {
    run.motiondiffuse = detail::network_sizes(c, width, text_width);
    run.features = "guoh3dfeats";
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/diffusion_systems.ipp>
#endif
