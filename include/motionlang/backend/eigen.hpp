// SPDX-License-Identifier: MIT
/// Backend over Eigen: functions and maxima are Eigen expressions over mapped memory. Arithmetic, sums, products and
/// fused operations are the kernels of kernel_ops.hpp: they are for the instruction set of the machine whatever the
/// program was built for (Eigen's own product reaches 20 to 50 % of the processor at these shapes), and a program with
/// all the expressions of broadcasting compiles half a second longer.
#pragma once

#include <motionlang/backend/detail/eigen_class.hpp>

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/backend/eigen.ipp>
#endif
