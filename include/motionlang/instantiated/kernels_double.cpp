// SPDX-License-Identifier: MIT
// The kernels of the Eigen and xtensor backends in double, compiled once for motionlang::instantiated.
#include <motionlang/backend/detail/kernel_ops_impl.hpp>

template struct motionlang::KernelOps<double>;
