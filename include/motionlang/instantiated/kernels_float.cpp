// SPDX-License-Identifier: MIT
// The kernels of the Eigen and xtensor backends in float, and the search that uses them, compiled once for
// motionlang::instantiated.
#include <motionlang/backend/detail/kernel_ops_impl.hpp>
#include <motionlang/backend/precision.ipp>
#include <motionlang/search/detail/row_scan_impl.hpp>

template struct motionlang::KernelOps<float>;
template struct motionlang::detail::RowScan<float>;
