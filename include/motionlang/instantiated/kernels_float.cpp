// SPDX-License-Identifier: MIT
// The kernels of the Eigen and xtensor backends in float, and the search that uses them, compiled once for
// motionlang::instantiated.
#include <motionlang/backend/kernel_ops.ipp>
#include <motionlang/backend/precision.ipp>
#include <motionlang/search/detail/row_scan.ipp>

template struct motionlang::KernelOps<float>;
template struct motionlang::detail::RowScan<float>;
