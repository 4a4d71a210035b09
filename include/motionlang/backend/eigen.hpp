// SPDX-License-Identifier: MIT
/// Backend over Eigen: functions and maxima are Eigen expressions over mapped memory. Arithmetic, sums, products and
/// fused operations are the kernels of kernel_ops.hpp. These use the instruction set of the machine, whatever the
/// program was built for. Eigen's own product reaches 20 to 50 % of the processor's peak at these shapes, and its
/// broadcasting expressions would compile half a second longer.
#pragma once

#include <motionlang/backend/detail/eigen_class.hpp>

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/backend/eigen.ipp>
#endif
