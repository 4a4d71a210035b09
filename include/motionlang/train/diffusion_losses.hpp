// SPDX-License-Identifier: MIT
/// The losses with which MDM-SMPL, MDM and MotionDiffuse were trained, given the noise.
///
///     const NoisedMotions<A> batch{x0, eps, t};             // one t for each motion
///     const auto loss = mdm_smpl_loss(diffusion, denoiser, batch, text);
///
/// Source  STMC src/model/gaussian.py; MDM diffusion/gaussian_diffusion.py, utils/loss_util.py; MotionDiffuse
///         text2motion/trainers/ddpm_trainer.py
#pragma once

#include <algorithm>  // max
#include <cmath>      // sqrt
#include <span>       // lengths
#include <vector>     // steps

#include <motionlang/diffusion/mdm.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/diffusion/motiondiffuse.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/loss/reconstruction.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Clean motions and the noise that is added to them.
template <Backend B>
struct NoisedMotions {
  Sequences<B> x0;
  Tensor<B, 2> noise;    // as x0
  std::vector<Index> t;  // of each motion

  /// The step of every row.
  std::vector<Index> t_of_row() const {
    std::vector<Index> out;
    for (const Index s : sequence_of_row(x0.offsets)) out.push_back(t[static_cast<std::size_t>(s)]);
    return out;
  }
  Sequences<B> at_t(const GaussianDiffusion& d) const {
    const auto steps = t_of_row();
    return x0.with(q_sample(d, x0.rows, std::span<const Index>(steps), noise));
  }
};

/// The first lengths[i] rows of sequence i. Throws shape_error 204 for another number of lengths, 203 for a sequence
/// that is shorter.
template <Backend B>
Sequences<B> without_padding(const Sequences<B>& x, std::span<const Index> lengths) {
  if (std::ssize(lengths) != x.count())
    raise<shape_error>(204, "without_padding: ", lengths.size(), " lengths for ", x.count(), " sequences");
  PoolVector<Index> rows;
  for (Index s = 0; s < x.count(); ++s) {
    const Index length = lengths[static_cast<std::size_t>(s)];
    if (length < 0 || length > x.offsets.length(s))
      raise<shape_error>(203, "without_padding: ", length, " rows of ", x.offsets.length(s), " in sequence ", s);
    for (Index i = 0; i < length; ++i) rows.push_back(x.offsets.begin(s) + i);
  }
  return {gather(x.rows, rows), Offsets(lengths)};
}

/// padded_mse between x0 and what the denoiser says about it, whatever it predicts.
/// frames   of the padded batch, if more than in the longest motion
/// Source   thesis eq. 6.5; STMC src/model/gaussian.py diffusion_step
template <Backend B>
Tensor<B, 0> mdm_smpl_loss(const GaussianDiffusion& d, const MdmSmplDenoiser<B>& denoiser,
                           const NoisedMotions<B>& batch, const TextFeatures<B>& text, const Context& context = {},
                           Prediction prediction = Prediction::x0, Index frames = 0) {
  const auto steps = batch.t_of_row();
  const auto x_t = batch.at_t(d);
  const auto said = denoiser(x_t, batch.t, text, context).rows;
  return padded_mse(batch.x0, to_x0(d, prediction, said, x_t.rows, std::span<const Index>(steps)), frames);
}

/// mse_per_sequence of the first lengths[i] frames of each motion; the frames behind them are padding, which the
/// network sees.
/// Source  MDM diffusion/gaussian_diffusion.py training_losses, masked_l2
template <Backend B>
Tensor<B, 1> mdm_losses(const GaussianDiffusion& d, const MdmDenoiser<B>& denoiser, const NoisedMotions<B>& batch,
                        std::span<const Index> lengths, const TextFeatures<B>& text, const Context& context = {}) {
  const auto said = denoiser(batch.at_t(d), batch.t, text, context);
  return mse_per_sequence(without_padding(batch.x0, lengths), without_padding(said, lengths).rows);
}

