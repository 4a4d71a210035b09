// SPDX-License-Identifier: MIT
/// The steps of a long process that a short sampling run keeps.
#pragma once

#include <span>         // counts
#include <string_view>  // specifications
#include <vector>       // kept steps

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One section of nearly equal size per count. Each section gives `count` steps, evenly from its first to its last,
/// rounded half to even; a count of 0 gives none. Source  improved diffusion (Nichol and Dhariwal 2021),
/// `space_timesteps`. Throws config_error 105.
std::vector<Index> respace(Index steps, std::span<const Index> counts);

/// "ddimN": the smallest stride that keeps N steps, starting at 0. A list of counts "10,15,20": one section for each.
/// Empty: all steps. Throws config_error 105.
std::vector<Index> respace(Index steps, std::string_view specification);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/diffusion/respacing.ipp>
#endif
