// SPDX-License-Identifier: MIT
/// The scan of VectorScan, see vector_scan.hpp.
#pragma once

#include <cstdint>  // bfloat16

#include <motionlang/search/nearest.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The scan itself. It is a template, so that motionlang::instantiated can compile it once.
template <std::same_as<float> S>
struct RowScan {
  std::span<const S> rows;                // (count, width)
  std::span<const std::uint16_t> halves;  // the same in bfloat16, or empty
  Index count = 0, width = 0;
  double half_error = 0;  // largest |x - bfloat16(x)|

  /// queries (n, width) of length 1
  std::vector<std::vector<Neighbour>> nearest(std::span<const S> queries, Index k) const;
  /// Rounds rows to bfloat16. Returns the largest |x - bfloat16(x)|.
  static double to_halves(std::span<const S> rows, Index width, std::uint16_t* halves);
  /// out[r] = <row r, query>, in float.
  using DotFunction = void (*)(const S* rows, Index count, Index width, const S* query, S* out);
  static DotFunction dot_function();
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::detail::RowScan<float>;
#else
#include <motionlang/search/detail/row_scan.ipp>
#endif
