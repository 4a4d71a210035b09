// SPDX-License-Identifier: MIT
/// Everything to turn a timeline of texts into a motion: include this one.
///
///     namespace ml = motionlang;
///     using B = ml::EigenBackend<float>;
///     const auto stmc = ml::load_stmc<B>("stmc_free.safetensors");
///     const auto timeline = ml::parse_timeline("walk forward # 0.0 # 6.0 # legs\n"
///                                              "raise both arms # 2.0 # 5.0 # left arm # right arm\n");
///     const ml::Tensor<B, 2> features = stmc.generate(timeline, ml::Philox{.seed = 7});
///     const ml::Motion motion = ml::stmc_motion(features);
///
/// Writers of BVH, GLB, NPZ and pages are in <motionlang/io/...>. Link motionlang::instantiated to compile faster.
#pragma once

#include <motionlang/backend/eigen.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/io/stmc_file.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Generated features (frames, 205) as a motion of the 24-joint skeleton, Y up, metres. Bone lengths are the skeleton's: the
/// rotations are used, not the predicted positions. Published generation starts facing pi.
template <Backend B>
Motion stmc_motion(const Tensor<B, 2>& features, double fps = 20) {
  const std::vector<double> values(features.span().begin(), features.span().end());
  return smplrifke_to_motion<double>(values, {.first_angle = std::numbers::pi}, fps);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
