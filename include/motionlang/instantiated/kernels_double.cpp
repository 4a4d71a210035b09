// SPDX-License-Identifier: MIT
// The kernels of the Eigen and xtensor backends in double, compiled once for motionlang::instantiated.
#include <motionlang/backend/kernel_ops.ipp>

template struct motionlang::KernelOps<double>;
