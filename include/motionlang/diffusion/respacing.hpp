// SPDX-License-Identifier: MIT
/// Which steps of a long process a short sampling run keeps.
#pragma once

#include <span>         // counts
#include <string_view>  // specifications
#include <vector>       // kept steps

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One section of nearly equal size per count; in each, `count` steps evenly from its first to its last, rounded half
/// to even; of 0, none. Source  improved diffusion (Nichol and Dhariwal 2021), `space_timesteps`. Throws config_error
/// 105.
std::vector<Index> respace(Index steps, std::span<const Index> counts);

/// "ddimN": the smallest stride that keeps N steps, starting at 0; or a list of counts "10,15,20" (one number is one
/// section). Empty: all steps. Throws config_error 105.
std::vector<Index> respace(Index steps, std::string_view specification);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/diffusion/respacing.ipp>
#endif