/// The mean square of the error of the noise over all valid frames of a batch: long motions weigh more.
/// Source  MotionDiffuse text2motion/trainers/ddpm_trainer.py backward_G
template <Backend B>
Tensor<B, 0> motiondiffuse_loss(const GaussianDiffusion& d, const MotionDiffuseDenoiser<B>& denoiser,
                                const NoisedMotions<B>& batch, std::span<const Index> lengths,
                                const TextFeatures<B>& text, const Context& context = {}) {
  const auto said = denoiser(batch.at_t(d), batch.t, text, context);
  return mse(without_padding(batch.x0.with(batch.noise), lengths).rows, without_padding(said, lengths).rows);
}

/// Weights of MDM's geometric terms.
struct MdmActionLossWeights {
  double rcxyz = 1, vel = 1, fc = 1;
  double contact = 0.01;  // a foot that moves at most so far from frame to frame, in metres, stands
};

namespace detail {

/// The numbers of ankles and feet among SMPL's 24 joints: both ankles and toes of each side.
inline constexpr Index mdm_feet[] = {7, 10, 8, 11};

/// Sequences of one row less.
template <Backend B>
Sequences<B> steps_of(const Sequences<B>& x) {
  PoolVector<Index> lengths;
  for (Index s = 0; s < x.count(); ++s) lengths.push_back(std::max<Index>(0, x.offsets.length(s) - 1));
  return {frame_steps(x), Offsets(std::span<const Index>(lengths))};
}

}  // namespace detail

/// The terms of MDM for actions, each the mean over motions of mse_per_sequence:
///     rot_mse     of the frames
///     rcxyz_mse   of the joints, without the path
///     vel_mse     of the steps of the rotations from frame to frame, without the path
///     fc          of the steps that ankles and toes take in `said` where they stand in x0, against 0
/// The divisor of fc counts all frames, not only those in contact.
/// path     numbers at the end of a frame that are the path
/// joints   of x0 and of `said`, (frames, 72), relative to the root
/// Source   Tevet et al. (2023), eq. 2 to 6; MDM diffusion/gaussian_diffusion.py training_losses
/// Differs  from eq. 5 there, which compares steps of joints: vel_mse compares steps of rotations
template <Backend B>
LossTerms<B> mdm_action_losses(const Sequences<B>& x0, const Sequences<B>& said, const Sequences<B>& joints,
                               const Sequences<B>& said_joints, Index path, const MdmActionLossWeights& w = {}) {
  using S = typename B::scalar;
  LossTerms<B> out;
  out.add("rot_mse", 1, mean(mse_per_sequence(x0, said.rows)));
  if (w.rcxyz > 0) out.add("rcxyz_mse", w.rcxyz, mean(mse_per_sequence(joints, said_joints.rows)));
  if (w.vel > 0) {
    const auto rotations = [&](const Sequences<B>& x) { return x.with(slice(x.rows, 1, 0, x.width() - path)); };
    const auto wanted = detail::steps_of(rotations(x0));
    out.add("vel_mse", w.vel, mean(mse_per_sequence(wanted, detail::steps_of(rotations(said)).rows)));
  }
  if (w.fc > 0) {
    const auto feet = [&](const Sequences<B>& x) {
      std::vector<Tensor<B, 2>> parts;
      for (const Index j : detail::mdm_feet) parts.push_back(slice(x.rows, 1, 3 * j, 3 * j + 3));
      return detail::steps_of(x.with(concat(std::span<const Tensor<B, 2>>(parts), 1)));
    };
    const auto true_steps = feet(joints), steps = feet(said_joints);
    const auto values = true_steps.rows.span();
    std::vector<S> stands(values.size(), S(0));
    for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
      const double distance = std::sqrt(
          static_cast<double>(values[i] * values[i] + values[i + 1] * values[i + 1] + values[i + 2] * values[i + 2]));
      if (distance <= w.contact) stands[i] = stands[i + 1] = stands[i + 2] = S(1);
    }
    const auto held = steps.rows * Tensor<B, 2>::from(stands, steps.rows.shape());
    out.add("fc", w.fc, mean(mse_per_sequence(steps.with(held), Tensor<B, 2>::zeros(held.shape()))));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
