// SPDX-License-Identifier: MIT
// Bodies of the headers in diffusion/, compiled once for motionlang::instantiated.
#include <motionlang/diffusion/gaussian.ipp>
#include <motionlang/diffusion/respacing.ipp>
#include <motionlang/diffusion/sampler.ipp>
#include <motionlang/diffusion/schedule.ipp>
