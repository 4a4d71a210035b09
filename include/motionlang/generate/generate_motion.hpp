// SPDX-License-Identifier: MIT
/// From a timeline of texts to a finished motion, like the program `motionlang generate`. It cuts texts where a model
/// needs that, samples all of them together, smooths the motion and fixes floor and feet.
///
///     const auto stmc = load_stmc<EigenBackend<float>>("stmc_free.safetensors");
///     const auto timeline = parse_timeline("walk forward # 0 # 6 # legs\nwave # 2 # 5 # left arm\n");
///     const Motion motion = generate_motion(stmc, timeline, {.seed = 7});
///
/// Motion  Y up, metres, on SMPL's 24 joints (KIT's 21 for a model of KIT-ML). With the bundled model it starts facing
///         -Z
/// Models  any Stmc; all other systems through MotionModel (generate/motion_model.hpp)
/// Bodies  motionlang::instantiated has those for Stmc<EigenBackend<float>>. If a unit is compiled with
///         MOTIONLANG_INSTANTIATED and uses another Stmc, it must also include
///         <motionlang/generate/generate_motion.ipp>
#pragma once

#include <motionlang/backend/detail/eigen_class.hpp>
#include <motionlang/generate/generate_options.hpp>
#include <motionlang/systems/stmc.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One motion for each timeline. The noise of each depends on the seed and on its place in the list.
/// Throws  timeline_error 504 ... 508 for timelines that the model cannot make; option_error 101 for kept frames
///         outside of the motion, 102 for options that contradict each other, 105 for more steps than the model has;
///         config_error 102, 103, 107 and io_error 401 ... 407 for files of noise and records; `cancelled`
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
std::vector<Motion> generate_motions(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                                     const GenerateOptions& options = {});
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
Motion generate_motion(const Stmc<B, D, E>& stmc, const Timeline& timeline, const GenerateOptions& options = {});

/// Throws option_error 102 if motions of these timelines depend on each other, so that several processes cannot share
/// them (BatchMates). generate_motions calls it in each of them, before the work.
template <Backend B, Denoiser<B> D, TextEncoder<B> E>
void require_own_motions(const Stmc<B, D, E>& stmc, std::span<const Timeline> timelines,
                         const GenerateOptions& options = {});

#ifdef MOTIONLANG_INSTANTIATED
template <>
inline constexpr bool detail::is_compiled_stmc<Stmc<EigenBackend<float>>> = true;

extern template std::vector<Motion> generate_motions(const Stmc<EigenBackend<float>>&, std::span<const Timeline>,
                                                     const GenerateOptions&);
extern template Motion generate_motion(const Stmc<EigenBackend<float>>&, const Timeline&, const GenerateOptions&);
extern template void require_own_motions(const Stmc<EigenBackend<float>>&, std::span<const Timeline>,
                                         const GenerateOptions&);
#endif

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/generate_motion.ipp>
#endif
