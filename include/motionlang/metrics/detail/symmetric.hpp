// SPDX-License-Identifier: MIT
/// Two decompositions of symmetric matrices, row by row in double, for the Fréchet distance.
///
/// Source  Golub and Van Loan, "Matrix Computations", 4.2.8 (Cholesky with pivots), 8.3.1 (tridiagonal form), 8.3.3
///         (implicit QL steps, with Wilkinson's shift)
#pragma once

#include <cstddef>  // size_t
#include <vector>   // matrices

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// F with A = F^T F for a positive semidefinite A (n, n): (rank, n). Directions in which A is 0 up to rounding are left
/// out.
std::vector<double> semidefinite_factor(std::vector<double> a, std::size_t n);

/// Eigenvalues of a symmetric matrix (n, n) in any order. Throws numeric_error 301 if a value is not finite.
std::vector<double> symmetric_eigenvalues(const std::vector<double>& a, std::size_t n);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/detail/symmetric.ipp>
#endif
