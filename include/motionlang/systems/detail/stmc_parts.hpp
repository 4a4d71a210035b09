// SPDX-License-Identifier: MIT
/// Parts of Stmc that do not depend on a backend.
#pragma once

#include <string>  // texts
#include <vector>  // intervals

#include <motionlang/compose/plan.hpp>
#include <motionlang/core/option_error.hpp>
#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The different texts of a plan; "" is the first one.
struct DifferentTexts {
  std::vector<std::string> texts{""};
  std::vector<Index> which;  // of every interval

  explicit DifferentTexts(const BatchPlan& plan);
};

/// Throws option_error 102 if a motion depends on the others of its list, so that no part of the list can be made
/// alone. one_token: the texts have one token each, so that they have the same length in any list.
void require_own_motions(BatchMates mates, bool one_token);

/// SMPL RIFKE features as a motion that starts facing pi.
Motion published_motion(std::span<const double> features, double fps);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/systems/detail/stmc_parts.ipp>
#endif
