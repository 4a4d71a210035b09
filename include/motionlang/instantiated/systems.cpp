// SPDX-License-Identifier: MIT
// Bodies of the headers in systems/, compiled once for motionlang::instantiated.
#include <motionlang/systems/detail/stmc_parts.ipp>
#include <motionlang/systems/sinc_baseline.ipp>
#include <motionlang/systems/stmc_keep.ipp>
#include <motionlang/systems/teach.ipp>
